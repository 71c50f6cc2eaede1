//! The content of published crates.

use std::path::Path;
use std::process::Command;

/// Each crate that is published, with its folder and with files that it must have.
const CRATES: [(&str, &str, &[&str]); 7] = [
    ("belvedere-sensors", "sensors", &[]),
    ("belvedere-bridge", "bridge", &["WIRE.md", "SECURITY.md"]),
    ("lidar-packets", "crates/lidar-packets", &[]),
    ("belvedere-rtps", "crates/rtps", &[]),
    ("belvedere-xacro", "crates/xacro", &[]),
    ("belvedere-description", "crates/description", &["models/worlds/tag_ceiling.world"]),
    ("belvedere", "", &["models/worlds/tag_ceiling.world", "viewer/dist/viewer.js", "src/main.rs"]),
];

/// Files that every crate must have.
const COMMON: [&str; 5] = ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"];

#[test]
fn the_packages_hold_all_that_they_name() {
    for (name, folder, needed) in CRATES {
        let files = listed(name);
        for needed in COMMON.iter().chain(needed) {
            assert!(
                files.iter().any(|file| file == needed),
                "{name}: {needed} is not in the package: {files:?}"
            );
        }
        let sources = files.iter().filter(|file| Path::new(file).extension().is_some_and(|end| end == "rs"));
        for source in sources {
            check_source(name, &Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), source, &files);
        }
    }
}

/// The files of a package, by their paths in it.
fn listed(name: &str) -> Vec<String> {
    let listed = Command::new(env!("CARGO"))
        .args(["package", "--package", name, "--list", "--allow-dirty", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    let said = String::from_utf8_lossy(&listed.stderr);
    assert!(listed.status.success() && !said.contains("warning"), "{said}");
    String::from_utf8_lossy(&listed.stdout).lines().map(str::to_owned).collect()
}

/// Packaged files must not name excluded ones: each file that a source includes is in the package.
fn check_source(name: &str, folder: &Path, source: &str, files: &[String]) {
    let text = std::fs::read_to_string(folder.join(source)).expect("a source that is listed");
    for (line, text) in text.lines().enumerate() {
        let place = format!("{name}: {source}:{}", line + 1);
        let named = ["#[path = \"", "include_str!(\"", "include_bytes!(\""]
            .iter()
            .find_map(|words| text.split_once(words)?.1.split('"').next());
        let Some(named) = named else { continue };
        let parent = Path::new(source).parent().expect("a file has a folder");
        let mut path: Vec<_> = parent.iter().collect();
        for part in Path::new(named) {
            if part == ".." {
                assert!(path.pop().is_some(), "{place}: {named} lies outside of the package");
            } else {
                path.push(part);
            }
        }
        let path = path.join(std::ffi::OsStr::new("/")).into_string().expect("UTF-8");
        assert!(files.contains(&path), "{place}: {named} is not in the package");
    }
}

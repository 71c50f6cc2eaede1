//! The content of published crates.

use std::process::Command;

#[test]
fn the_package_of_the_sensors_contains_all_files_that_it_names() {
    let listed = Command::new(env!("CARGO"))
        .args(["package", "--package", "belvedere-sensors", "--list", "--allow-dirty", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    let listed = String::from_utf8_lossy(&listed.stdout);
    let files: Vec<&str> = listed.lines().collect();
    for needed in ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs"] {
        assert!(files.contains(&needed), "{needed} is not in the package: {files:?}");
    }
    // Packaged files must not name excluded ones: each file that a source includes is in the package.
    for source in
        files.iter().filter(|file| std::path::Path::new(file).extension().is_some_and(|end| end == "rs"))
    {
        let text = std::fs::read_to_string(format!("{}/sensors/{source}", env!("CARGO_MANIFEST_DIR")))
            .expect("a source that is listed");
        for (line, text) in text.lines().enumerate() {
            let named = text.split_once("#[path = \"").or_else(|| text.split_once("include_str!(\""));
            let named = named
                .or_else(|| text.split_once("include_bytes!(\""))
                .and_then(|(_, rest)| rest.split('"').next());
            let Some(named) = named else { continue };
            let folder = std::path::Path::new(source).parent().expect("a file has a folder");
            let mut path: Vec<_> = folder.iter().collect();
            for part in std::path::Path::new(named) {
                if part == ".." {
                    assert!(
                        path.pop().is_some(),
                        "{source}:{}: {named} lies outside of the package",
                        line + 1
                    );
                } else {
                    path.push(part);
                }
            }
            let path = path.join(std::ffi::OsStr::new("/")).into_string().expect("UTF-8");
            assert!(files.contains(&path.as_str()), "{source}:{}: {named} is not in the package", line + 1);
        }
    }
}

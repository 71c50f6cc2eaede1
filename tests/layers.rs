//! The arrows of ARCHITECTURE.md: each folder uses only those before it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Of the simulator, bottom up.
const SIMULATOR: [&str; 9] =
    ["description", "world", "robot", "entities", "rig", "simulation", "server", "picture", "cli"];

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The folder or file right below `src` that a file belongs to.
fn layer(source: &Path, file: &Path) -> String {
    let first = file.strip_prefix(source).unwrap().components().next().unwrap();
    first.as_os_str().to_str().unwrap().trim_end_matches(".rs").to_owned()
}

#[test]
fn each_layer_uses_only_those_below_it() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    let mut uses: BTreeMap<(usize, usize), String> = BTreeMap::new();
    for file in &files {
        let own = layer(&source, file);
        let Some(own_place) = SIMULATOR.iter().position(|name| *name == own) else {
            assert!(["lib", "main"].contains(&own.as_str()), "src/{own} is in no layer: give it one here");
            continue;
        };
        for (number, line) in fs::read_to_string(file).unwrap().lines().enumerate() {
            // Tests of a file may use what they like.
            if line.trim_start().starts_with("#[cfg(test)]") {
                break;
            }
            if line.trim_start().starts_with("//") {
                continue;
            }
            for part in line.split("crate::").skip(1) {
                let used = part.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("");
                if let Some(used_place) = SIMULATOR.iter().position(|name| *name == used) {
                    let at = || format!("{}:{}: {}", file.display(), number + 1, line.trim());
                    uses.entry((own_place, used_place)).or_insert_with(at);
                }
            }
        }
    }
    assert!(uses.len() > 15, "nearly nothing was found: is the form of `use` another one? {uses:?}");
    let upward: Vec<&String> = uses.iter().filter(|((own, used), _)| used > own).map(|(_, at)| at).collect();
    assert!(upward.is_empty(), "used from below:\n{upward:#?}");
}

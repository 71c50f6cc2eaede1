//! The program carries all files of `models/`.

use std::fs;
use std::path::Path;

/// The texts before and after the list in `src/main.rs`.
const BEGIN: &str = "= files![\n";
const END: &str = "];\n";

#[test]
fn the_program_carries_all_models() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    collect(&root.join("models"), "", &mut files);
    files.sort();
    let listed: String = files.iter().flat_map(|file| ["    \"", file, "\",\n"]).collect();
    let main = root.join("src/main.rs");
    let text = fs::read_to_string(&main).unwrap();
    let (before, rest) = text.split_once(BEGIN).expect("a list of files");
    let (list, after) = rest.split_once(END).expect("the end of the list");
    if std::env::var_os("BELVEDERE_BLESS").is_some_and(|value| value == "1") {
        fs::write(&main, format!("{before}{BEGIN}{listed}{END}{after}")).unwrap();
        return;
    }
    assert!(
        list == listed,
        "the list in src/main.rs is not that of models/: BELVEDERE_BLESS=1 cargo test -p belvedere --test repository models"
    );
}

/// Adds the files of a folder and of its subfolders, by their paths relative to the top folder.
fn collect(folder: &Path, below: &str, files: &mut Vec<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{below}{}", entry.file_name().to_str().expect("names are UTF-8"));
        if entry.file_type().unwrap().is_dir() {
            collect(&entry.path(), &format!("{name}/"), files);
        } else {
            files.push(name);
        }
    }
}

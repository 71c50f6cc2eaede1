//! Copies the named worlds and robots next to the module, from where the wheel takes them.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let folder =
        |name| env::var_os(name).map(PathBuf::from).ok_or_else(|| io::Error::other(format!("no {name}")));
    let models = folder("CARGO_MANIFEST_DIR")?.join("../models");
    println!("cargo::rerun-if-changed={}", models.display());
    let copies = folder("OUT_DIR")?.join("models");
    if copies.exists() {
        fs::remove_dir_all(&copies)?;
    }
    copy(&models, &copies)
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let to = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy(&entry.path(), &to)?;
        } else {
            fs::copy(entry.path(), to)?;
        }
    }
    Ok(())
}

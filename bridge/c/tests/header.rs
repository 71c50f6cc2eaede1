//! `include/belvedere.h` is what cbindgen makes of `src/`.
//!
//! `BELVEDERE_UPDATE_HEADER=1 cargo test -p belvedere-bridge-c --test header` writes it.

use std::path::Path;

#[test]
fn the_committed_header_is_current() {
    let crate_dir = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(crate_dir.join("cbindgen.toml")).unwrap();
    let mut made = Vec::new();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for module in ["layout", "status", "node", "subscriber", "frame", "synchronizer", "command", "control"] {
        builder = builder.with_src(crate_dir.join(format!("src/{module}.rs")));
    }
    builder.generate().unwrap().write(&mut made);
    // Rust's heading for what a caller must see to, in the words of a C reader.
    let made = String::from_utf8(made).unwrap().replace("//\n// # Safety\n// ", "// Requires: ");
    let path = crate_dir.join("include/belvedere.h");
    if std::env::var_os("BELVEDERE_UPDATE_HEADER").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(
        made == committed,
        "bridge/c/include/belvedere.h is not current; run \
         BELVEDERE_UPDATE_HEADER=1 cargo test -p belvedere-bridge-c --test header"
    );
}

//! Generates the bindings of the wire format for C and Python from `belvedere_bridge::schema`, and the functions
//! of the C header from `src/` with cbindgen. `BELVEDERE_BLESS=1 cargo test -p belvedere-bridge-c --test bindings`
//! writes the files.

mod c;
mod names;
mod python;

use std::{fs, path::Path};

use belvedere_bridge::{Kind, schema};

/// Checks that the file is up to date, or writes it.
fn check(file: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(file);
    if std::env::var_os("BELVEDERE_BLESS").is_some() {
        fs::write(&path, made).unwrap();
    }
    assert!(
        fs::read_to_string(&path).unwrap_or_default() == made,
        "{file} is not current; run BELVEDERE_BLESS=1 cargo test -p belvedere-bridge-c --test bindings"
    );
}

#[test]
fn the_c_header_is_current() {
    let crate_dir = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut config = cbindgen::Config::from_file(crate_dir.join("cbindgen.toml")).unwrap();
    config.after_includes = Some(c::layout());
    for layout in schema::structs() {
        config.export.rename.insert(layout.name.to_owned(), format!("struct {}", names::c_type(layout.name)));
    }
    let mut made = Vec::new();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for module in ["status", "node", "subscriber", "frame", "synchronizer", "command", "control", "ros1"] {
        builder = builder.with_src(crate_dir.join(format!("src/{module}.rs")));
    }
    builder.generate().unwrap().write(&mut made);
    // Rewrite Rust's heading of the caller's obligations for readers of C.
    let made = String::from_utf8(made).unwrap().replace("//\n// # Safety\n// ", "// Requires: ");
    check("bridge/c/include/belvedere.h", &made);
}

#[test]
fn the_python_module_is_current() {
    check("python/src/belvedere/_layout.py", &python::layout());
}

#[test]
fn every_kind_with_a_struct_has_exactly_one() {
    for &kind in Kind::ALL {
        let structs = schema::structs().filter(|layout| layout.kinds.contains(&kind.to_wire())).count();
        let of_elements = [Kind::Image, Kind::DepthImage, Kind::LaserScan, Kind::PointCloud].contains(&kind);
        assert_eq!(structs, usize::from(!of_elements), "{kind}");
        assert_eq!(kind.struct_size().is_none(), of_elements, "{kind}");
    }
}

/// Hence the size of a struct in C, which `wire.hpp` checks, is right only if all its offsets are.
#[test]
fn structs_have_no_padding() {
    for layout in schema::structs() {
        let ends: Vec<usize> =
            layout.fields.iter().skip(1).map(|field| field.offset).chain([layout.size]).collect();
        for (field, end) in layout.fields.iter().zip(ends) {
            assert_eq!(field.offset + names::size(field.type_name), end, "{}.{}", layout.name, field.name);
        }
    }
}

//! The binary interface is frozen per major version: `abi/MAJOR.txt` is the interface that programs were linked with.
//!
//! It has one line for each constant, enumerator, type, field and function of `include/belvedere.h`, with sizes and
//! offsets as a C compiler computes them. Lines may be added. They may not be changed or removed until the major
//! version, and with it the soname, changes. This holds for 0 as well: it is the soname of every 0.x.
//!
//! `.ci/install` checks on the installed library that it exports these functions and nothing else.
//!
//! `BELVEDERE_UPDATE_ABI=1 cargo test -p belvedere-bridge-c --test abi` adds new lines.

use std::{
    fmt::Write as _,
    fs,
    io::Write as _,
    path::Path,
    process::{Command, Stdio},
};

const MAJOR: &str = env!("CARGO_PKG_VERSION_MAJOR");
const CRATE: &str = env!("CARGO_MANIFEST_DIR");

#[test]
fn the_frozen_interface_has_not_changed() {
    let now = interface(&fs::read_to_string(Path::new(CRATE).join("include/belvedere.h")).unwrap());
    let path = Path::new(CRATE).join(format!("abi/{MAJOR}.txt"));
    let frozen = fs::read_to_string(&path).unwrap_or_default();
    let comments: Vec<_> = frozen.lines().filter(|line| line.starts_with('#')).collect();
    let frozen: Vec<_> = frozen.lines().filter(|line| !line.starts_with('#')).collect();

    let gone: Vec<_> = frozen.iter().filter(|line| !now.iter().any(|other| other == *line)).collect();
    assert!(
        gone.is_empty(),
        "programs linked with libbelvedere_bridge.so.{MAJOR} rely on what has changed or gone:\n  {}\n\
         Put it back beside the new, or raise the major version, and with it the soname, and begin a new file in \
         bridge/c/abi.",
        gone.iter().map(|line| (**line).to_owned()).collect::<Vec<_>>().join("\n  ")
    );
    let added: Vec<_> = now.iter().filter(|line| !frozen.contains(&line.as_str())).collect();
    if !added.is_empty() && std::env::var_os("BELVEDERE_UPDATE_ABI").is_some() {
        let text = comments.into_iter().chain(now.iter().map(String::as_str)).collect::<Vec<_>>().join("\n");
        fs::write(&path, text + "\n").unwrap();
        return;
    }
    assert!(
        added.is_empty(),
        "new in the binary interface, and frozen from now on: if it is as it shall stay, run \
         BELVEDERE_UPDATE_ABI=1 cargo test -p belvedere-bridge-c --test abi\n  {}",
        added.iter().map(|line| line.as_str()).collect::<Vec<_>>().join("\n  ")
    );
}

#[test]
fn a_moved_field_and_a_changed_signature_are_detected() {
    let header = fs::read_to_string(Path::new(CRATE).join("include/belvedere.h")).unwrap();
    let now = interface(&header);
    for (what, with, says) in [
        (
            "float near;\n    // Largest measured depth, metres.\n    float far;",
            "float far;\n    // Largest measured depth, metres.\n    float near;",
            "near at 152",
        ),
        ("uint32_t timeout_ms", "uint64_t timeout_ms", "bv_subscriber_wait("),
        ("BV_STATUS_LIMIT = -7", "BV_STATUS_LIMIT = -17", "BV_STATUS_LIMIT = -7"),
        ("double p[12];", "double p[16];", "bv_camera_info size 400"),
        ("uint64_t bv_mono_ns(void);", "", "bv_mono_ns("),
    ] {
        assert!(header.contains(what), "{what}");
        let then = interface(&header.replacen(what, with, 1));
        let gone: Vec<_> = now.iter().filter(|line| !then.contains(line)).collect();
        assert!(gone.iter().any(|line| line.contains(says)), "{what}: {gone:?}");
    }
}

/// Returns the interface, one line for each part of it, in the header's order.
fn interface(header: &str) -> Vec<String> {
    let declarations = declarations(header);
    let mut program = format!("{header}\n#include <stdio.h>\n\nint main(void) {{\n");
    for line in header.lines() {
        let constant = line.strip_prefix("#define BV_").and_then(|rest| rest.split_once(' '));
        if let Some((name, _)) = constant.filter(|(name, _)| !name.contains('(')) {
            let _ = writeln!(program, "printf(\"BV_{name} = %lld\\n\", (long long)BV_{name});");
        }
    }
    for declaration in &declarations {
        if let Some((name, body)) = braced(declaration, "enum ") {
            let _ =
                writeln!(program, "printf(\"enum {name} size %zu\\n\", sizeof({name}));", name = first(name));
            for constant in body.split(',').filter_map(|part| part.split_whitespace().next()) {
                let _ = writeln!(program, "printf(\"{constant} = %lld\\n\", (long long){constant});");
            }
        }
        for keyword in ["struct", "union"] {
            let Some((name, body)) = braced(declaration, &format!("typedef {keyword} ")) else { continue };
            let _ = writeln!(
                program,
                "printf(\"{keyword} {name} size %zu align %zu\\n\", sizeof({name}), _Alignof({name}));"
            );
            for field in body.split(';').map(str::trim).filter(|field| !field.is_empty()) {
                let (kind, rest) = field.rsplit_once(' ').unwrap();
                let (field, length) = rest.split_at(rest.find('[').unwrap_or(rest.len()));
                let _ = writeln!(
                    program,
                    "printf(\"{name}.{field} at %zu: {kind}{length}\\n\", offsetof({name}, {field}));"
                );
            }
        }
    }
    for signature in functions(&declarations) {
        let _ = writeln!(program, "puts(\"{signature}\");");
    }
    program.push_str("}\n");
    run(&program).lines().map(str::to_owned).collect()
}

/// Returns the declarations of the header, each on one line, without comments and preprocessor lines.
fn declarations(header: &str) -> Vec<String> {
    let start = header.find("#ifndef BELVEDERE_H").unwrap();
    let code = header[start..]
        .replace("\\\n", "")
        .lines()
        .map(|line| line.split("//").next().unwrap_or(line).trim())
        .filter(|line| !line.starts_with('#') && *line != "extern \"C\" {" && *line != "}")
        .collect::<Vec<_>>()
        .join(" ");
    let (mut found, mut depth, mut current) = (Vec::new(), 0_i32, String::new());
    for word in code.split_whitespace() {
        depth += word.matches('{').count() as i32 - word.matches('}').count() as i32;
        current.push_str(word);
        if depth == 0 && word.ends_with(';') {
            found.push(std::mem::take(&mut current));
        } else {
            current.push(' ');
        }
    }
    found
}

/// Returns name and body of a declaration that begins with `keyword` and has a body.
fn braced<'a>(declaration: &'a str, keyword: &str) -> Option<(&'a str, &'a str)> {
    let (name, rest) = declaration.strip_prefix(keyword)?.split_once('{')?;
    Some((name.trim(), rest.rsplit_once('}')?.0))
}

/// Returns the functions, without the names of their parameters, which are not part of the binary interface.
fn functions(declarations: &[String]) -> Vec<String> {
    let mut found = Vec::new();
    for declaration in declarations {
        let Some((head, parameters)) = declaration.split_once('(') else { continue };
        let parameters = parameters.trim_end_matches([')', ';']).split(',').map(|parameter| {
            let parameter = parameter.trim();
            let end = parameter.rfind([' ', '*']).map_or(parameter.len(), |last| last + 1);
            parameter[..end].trim_end()
        });
        found.push(format!("{head}({})", parameters.collect::<Vec<_>>().join(", ")));
    }
    found
}

fn first(text: &str) -> &str {
    text.split_whitespace().next().unwrap_or(text)
}

/// Returns the output of a C program.
fn run(program: &str) -> String {
    let directory = tempfile::tempdir().unwrap();
    let executable = directory.path().join("interface");
    let mut cc = Command::new("cc")
        .args(["-std=c11", "-x", "c", "-", "-o"])
        .arg(&executable)
        .stdin(Stdio::piped())
        .spawn()
        .expect("a C compiler, which links Rust as well");
    cc.stdin.take().unwrap().write_all(program.as_bytes()).unwrap();
    assert!(cc.wait().unwrap().success(), "{program}");
    let ran = Command::new(executable).output().unwrap();
    assert!(ran.status.success());
    String::from_utf8(ran.stdout).unwrap()
}

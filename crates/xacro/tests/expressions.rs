//! Expressions against ROS's xacro: `expressions.txt` contains the output of xacro 2.1.1.

use belvedere_xacro::diagnostics::{Diagnostics, Problem, Source};
use belvedere_xacro::package::PackagePath;
use belvedere_xacro::{Element, expand_root};
use std::path::Path;

/// Expands an attribute of the root.
fn expanded(text: &str) -> Result<String, Problem> {
    let path = Path::new("r.xacro");
    let attributes = vec![("v".to_owned(), text.to_owned())];
    let root =
        Element { name: "robot".into(), attributes, children: Vec::new(), source: Source::new(path, 1) };
    let packages = PackagePath::new([], None);
    let root = expand_root(root, path, &packages, &[], &mut Diagnostics::default())?;
    Ok(root.attribute("v").unwrap().to_owned())
}

#[test]
fn each_expression_has_the_same_value_as_in_xacro() {
    let table =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/expressions.txt")).unwrap();
    let lines: Vec<&str> = table.lines().filter(|line| !line.starts_with("# ")).collect();
    assert!(lines.len() > 500);
    let mut wrong = Vec::new();
    for line in lines {
        let (expression, expected) = line.split_once("  =>  ").unwrap();
        let escapes = [('\\', "\\\\"), ('\n', "\\n"), ('\r', "\\r"), ('\t', "\\t")];
        let escaped =
            |text: &str| escapes.iter().fold(text.to_owned(), |text, (c, name)| text.replace(*c, name));
        match expanded(&format!("${{{expression}}}")) {
            Ok(value) if escaped(&value) != expected => {
                wrong.push(format!("{expression}: {value}, not {expected}"));
            }
            Err(problem) if expected != "!" => wrong.push(format!("{expression}: {problem}, not {expected}")),
            _ => {}
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

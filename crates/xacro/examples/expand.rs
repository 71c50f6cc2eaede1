//! Prints a xacro file as plain XML: `cargo run -p belvedere-xacro --example expand -- robot.urdf.xacro [name:=value]…`

use belvedere_xacro::{diagnostics::Diagnostics, expand, package::PackagePath};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let (arguments, files): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|word| word.contains(":="));
    let [file] = &files[..] else {
        eprintln!("usage: expand FILE [NAME:=VALUE]…");
        return ExitCode::from(2);
    };
    let split =
        |word: &String| word.split_once(":=").map(|(name, value)| (name.to_owned(), value.to_owned()));
    let arguments: Vec<_> = arguments.iter().filter_map(split).collect();
    let packages = PackagePath::new([], std::env::var_os("ROS_PACKAGE_PATH").as_deref());
    let mut diagnostics = Diagnostics::default();
    let expanded = expand(Path::new(file), &packages, &arguments, &mut diagnostics);
    for problem in diagnostics.problems() {
        eprintln!("{problem}");
    }
    match expanded {
        Ok(robot) => {
            print!("{robot}");
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

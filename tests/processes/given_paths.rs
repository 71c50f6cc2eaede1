//! Paths at which nothing can be read, files in other encodings, and the commands that messages suggest.

use crate::live::{belvedere, own_domain};
use std::fs;
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const ROBOT: &str = "<?xml version='1.0'?>\n<robot name='r'><link name='l'/></robot>";

/// Returns what the command says on both outputs in a folder, and its exit code.
fn said(folder: &Path, arguments: &[&str]) -> (String, Option<i32>) {
    let done = belvedere().current_dir(folder).args(arguments).output().unwrap();
    let text = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (text, done.status.code())
}

#[test]
fn the_error_of_the_system_is_told_wherever_a_path_is_given() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["ring", "ring.urdf", "ring.sdf", "ring.world", "ring.xacro", "ring.mcap", "ring.stl"] {
        symlink(name, at(name)).unwrap();
    }
    symlink("nowhere.urdf", at("broken.urdf")).unwrap();
    fs::write(at("file"), ROBOT).unwrap();
    fs::create_dir(at("playground")).unwrap();
    let levels = "Too many levels of symbolic links";
    let long = "x".repeat(300);
    for (arguments, words) in [
        (&["check", "ring"][..], levels),
        (&["check", "ring.urdf"], levels),
        (&["check", "ring.sdf"], levels),
        (&["check", "ring.world"], levels),
        (&["check", "./ring"], levels),
        (&["check", "--robot", "ring"], levels),
        (&["check", "--robot", "ring.sdf"], levels),
        (&["check", "--world", "ring"], levels),
        (&["check", "--world", "ring.world"], levels),
        (&["check", "--all", "ring"], levels),
        (&["run", "--robot", "ring.urdf"], levels),
        (&["run", "--world", "ring.world"], levels),
        (&["urdf", "ring.urdf"], levels),
        (&["info", "ring.mcap"], levels),
        (&["replay", "ring.mcap"], levels),
        (&["check", "file/r.urdf"], "Not a directory"),
        (&["check", &long], "File name too long"),
        (&["check", "broken.urdf"], "it is a symbolic link to nowhere.urdf, which does not exist"),
        (&["check", "--robot", "playground"], "this is a folder; name a file in it"),
    ] {
        let (said, code) = said(folder.path(), arguments);
        assert_eq!(code, Some(1), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?}: {said}");
        assert!(!said.contains("no such"), "{arguments:?}: {said}");
    }
    // The name of a world goes before that of a folder, and a file needs no extension.
    assert_eq!(said(folder.path(), &["check", "playground", "--robot", "none"]).1, Some(0));
    assert_eq!(said(folder.path(), &["check", "file"]).1, Some(0));
    // The files that a file names.
    let mesh = "<visual><geometry><mesh filename='ring.stl'/></geometry></visual>";
    fs::write(at("mesh.urdf"), format!("<robot name='r'><link name='l'>{mesh}</link></robot>")).unwrap();
    let uri = "<visual name='v'><geometry><mesh><uri>ring.stl</uri></mesh></geometry></visual>";
    let model = format!("<sdf version='1.6'><model name='m'><link name='l'>{uri}</link></model></sdf>");
    fs::write(at("mesh.sdf"), model).unwrap();
    let include = "<xacro:include filename='ring.xacro'/><link name='l'/>";
    let xacro = format!("<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>{include}</robot>");
    fs::write(at("including.xacro"), xacro).unwrap();
    for name in ["mesh.urdf", "mesh.sdf", "including.xacro"] {
        let (said, code) = said(folder.path(), &["check", name]);
        assert!(code == Some(1) && said.contains(levels), "{name}: {said}");
    }
}

#[test]
fn a_file_that_must_not_be_read_says_so() {
    let folder = TempDir::new().unwrap();
    let (inside, file) = (folder.path().join("closed"), folder.path().join("closed.urdf"));
    fs::create_dir(&inside).unwrap();
    fs::write(inside.join("w.world"), "<sdf/>").unwrap();
    fs::write(&file, ROBOT).unwrap();
    for path in [&inside, &file] {
        fs::set_permissions(path, fs::Permissions::from_mode(0o000)).unwrap();
    }
    let mut program = belvedere();
    if fs::read(&file).is_ok() {
        // The superuser may read everything, so a copy of the program runs as nobody.
        let copy = folder.path().join("belvedere");
        fs::copy(env!("CARGO_BIN_EXE_belvedere"), &copy).unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
        program = Command::new(copy);
        program.uid(65534).gid(65534);
    }
    program.current_dir(folder.path()).arg("check");
    // Both refusals are told by one run.
    let done = program.args(["closed.urdf", "--world", "closed/w.world"]).output().unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert_eq!(said.matches("Permission denied").count(), 2, "{said}");
    fs::set_permissions(&inside, fs::Permissions::from_mode(0o700)).unwrap();
}

#[test]
fn a_file_in_utf_16_or_utf_32_is_told_its_encoding_and_a_command_that_converts_it() {
    let folder = TempDir::new().unwrap();
    let wide = |mark: &str, bytes: usize, is_little: bool| -> Vec<u8> {
        let mut text = Vec::new();
        for c in format!("{mark}{ROBOT}").chars() {
            let number = (c as u32).to_le_bytes();
            let mut number = number[..bytes].to_vec();
            if !is_little {
                number.reverse();
            }
            text.extend(number);
        }
        text
    };
    let name = "my robot's.urdf";
    let path = folder.path().join(name);
    for (encoding, bytes, is_little) in
        [("UTF-16LE", 2, true), ("UTF-16BE", 2, false), ("UTF-32LE", 4, true), ("UTF-32BE", 4, false)]
    {
        for mark in ["", "\u{feff}"] {
            fs::write(&path, wide(mark, bytes, is_little)).unwrap();
            let (said, code) = said(folder.path(), &["check", name]);
            assert_eq!(code, Some(1), "{said}");
            let words = format!("{name}: error: its text is in {encoding}, and UTF-8 is read; convert it: ");
            let (_, command) =
                said.split_once(&words).unwrap_or_else(|| panic!("{encoding} {mark:?}: {said}"));
            // The command works as it stands.
            let command = command.lines().next().unwrap();
            let Ok(converted) = Command::new("sh").args(["-c", command]).current_dir(folder.path()).status()
            else {
                continue;
            };
            assert!(converted.success(), "{command}");
            let copy = fs::read_to_string(folder.path().join(format!("{name}-utf-8"))).unwrap();
            assert_eq!(copy.trim_start_matches('\u{feff}'), ROBOT, "{command}");
        }
    }
}

/// The error names the encoding and the command that converts it, whichever file refers to the text.
#[test]
fn the_error_for_a_wide_text_names_its_encoding_in_each_format() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    let ply = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n";
    let texts = [
        ("m.ply", ply),
        ("m.gltf", "{\"asset\":{\"version\":\"2.0\"}}"),
        ("m.dae", "<COLLADA version='1.4.1'/>"),
        ("m.stl", "solid a\nendsolid a\n"),
        ("m.material", "material A { technique { pass { } } }"),
        ("c.yaml", "a: 1\n"),
        ("i.xacro", "<robot/>"),
        ("plan.toml", "worlds = ['w.world']\n"),
    ];
    for name in ["m.ply", "m.gltf", "m.dae", "m.stl"] {
        let mesh = format!("<visual><geometry><mesh filename='{name}'/></geometry></visual>");
        write(&format!("{name}.urdf"), &format!("<robot name='r'><link name='l'>{mesh}</link></robot>"));
    }
    let script = "<script><uri>m.material</uri><name>A</name></script>";
    let visual = format!(
        "<visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry><material>{script}</material></visual>"
    );
    let model = format!("<sdf version='1.6'><model name='m'><link name='l'>{visual}</link></model></sdf>");
    write("m.material.sdf", &model);
    let xacro = |inside: &str| {
        format!("<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>{inside}<link name='l'/></robot>")
    };
    let yaml = "<xacro:property name='p' value=\"${xacro.load_yaml('c.yaml')}\"/><a b='${p}'/>";
    write("c.yaml.xacro", &xacro(yaml));
    write("i.xacro.xacro", &xacro("<xacro:include filename='i.xacro'/>"));
    for (name, text) in texts {
        for mark in ["", "\u{feff}"] {
            fs::write(folder.path().join(name), wide(&format!("{mark}{text}"))).unwrap();
            let reader = ["urdf", "sdf", "xacro"].map(|extension| format!("{name}.{extension}"));
            let reader = reader.iter().find(|reader| folder.path().join(reader).exists());
            let (said, _) = match reader {
                Some(reader) => said(folder.path(), &["check", reader]),
                None => said(folder.path(), &["dataset", name, "-o", "shards"]),
            };
            assert!(said.contains("its text is in UTF-16LE, and UTF-8 is read"), "{name} {mark:?}: {said}");
            assert!(said.contains("convert it: iconv -f UTF-16LE -t UTF-8 "), "{name} {mark:?}: {said}");
        }
    }
}

#[test]
fn a_command_in_a_message_can_be_pasted_into_a_shell() {
    let folder = TempDir::new().unwrap();
    for name in ["dir mit ä", "it's $HOME; `ls`", "plain-dir"] {
        let inside = folder.path().join(name);
        fs::create_dir(&inside).unwrap();
        fs::write(inside.join("r.urdf"), ROBOT).unwrap();
        let (said, code) = said(folder.path(), &["check", name]);
        assert_eq!(code, Some(1));
        let (_, command) = said.split_once("or check all files: belvedere ").unwrap();
        let program = env!("CARGO_BIN_EXE_belvedere");
        let command = format!("'{program}' {}", command.lines().next().unwrap());
        let done = Command::new("sh").args(["-c", &command]).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stdout);
        assert!(done.status.success() && said.contains("1 file: 1 with notes"), "{command}: {said}");
    }
}

/// Robots of both formats, by themselves and in a world, are read without the meshes and models that are not found.
#[test]
fn skip_missing_skips_the_files_of_robots_too() {
    let folder = TempDir::new().unwrap();
    let uri = "<visual name='v'><geometry><mesh><uri>model://gone/a.stl</uri></mesh></geometry></visual>";
    let shape = "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>";
    let model =
        format!("<sdf version='1.6'><model name='r'><link name='l'>{uri}{shape}</link></model></sdf>");
    fs::write(folder.path().join("robot.sdf"), model).unwrap();
    let mesh = "<visual><geometry><mesh filename='package://gone/a.stl'/></geometry></visual>";
    let urdf = format!("<robot name='r'><link name='l'>{mesh}</link></robot>");
    fs::write(folder.path().join("robot.urdf"), urdf).unwrap();
    let domain = own_domain();
    for (file, missing) in [
        ("robot.sdf", "robot.sdf:1: warning: there is no mesh 'model://gone/a.stl'"),
        ("robot.urdf", "robot.urdf:1: warning: there is no mesh 'package://gone/a.stl'"),
    ] {
        let run = ["run", "--domain", &domain, "--rate", "max", "--duration", "0.1", "--robot", file];
        for arguments in [&["check", file][..], &["check", "--robot", file, "--world", "empty"], &run] {
            let (refused, code) = said(folder.path(), arguments);
            assert_eq!(code, Some(1), "{arguments:?}: {refused}");
            assert!(refused.contains(&missing.replace("warning", "error")), "{arguments:?}: {refused}");
            let (warned, code) = said(folder.path(), &[arguments, &["--skip-missing"]].concat());
            assert_eq!(code, Some(0), "{arguments:?}: {warned}");
            assert!(warned.contains(missing), "{arguments:?}: {warned}");
        }
    }
}

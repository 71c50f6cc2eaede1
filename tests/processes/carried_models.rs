//! The program alone, without its source and in an empty folder, has its robots and worlds.

use crate::live::belvedere;
use belvedere::description::load::{robot_names, world_names};
use belvedere::description::models::package_path;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/models");

/// A copy of the program in a separate folder, for which `models/` of the source is hidden.
struct Alone {
    folder: TempDir,
    program: PathBuf,
}

impl Alone {
    /// Returns `None`, which skips a test, if this user may not hide a folder.
    fn new() -> Option<Self> {
        let can_hide = Command::new("unshare")
            .args(["--user", "--map-root-user", "--mount", "mount", "-t", "tmpfs", "none", "/mnt"])
            .status()
            .is_ok_and(|status| status.success());
        if !can_hide {
            let forbidden = std::env::var_os("BELVEDERE_NO_SKIP").is_some_and(|value| value == "1");
            assert!(
                !forbidden,
                "a test would be skipped: this user may not make a mount namespace (unshare)"
            );
            return None;
        }
        let folder = TempDir::new().unwrap();
        let program = folder.path().join("bin/belvedere");
        fs::create_dir(folder.path().join("bin")).unwrap();
        fs::copy(env!("CARGO_BIN_EXE_belvedere"), &program).unwrap();
        Some(Self { folder, program })
    }

    fn cache(&self) -> PathBuf {
        self.folder.path().join("cache")
    }

    /// Runs a shell in a separate mount namespace without the folder `models/`; `$0` is the program.
    fn shell(&self, script: &str, environment: &[(&str, &Path)]) -> Output {
        // The parent folder is hidden, because the folder of the models must not exist.
        let hide = format!("set -e; mount -t tmpfs none '{}'; cd /; {script}", env!("CARGO_MANIFEST_DIR"));
        let mut command = Command::new("unshare");
        // The variables that are removed for the program are removed for the shell too.
        for (name, _) in belvedere().get_envs() {
            command.env_remove(name);
        }
        command.env("XDG_CACHE_HOME", self.cache());
        command.envs(environment.iter().copied());
        command.args(["--user", "--map-root-user", "--mount", "sh", "-c", &hide]).arg(&self.program);
        command.output().expect("unshare runs")
    }
}

/// Returns the output of a command and its exit status.
fn said(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    format!("{}{}{:?}\n", text(&output.stdout), text(&output.stderr), output.status.code())
}

#[test]
fn the_program_alone_checks_each_robot_and_world_as_in_the_source_tree() {
    let packages = package_path([], None);
    let worlds = world_names(&packages).into_iter().map(|name| format!("{name} --robot none"));
    let files: Vec<String> = robot_names(&packages).into_iter().chain(worlds).collect();
    assert!(files.len() >= 12, "{files:?}");
    let Some(alone) = Alone::new() else { return };
    let check = |file: &String| {
        let done = belvedere().arg("check").args(file.split(' ')).output().unwrap();
        assert!(done.status.success(), "{file}: {}", said(&done));
        said(&done)
    };
    let here: String = files.iter().map(check).collect();
    let checks: Vec<String> =
        files.iter().map(|file| format!("\"$0\" check {file} 2>&1; echo 'Some(0)'")).collect();
    let script = checks.join("; ");
    let there = alone.shell(&script, &[]);
    assert!(there.status.success(), "{}", said(&there));
    let unpacked = fs::read_dir(alone.cache().join("belvedere")).unwrap().next().unwrap().unwrap().path();
    let there = String::from_utf8(there.stdout).unwrap().replace(unpacked.to_str().unwrap(), MODELS);
    assert_eq!(there, here);
}

#[test]
fn an_explicit_folder_and_an_installed_one_win_over_what_is_carried() {
    let Some(alone) = Alone::new() else { return };
    let explicit = alone.folder.path().join("explicit");
    let world = |folder: &Path, name: &str| {
        fs::create_dir_all(folder.join("worlds")).unwrap();
        let text = format!("<sdf version='1.6'><world name='{name}'/></sdf>");
        fs::write(folder.join(format!("worlds/{name}.world")), text).unwrap();
    };
    let names = "\"$0\" check no_such || true";
    let carried = said(&alone.shell(names, &[]));
    assert!(carried.contains("corridor, empty, playground"), "{carried}");
    let installed = alone.folder.path().join("share/belvedere/models");
    world(&installed, "installed_world");
    let said_installed = said(&alone.shell(names, &[]));
    assert!(said_installed.contains("a world (installed_world)"), "{said_installed}");
    world(&explicit, "explicit_world");
    let said_explicit = said(&alone.shell(names, &[("BELVEDERE_MODELS", &explicit)]));
    assert!(said_explicit.contains("a world (explicit_world)"), "{said_explicit}");
}

#[test]
fn a_message_says_where_models_were_looked_for() {
    let nowhere = Path::new("/nowhere/models");
    for arguments in [["check", "playground"], ["run", "--world=playground"], ["run", "--robot=kobuki"]] {
        let output = belvedere()
            .args(arguments)
            .env("BELVEDERE_MODELS", nowhere)
            .env("ROS_PACKAGE_PATH", "/one:/two")
            .output()
            .unwrap();
        let said = said(&output);
        assert!(said.contains("looked for in /one, /two, /nowhere/models"), "{said}");
    }
}

#[test]
fn without_a_folder_that_can_be_written_the_program_says_so() {
    let Some(alone) = Alone::new() else { return };
    let blocked = alone.folder.path().join("file");
    fs::write(&blocked, "").unwrap();
    let environment = [("XDG_CACHE_HOME", &*blocked), ("TMPDIR", &*blocked)];
    let output = alone.shell("\"$0\" check playground || true", &environment);
    let said = said(&output);
    assert!(said.contains("cannot be unpacked") && said.contains("set XDG_CACHE_HOME"), "{said}");
    let share = alone.folder.path().join("share/belvedere/models");
    // In the source tree they are a link, whose target is missing here.
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/description/models");
    assert!(said.contains(share.to_str().unwrap()) && said.contains(source), "{said}");
}

//! The simulator with scarce resources: few files, little shared memory, little address space, a small stack.

use crate::live::{belvedere, own_domain};
use std::path::Path;
use std::process::{Command, Output};

/// Runs the simulator from a shell that sets something up before, and checks that it leaves nothing in shared memory.
fn run_after(set_up: &str, arguments: &[&str]) -> Output {
    let domain = own_domain();
    let output = after(set_up, &[&["run", "--domain", &domain], arguments].concat());
    let is_ours = |name: &str| name.split(['.', '~']).any(|part| part == domain);
    let left: Vec<String> = std::fs::read_dir("/dev/shm")
        .unwrap()
        .filter_map(|entry| entry.unwrap().file_name().into_string().ok())
        .filter(|name| is_ours(name))
        .collect();
    assert!(left.is_empty(), "{set_up}: {left:?} are left in /dev/shm");
    output
}

/// Runs a command from a shell that sets something up before.
fn after(set_up: &str, arguments: &[&str]) -> Output {
    let plain = belvedere();
    let mut command = Command::new("sh");
    command.args(["-c", &format!("{set_up} && exec \"$0\" \"$@\"")]).arg(plain.get_program()).args(arguments);
    for (name, value) in plain.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Each needs more than a hundred files.
fn eight_kinects() -> Vec<String> {
    let robots = (1..=8).flat_map(|number| {
        ["--robot".to_owned(), "kobuki_hexagons_kinect".to_owned(), "--name".to_owned(), format!("r{number}")]
    });
    let end = ["--world", "empty", "--rate", "max", "--duration", "0.05"];
    robots.chain(end.map(str::to_owned)).collect()
}

#[test]
fn eight_robots_need_no_higher_soft_limit_of_open_files() {
    let arguments = eight_kinects();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let output = run_after("ulimit -Sn 256", &arguments);
    assert!(output.status.success(), "{}", words(&output));
}

#[test]
fn a_hard_limit_of_open_files_is_named() {
    for limit in ["16", "64"] {
        let output = run_after(&format!("ulimit -n {limit}"), &["--rate", "max", "--duration", "0.1"]);
        let words = words(&output);
        assert_eq!(output.status.code(), Some(1), "{words}");
        assert!(words.contains(&format!("the {limit} of its limit")) && words.contains("nofile="), "{words}");
    }
}

#[test]
fn a_limit_of_address_space_is_named() {
    let output = run_after(
        "ulimit -v 300000",
        &["--robot", "kobuki_hexagons_kinect", "--rate", "max", "--duration", "0.1"],
    );
    let words = words(&output);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("MiB of address space") && words.contains("ulimit -v"), "{words}");
}

/// A chunk that declares a size of a gigabyte in a file of some kilobytes is detected before memory is reserved.
#[test]
fn a_damaged_size_in_a_recording_asks_for_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.mcap");
    let path = file.to_str().unwrap();
    let arguments = ["--robot", "none", "--world", "empty", "--rate", "max", "--duration", "0.1", "--record"];
    let output = run_after("true", &[&arguments[..], &[path]].concat());
    assert!(output.status.success(), "{}", words(&output));
    let mut bytes = std::fs::read(&file).unwrap();
    // Records by their opcodes and lengths, after the magic bytes; a chunk's size follows its two times.
    let mut at = 8;
    while bytes[at] != 6 {
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    bytes[at + 25..at + 33].copy_from_slice(&((1_u64 << 30) - 1).to_le_bytes());
    std::fs::write(&file, bytes).unwrap();
    let output = after("ulimit -v 700000", &["info", path]);
    let words = words(&output);
    assert_eq!(output.status.code(), Some(1), "{words}");
    assert!(words.contains("is left out: a chunk states a size of 1073741823 bytes"), "{words}");
}

#[test]
fn a_small_stack_is_enough() {
    let output = run_after("ulimit -s 128", &["--rate", "max", "--duration", "0.1"]);
    assert!(output.status.success(), "{}", words(&output));
}

/// As in Docker, with a /dev/shm of 64 MiB. The recorder subscribes to every stream and loses no frame.
#[test]
fn every_robot_runs_in_a_containers_shared_memory_with_a_consumer_of_each_stream() {
    let folder = std::env::temp_dir().join(format!("small-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/turtlebot_description/robots");
    let mut names: Vec<String> = std::fs::read_dir(robots)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".urdf.xacro", ""))
        .collect();
    names.sort();
    assert!(names.len() >= 8);
    // As root, or as root of a user namespace.
    let is_root = rustix::process::geteuid().is_root();
    let unshare = if is_root { "--mount --propagation=private" } else { "--mount --map-root-user" };
    for name in names {
        let file = folder.join(format!("{name}.mcap"));
        let set_up = format!(
            "exec unshare {unshare} sh -c 'mount -t tmpfs -o size=64m tmpfs /dev/shm && exec \"$0\" \"$@\"' \"$0\" \"$@\""
        );
        let arguments = ["--robot", &name, "--rate", "max", "--duration", "0.2", "--record"];
        let output = run_after(&set_up, &[&arguments[..], &[file.to_str().unwrap()]].concat());
        let words = words(&output);
        if !is_root && words.contains("unshare") {
            println!("skipped, user namespaces are not available here: {words}");
            break;
        }
        assert!(output.status.success(), "{name}: {words}");
        if name.ends_with("_kinect") {
            assert!(words.contains("room for 1 consumer instead of 8"), "{name}: {words}");
            assert!(words.contains("camera/depth/points") && words.contains("--shm-size"), "{name}: {words}");
            assert_eq!(words.matches("/dev/shm is too small").count(), 1, "reported once: {words}");
            let info = belvedere().arg("info").arg(&file).output().unwrap();
            let info = String::from_utf8_lossy(&info.stdout).into_owned();
            for topic in ["camera/depth/points", "camera/depth/image_raw", "camera/rgb/image_raw", "odom"] {
                assert!(info.contains(topic), "{topic} is not in {info}");
            }
            // A replay needs no more than the run did.
            let domain = own_domain();
            let arguments = ["replay", file.to_str().unwrap(), "--domain", &domain, "--rate", "max"];
            let output = after(&set_up, &arguments);
            let words = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success(), "{name}: {words}");
            assert!(words.contains("room for 1 consumer instead of 8"), "{name}: {words}");
            assert_eq!(words.matches("/dev/shm is too small").count(), 1, "reported once: {words}");
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

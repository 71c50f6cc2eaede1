//! Files and things of ours, given by their paths and names.

use crate::live::{Simulator, belvedere, follow, output, own_domain};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;

#[test]
fn a_path_that_is_mistyped_is_no_name_of_a_robot() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["run", "--robot", "my_robot.urdf.xacro"][..],
        &["run", "--world", "my.world"],
        &["check", "kobuki_nostack_camera.urdf"],
        &["check", "my.sdf"],
        &["urdf", "my.xacro"],
    ] {
        let refused = belvedere().current_dir(folder.path()).args(arguments).output().unwrap();
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(1), "{said}");
        assert!(said.contains("error: no such file; give the path of a "), "{said}");
        assert!(!said.contains("did you mean"), "{said}");
    }
}

#[test]
fn a_file_may_be_called_anything() {
    let folder = tempfile::tempdir().unwrap();
    let name = OsStr::from_bytes(b"r\xE9sum\xE9.urdf");
    let robot = output(&["urdf", "kobuki_nostack_rplidar"]).stdout;
    std::fs::write(folder.path().join(name), robot).unwrap();
    std::fs::write(folder.path().join("wrong.urdf"), "<robot").unwrap();
    let domain = own_domain();
    let run = ["run", "--domain", &domain, "--rate", "max", "--duration", "0.1", "--robot"];
    for arguments in [&["check"][..], &["urdf"], &run] {
        let done = belvedere().current_dir(folder.path()).args(arguments).arg(name).output().unwrap();
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    }
    let pcap = OsStr::from_bytes(b"nobody=\xE9.pcap");
    let arguments = ["run", "--domain", &domain, "--pcap"];
    let said = belvedere().current_dir(folder.path()).args(arguments).arg(pcap).output().unwrap();
    assert_eq!(said.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&said.stderr).contains("nobody"));
}

#[test]
fn a_world_can_be_run_without_a_robot_beside_its_own() {
    let simulator = Simulator::start(&["--robot", "none", "--world", "playground"]);
    let _clock = follow(simulator.domain(), "test", &["clock"]);
    let listed = output(&["list", "--domain", simulator.domain()]);
    let listed = String::from_utf8(listed.stdout).unwrap();
    assert!(listed.contains("/clock") && !listed.contains("/odom"), "{listed}");
    let beside =
        output(&["run", "--domain", &own_domain(), "--robot", "none", "--robot", "kobuki_nostack_camera"]);
    let said = String::from_utf8(beside.stderr).unwrap();
    assert!(said.contains("--robot none is combined with other robots"), "{said}");
}

#[test]
fn files_of_packets_are_not_replaced_unasked() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.pcap");
    std::fs::write(&file, "mine").unwrap();
    let target = format!("scan={}", file.display());
    for option in ["--pcap", "--lidar-metadata"] {
        let refused = output(&["run", "--domain", &own_domain(), option, &target]);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(1), "{said}");
        assert!(said.contains("run.pcap: the file exists; ") && said.contains("--force"), "{said}");
        assert_eq!(std::fs::read(&file).unwrap(), b"mine");
    }
}

#[cfg(not(feature = "link"))]
#[test]
fn a_command_that_was_left_out_says_so() {
    let refused = output(&["link", "send"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("built without 'link'; build it with --features link"), "{said}");
}

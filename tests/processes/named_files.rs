//! Files and built-in models, given by path or name.

use crate::live::{Simulator, belvedere, follow, output, own_domain};
use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;

#[test]
fn a_mistyped_path_is_not_taken_for_the_name_of_a_robot() {
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
fn a_world_that_is_given_as_a_robot_is_told_its_option() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["my.world", "my.sdf"] {
        std::fs::write(folder.path().join(name), "<sdf version='1.6'>\n<world name='w'/></sdf>").unwrap();
        let refused = belvedere().current_dir(folder.path()).args(["run", "--robot", name]).output().unwrap();
        let said = String::from_utf8(refused.stderr).unwrap();
        assert_eq!(refused.status.code(), Some(1), "{said}");
        let told = format!(
            "{name}:1: error: this file has a <world>, which is not a robot or an object; give the world with --world"
        );
        assert!(said.contains(&told), "{said}");
    }
}

#[test]
fn files_may_have_any_name() {
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
fn a_world_can_be_run_without_an_added_robot() {
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
fn packet_files_are_not_overwritten_without_force() {
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
fn a_command_that_is_not_built_in_is_named() {
    let refused = output(&["link", "send"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("built without 'link'; build it with --features link"), "{said}");
}

/// Every name that is listed can be checked, and a package of one's own adds to the list.
#[test]
fn names_of_robots_and_worlds_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let package = folder.path().join("turtlebot_description");
    std::fs::create_dir_all(package.join("robots")).unwrap();
    std::fs::write(package.join("package.xml"), "<package><name>turtlebot_description</name></package>")
        .unwrap();
    std::fs::write(package.join("robots/mine.urdf.xacro"), "<robot name='mine'><link name='l'/></robot>")
        .unwrap();
    let path = folder.path().to_str().unwrap();
    let lines = |arguments: &[&str]| -> Vec<String> {
        let said = String::from_utf8(output(arguments).stdout).unwrap();
        said.lines().map(str::to_owned).collect()
    };
    let robots = lines(&["robots", "--package-path", path]);
    assert!(robots.iter().any(|name| name == "mine"), "{robots:?}");
    assert!(robots.iter().any(|name| name == "kobuki_hexagons_vlp16_d435"), "{robots:?}");
    assert!(lines(&["robots"]).iter().all(|name| name != "mine"));
    let worlds = lines(&["worlds"]);
    assert_eq!(worlds, ["corridor", "empty", "playground", "tag_ceiling"]);
    for world in &worlds {
        let told = output(&["check", world]).stdout;
        assert!(String::from_utf8(told).unwrap().contains(&format!("{world}.world")), "{world}");
    }
}

//! Messages of commands: counts at their end, remedies that work, and nothing that a given option contradicts.

use crate::live::{Simulator, output};
use std::path::PathBuf;
use std::time::Duration;
use tempfile::TempDir;

/// Files in a folder of their own.
struct Files(TempDir);

impl Files {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path: PathBuf = self.0.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

/// What a command writes to both outputs, and its exit code.
fn said(args: &[&str]) -> (String, Option<i32>) {
    let done = output(args);
    (String::from_utf8([done.stdout, done.stderr].concat()).unwrap(), done.status.code())
}

/// A world with an element that is not known, and with more in it.
fn world(inside: &str) -> String {
    format!("<sdf version='1.8'><world name='w'>\n<nonsense/>{inside}</world></sdf>")
}

#[test]
fn check_ends_with_the_numbers_of_all_problems() {
    let files = Files::new();
    let bad = "<model name='m'><link name='l'><visual name='v'><geometry><box><size>1 1</size></box></geometry></visual></link></model>";
    let cases = [
        (world(""), "no errors, 1 warning\n", 0),
        (world(bad), "1 error, 1 warning\n", 1),
        (
            world(&format!("{bad}{}", bad.replace("'m'", "'n'").replace("1 1", "1"))),
            "2 errors, 1 warning\n",
            1,
        ),
    ];
    for (text, end, code) in cases {
        let file = files.write("w.world", &text);
        let (said, exit) = said(&["check", &file, "--robot", "none"]);
        assert!(said.ends_with(end) && exit == Some(code), "{said}");
    }
}

/// A warning that ends a run because of `--strict` says that it is one, so that "left out" is no contradiction.
#[test]
fn a_warning_that_is_an_error_says_so() {
    let files = Files::new();
    let file = files.write("w.world", &world(""));
    for command in [&["check", &*file, "--robot", "none"][..], &["run", "--world", &file, "--robot", "none"]]
    {
        let (said, exit) = said(&[command, &["--strict"]].concat());
        let line =
            ":2: error: <nonsense> of <world> is not known, and is left out (without --strict, a warning); ";
        assert!(said.contains(line) && exit == Some(1), "{said}");
    }
}

#[test]
fn urdf_of_a_file_of_sdf_is_refused_with_the_formats_that_it_takes() {
    let files = Files::new();
    let file = files.write("crate.sdf", "<sdf version='1.8'><model name='m'><link name='l'/></model></sdf>");
    let (text, exit) = said(&["urdf", &file]);
    let expected = format!(
        "{file}: error: this is a file of SDF, and no URDF can be made of it; name a .urdf or .xacro file"
    );
    assert!(text.starts_with(&expected) && exit == Some(1), "{text}");
    // The other commands take it, and say so.
    assert_eq!(said(&["check", &file, "--world", "empty"]).1, Some(0));
    let (help, _) = said(&["run", "--help"]);
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("The robot: a .urdf, .xacro or .sdf file, or"), "{help}");
    assert!(help.contains("DROPPED frames that could not be sent"), "{help}");
}

const XACRO: &str = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>ARGS<link name='b'/></robot>";

#[test]
fn an_argument_that_no_robot_has_is_told() {
    let files = Files::new();
    let with = |name: &str, args: &str| files.write(name, &XACRO.replace("ARGS", args));
    let own = with("own.urdf.xacro", "<xacro:arg name='use_camera' default='1'/>");
    // It is read without being declared: in a property that is used, and in an expression.
    let read = with(
        "read.urdf.xacro",
        "<xacro:property name='p' value='$(arg size)'/><xacro:if value='${p > 1}'/><xacro:if value='$(eval deep > 1)'/>",
    );
    let none = with("none.urdf.xacro", "");
    let sdf = files.write("m.sdf", "<sdf version='1.8'><model name='m'><link name='l'/></model></sdf>");
    let told = |robots: &[&str], given: &[&str]| {
        let robots: Vec<&str> = robots.iter().flat_map(|robot| ["--robot", robot]).collect();
        let (text, exit) = said(&[&["check", "empty"][..], &robots, given].concat());
        assert_eq!(exit, Some(0), "{text}");
        let lines = text.lines().filter(|line| line.contains("warning: this robot has no argument"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let lacks = |file: &str, name: &str| {
        format!("{file}: warning: this robot has no argument '{name}', which was given: it changes nothing; ")
    };
    assert_eq!(
        told(&[&own], &["use_camra:=0"]),
        [lacks(&own, "use_camra") + "did you mean 'use_camera'? there are: use_camera"]
    );
    assert!(told(&[&own], &["use_camera:=0"]).is_empty());
    assert!(told(&[&read], &["size:=2", "deep:=3"]).is_empty());
    assert_eq!(
        told(&[&none], &["nope:=1"]),
        [lacks(&none, "nope") + "leave it out: the robot has no arguments"]
    );
    assert_eq!(
        told(&[&sdf], &["nope:=1"]),
        [lacks(&sdf, "nope") + "leave it out: a file of SDF has no arguments"]
    );
    // All robots are given all arguments, so that one of them suffices.
    assert!(told(&[&own, &none], &["use_camera:=0"]).is_empty());
    assert_eq!(told(&[&own, &none], &["nope:=1"]).len(), 2);
    assert_eq!(
        told(&["none"], &["nope:=1"]),
        [lacks("the command line", "nope") + "leave it out: there is no robot"]
    );
}

/// A topic of commands exists because the simulator listens to it.
#[test]
fn a_topic_without_a_publisher_is_told_from_a_paused_simulator() {
    let [simulator, paused] = [&[][..], &["--paused"]].map(Simulator::start);
    for started in [&simulator, &paused] {
        while !said(&["list", "--domain", started.domain()]).0.contains("/cmd_vel") {
            std::thread::sleep(Duration::from_millis(50));
        }
    }
    let echo = |topic: &str| said(&["echo", topic, "--duration", "0.3", "--domain", simulator.domain()]).0;
    assert!(echo("/cmd_vel").contains("s: no program publishes it"), "{}", echo("/cmd_vel"));
    let (text, _) = said(&["hz", "/odom", "--duration", "0.3", "--domain", paused.domain()]);
    assert!(text.contains("s: is the simulator paused?"), "{text}");
}

/// A light in a robot is left out, and nothing is said of how it would move.
#[test]
fn a_light_of_a_robot_is_told_once() {
    let files = Files::new();
    let model = "<model name='m'><link name='l'><light name='lamp' type='point'/></link></model>";
    let robot = files.write("m.sdf", &format!("<sdf version='1.8'>{model}</sdf>"));
    let (text, _) = said(&["check", &robot, "--world", "empty"]);
    let lights: Vec<&str> =
        text.lines().filter(|line| line.contains(": warning: ") && line.contains("light")).collect();
    assert!(
        lights.len() == 1 && lights[0].contains("'lamp' is left out: lights belong to the world"),
        "{text}"
    );
    let world = files.write("w.world", &format!("<sdf version='1.8'><world name='w'>{model}</world></sdf>"));
    let (text, _) = said(&["check", &world, "--robot", "none"]);
    assert!(text.contains("warning: this light does not move with its link"), "{text}");
}

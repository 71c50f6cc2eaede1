//! A running simulation controlled from the command line, and its messages.

use crate::live;

use crate::live::control::{BOX, ROBOT, done_with, named, state};
use crate::live::{Simulator, next_frame, output};
use belvedere_bridge::{Operation, StreamSpec};

#[test]
fn the_command_line_reports_results_and_refusals() {
    let simulator = Simulator::start(&["--drive", "still"]);
    next_frame(&mut simulator.subscribe("clock"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("box.sdf");
    std::fs::write(&file, BOX).unwrap();
    let file = file.to_str().unwrap();
    let xacro = folder.path().join("robot.urdf.xacro");
    let text = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:arg name='link' default='base'/>\
                <link name='$(arg link)'/></robot>";
    std::fs::write(&xacro, text).unwrap();
    let xacro = xacro.to_str().unwrap();
    let control = |arguments: &[&str]| {
        let output = output(&[&["control", "--domain", simulator.domain()], arguments].concat());
        let said = [output.stdout, output.stderr].concat();
        (output.status.code().unwrap(), String::from_utf8(said).unwrap())
    };
    for (arguments, code, words) in [
        (&["pause"][..], 0, "pause: done at "),
        (&["query"], 0, "query: paused at "),
        (&["query", ROBOT], 0, "query: paused, robot at "),
        (&["query", "nobody"], 1, "query was refused: there is no model 'nobody'"),
        (&["step", "10"], 0, "step: done at "),
        (&["move", ROBOT, "0.5,-0.25,-90"], 0, "move: done"),
        (&["spawn", file, "--name", "crate", "--pose", "-1,-1,0.5,45"], 0, "spawn: done"),
        (&["query", "crate", "--json"], 0, "\"words\":[\"paused\",\"object\",\"spawned\"]"),
        (&["states"], 0, "crate "),
        (&["states", "--json"], 0, "{\"angular\":"),
        (&["states", "--links"], 0, "crate::body"),
        (&["spawn", file, "--name", "crate"], 1, "spawn was refused: there is a model 'crate' already"),
        (&["delete", "crate"], 0, "delete: done"),
        (&["move", "nobody", "-1,0", "--relative-to", "world"], 1, "no model 'nobody'"),
        (&["spawn", "no_such.sdf"], 1, "no_such.sdf: error: no such file"),
        // Robots: xacro with an argument, and one by its name, which has its topics in a namespace.
        (&["spawn", xacro, "link:=mast", "--name", "robot", "--pose", "2,0"], 0, "spawn: done"),
        (&["states", "--links"], 0, "robot::mast"),
        (&["spawn", xacro, "lnk:=mast", "--name", "other"], 0, "no argument 'lnk'"),
        (&["spawn", "kobuki_nostack_camera", "--namespace", "second", "--pose", "-2,0"], 0, "spawn: done"),
        (&["spawn", file, "--pose", "1"], 2, "write X,Y or X,Y,YAW or X,Y,Z,YAW"),
        // Deleted by the name of its namespace.
        (&["spawn", file, "--namespace", "carl"], 0, "spawn: done"),
        (&["delete", "carl"], 0, "delete: done"),
        (&["step", "0"], 2, "0 is not in"),
        (&["reset-world"], 0, "reset-world: done"),
        (&["reset"], 0, "reset: done at 0.000000000 s"),
        (&["resume"], 0, "resume: done"),
        (&["query"], 0, "query: playing at "),
    ] {
        let (found, said) = control(arguments);
        assert!(found == code && said.contains(words), "{arguments:?}: {found}: {said}");
    }
    // Reported at once, not after the timeout.
    let nobody = output(&["control", "pause", "--domain", &live::own_domain(), "--timeout", "1e6"]);
    let said = String::from_utf8(nobody.stderr).unwrap();
    assert!(nobody.status.code() == Some(1) && said.contains("nothing is published"), "{said}");
}

#[test]
fn the_error_for_a_file_that_is_not_a_model_names_its_kind() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let mut control = simulator.control();
    live::control::done(&mut control, Operation::Pause);
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let write = |name: &str, text: &str| {
        std::fs::write(path(name), text).unwrap();
        path(name)
    };
    let xacro = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>\n<link name='${1/0}'/></robot>";
    let expanded = "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'>\n\n<link name='l${1}'/><joint name='j'/></robot>";
    let wrong = "<sdf version='1.6'><model name='m'>\n<pose>1 2 x 0 0 0</pose><link name='l'/></model></sdf>";
    let wrong = write("wrong.sdf", wrong);
    for (file, words) in [
        (write("robot.xacro", xacro), ["robot.xacro:2: error: ", "division by zero"]),
        // The simulator refuses the expanded text, whose lines are those that `belvedere urdf` prints.
        (
            write("robot.urdf", expanded),
            ["spawn was refused: what `belvedere urdf ", "robot.urdf` prints:4: error: "],
        ),
        (write("thing.OBJ", "v 0 0 0\n"), ["thing.OBJ: error: this is a mesh", "<mesh><uri>"]),
        ("kobuki_hexagons_kinct".into(), ["no such robot", "did you mean 'kobuki_hexagons_kinect'"]),
        (path("gone.sdf"), ["gone.sdf: error: no such file", "check the path"]),
        (wrong.clone(), ["spawn was refused: ", "wrong.sdf:2: error: "]),
    ] {
        for name in [&[][..], &["--name", "carl"]] {
            let arguments = ["control", "--domain", simulator.domain(), "spawn", &file];
            let refused = output(&[&arguments[..], name].concat());
            let said = String::from_utf8(refused.stderr).unwrap();
            assert_eq!(refused.status.code(), Some(1), "{said}");
            assert!(words.iter().all(|words| said.contains(words)), "{file}: {said}");
        }
    }
}

#[test]
fn a_robot_can_be_given_a_name() {
    let simulator = Simulator::start(&["--drive", "still", "--name", "mobile_base"]);
    let mut control = simulator.control();
    done_with(&mut control, &named(Operation::SetModelState, "mobile_base"), "");
    let mut links = simulator.subscribe(StreamSpec::LINK_STATES);
    assert!(state(&mut links, "mobile_base::base_link").is_some());
    for (name, words) in [
        ("world", "is the world itself"),
        ("", "is the world itself"),
        ("a::b", "'::' separates a model"),
        (&"n".repeat(64), "more than 63 bytes"),
        ("tag_room", "a model of the world is called 'tag_room'"),
    ] {
        let refused = output(&["run", "--name", name, "--domain", &live::own_domain()]);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(!refused.status.success() && said.contains(words), "{name}: {said}");
    }
}

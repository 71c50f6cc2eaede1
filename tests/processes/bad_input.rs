//! Bad input to the command line gives one clear error that names file, line and remedy, an exit code other than 0, no
//! panic, and leaves no files behind.

use crate::live;

use crate::live::{files_of, output, own_domain};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const ROBOT: &str = r#"<?xml version="1.0"?>
<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
<link name="base_link"/>
<link name="eye"/>
<joint name="j" type="fixed"><parent link="base_link"/><child link="eye"/></joint>
<gazebo reference="eye">
<sensor type="camera" name="c"><update_rate>30</update_rate>
<camera><horizontal_fov>1.0</horizontal_fov>
<image><width>64</width><height>48</height><format>R8G8B8</format></image>
<clip><near>0.1</near><far>10</far></clip></camera>
<plugin name="p" filename="libgazebo_ros_camera.so"><imageTopicName>/eye</imageTopicName><cameraInfoTopicName>/eye_info</cameraInfoTopicName></plugin>
</sensor>
</gazebo>
<gazebo reference="base_link">
<sensor type="ray" name="l"><update_rate>10</update_rate>
<ray><scan><horizontal><samples>8</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
<range><min>0.1</min><max>5</max></range></ray>
<plugin name="p" filename="libgazebo_ros_laser.so"><topicName>/l</topicName></plugin>
</sensor>
</gazebo>
</robot>
"#;

/// A robot file that differs from a valid one in one place.
struct Case {
    name: &'static str,
    find: &'static str,
    replace: &'static str,
    /// The line that the error names; 0 if it names none.
    line: u32,
    /// Texts that the error contains.
    says: &'static [&'static str],
}

const CASES: &[Case] = &[
    Case { name: "broken XML", find: "</gazebo>\n</robot>", replace: "</robot>", line: 20, says: &["XML"] },
    Case {
        name: "unknown macro",
        find: "<link name=\"eye\"/>",
        replace: "<link name=\"eye\"/><xacro:senser_camera parent=\"eye\"/>",
        line: 4,
        says: &["senser_camera", "macro"],
    },
    Case {
        name: "undefined property",
        find: "<far>10</far>",
        replace: "<far>${farr}</far>",
        line: 10,
        says: &["farr"],
    },
    Case {
        name: "link without a parent, so two roots",
        find: "<link name=\"eye\"/>",
        replace: "<link name=\"eye\"/><link name=\"lost\"/>",
        line: 4,
        says: &["lost", "base_link"],
    },
    Case {
        name: "joint to a missing link",
        find: "<child link=\"eye\"/>",
        replace: "<child link=\"eyes\"/>",
        line: 5,
        says: &["eyes", "eye"],
    },
    Case {
        name: "unknown mesh format",
        find: "<link name=\"eye\"/>",
        replace: "<link name=\"eye\"><visual><geometry><mesh filename=\"file://MESH.step\"/></geometry></visual></link>",
        line: 4,
        says: &["step", "stl"],
    },
    Case {
        name: "image size 0",
        find: "<width>64</width>",
        replace: "<width>0</width>",
        line: 9,
        says: &["width", "0", "16384"],
    },
    Case {
        name: "image size 100000",
        find: "<height>48</height>",
        replace: "<height>100000</height>",
        line: 9,
        says: &["height", "100000", "16384"],
    },
    Case {
        name: "NaN range",
        find: "<max>5</max>",
        replace: "<max>nan</max>",
        line: 17,
        says: &["max", "nan"],
    },
    Case {
        name: "negative range",
        find: "<min>0.1</min>",
        replace: "<min>-0.1</min>",
        line: 17,
        says: &["min", "-0.1"],
    },
    Case {
        name: "min > max",
        find: "<min>0.1</min>",
        replace: "<min>6</min>",
        line: 17,
        says: &["min", "max", "6", "5"],
    },
    Case {
        name: "near > far",
        find: "<near>0.1</near>",
        replace: "<near>11</near>",
        line: 10,
        says: &["near", "far"],
    },
    Case {
        name: "an angle that is not a number",
        find: "<min_angle>-1</min_angle>",
        replace: "<min_angle>left</min_angle>",
        line: 16,
        says: &["angle"],
    },
    Case {
        name: "a topic that ROS forbids",
        find: "<topicName>/l</topicName>",
        replace: "<topicName>/my scan</topicName>",
        line: 18,
        says: &["<topicName> is '/my scan'", "' ' cannot be in a topic"],
    },
];

fn write(folder: &Path, name: &str, text: &str) -> PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path
}

/// Runs a robot file, checks what every failure has in common, and returns the standard error.
fn refused(arguments: &[&str]) -> String {
    let domain = own_domain();
    let mut all = vec!["run", "--domain", &domain, "--rate", "max", "--duration", "0.2"];
    all.extend(arguments);
    let output = output(&all);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments:?} said:\n{said}");
    assert!(!said.contains("panicked"), "{said}");
    assert_eq!(said.matches("error:").count(), 1, "one error for {arguments:?}:\n{said}");
    assert_eq!(files_of(&domain), Vec::<String>::new());
    said
}

#[test]
fn the_valid_file_of_the_cases_runs() {
    let folder = TempDir::new().unwrap();
    let robot = write(folder.path(), "good.urdf.xacro", ROBOT);
    let domain = own_domain();
    let run = output(&[
        "run",
        "--robot",
        robot.to_str().unwrap(),
        "--rate",
        "max",
        "--duration",
        "0.2",
        "--domain",
        &domain,
    ]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn a_wrong_value_in_a_robot_gives_one_error_with_its_place() {
    for case in CASES {
        let folder = TempDir::new().unwrap();
        assert!(ROBOT.contains(case.find), "{}", case.name);
        write(folder.path(), "MESH.step", "not a mesh");
        let text = ROBOT
            .replacen(case.find, case.replace, 1)
            .replace("MESH", folder.path().join("MESH").to_str().unwrap());
        let robot = write(folder.path(), "bad.urdf.xacro", &text);
        let said = refused(&["--robot", robot.to_str().unwrap()]);
        let place = format!("bad.urdf.xacro:{}: error:", case.line);
        assert!(said.contains(&place), "{}: not at line {}:\n{said}", case.name, case.line);
        for word in case.says {
            assert!(
                said.to_lowercase().contains(&word.to_lowercase()),
                "{}: no '{word}' in:\n{said}",
                case.name
            );
        }
        assert!(said.contains("; "), "{}: no remedy in:\n{said}", case.name);
    }
}

#[test]
fn missing_files_are_named() {
    let said = refused(&["--robot", "no/such.urdf.xacro"]);
    assert!(said.contains("no/such.urdf.xacro"), "{said}");
    let said = refused(&["--robot", "kobuki_nostack_camara"]);
    assert!(said.contains("kobuki_nostack_camera"), "the nearest name:\n{said}");
    let said = refused(&["--world", "no/such.world"]);
    assert!(said.contains("no/such.world"), "{said}");
    let said = refused(&["--world", "tag_cieling"]);
    assert!(said.contains("tag_ceiling"), "{said}");
}

#[test]
fn an_include_cycle_ends() {
    let folder = TempDir::new().unwrap();
    let include = |file: &str| {
        format!("<robot name=\"r\" xmlns:xacro=\"http://x\">\n<xacro:include filename=\"{file}\"/>\n</robot>")
    };
    let one = folder.path().join("one.xacro");
    let two = write(folder.path(), "two.xacro", &include(one.to_str().unwrap()));
    write(folder.path(), "one.xacro", &include(two.to_str().unwrap()));
    let said = refused(&["--robot", one.to_str().unwrap()]);
    assert!(
        said.contains("one.xacro") && said.contains("two.xacro") && said.contains(":2: error:"),
        "{said}"
    );
}

/// The article's Hokuyo refers to a link that no file defines. Gazebo ignores it silently; here it is an error.
#[test]
fn a_sensor_on_a_missing_link_is_an_error_unless_in_gazebo_mode() {
    let folder = TempDir::new().unwrap();
    let text = ROBOT.replacen("reference=\"base_link\"", "reference=\"bass_link\"", 1);
    let robot = write(folder.path(), "bad.urdf.xacro", &text);
    let robot = robot.to_str().unwrap();
    let said = refused(&["--robot", robot]);
    for word in ["bass_link", "base_link", "--gazebo-compat", "bad.urdf.xacro:1"] {
        assert!(said.contains(word), "no '{word}' in:\n{said}");
    }
    let domain = own_domain();
    let run = output(&[
        "run",
        "--robot",
        robot,
        "--gazebo-compat",
        "--rate",
        "max",
        "--duration",
        "0.1",
        "--domain",
        &domain,
    ]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn wrong_options_are_explained() {
    for (arguments, says) in [
        (&["--remap", "/scan:=/front/scan"][..], "not provided:\n  --ros2"),
        (&["--jpeg-quality", "95"], "not provided:\n  --ros2"),
        (&["--port", "0"], "not provided:\n  --view"),
        (&["--no-browser"], "not provided:\n  --view"),
        (&["--patience", "5"], "not provided:\n  <--wait-for <NAME[=STREAMS]>|--record <FILE>>"),
        (&["--duration", "-1"], "not negative"),
        (&["--rate", "slow"], "realtime"),
        (&["--drive", "fly"], "spin"),
        (&["--domain", "a b"], "domain"),
        (&["--seed", "x"], "seed"),
    ] {
        let mut all = vec!["run"];
        all.extend(arguments);
        let output = output(&all);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(says), "{said}");
    }
    let said = output(&["run", "--world", "/dev/null"]);
    assert_eq!(said.status.code(), Some(1));
    let said = String::from_utf8_lossy(&said.stderr);
    assert!(said.contains("it is empty, or a pipe that nobody writes into; name another file"), "{said}");
    // Neither a command nor an argument of xacro.
    let said = output(&["snapshto"]);
    assert_eq!(said.status.code(), Some(2));
    let said = String::from_utf8_lossy(&said.stderr);
    assert!(said.contains("did you mean the command 'snapshot'?"), "{said}");
}

#[test]
fn an_unwritable_picture_is_refused_before_anything_is_written() {
    let simulator = live::Simulator::start(&["--drive", "still"]);
    live::next_frame(&mut simulator.subscribe("/scan"));
    let folder = TempDir::new().unwrap();
    let target = folder.path().join("no/such/folder/out.png");
    let shot = output(&["snapshot", "/scan", target.to_str().unwrap(), "--domain", simulator.domain()]);
    let said = String::from_utf8_lossy(&shot.stderr);
    assert!(!shot.status.success() && said.contains("out.png") && !said.contains("panicked"), "{said}");
    let shot = output(&["snapshot", "/skan", "out.png", "--domain", simulator.domain()]);
    let said = String::from_utf8_lossy(&shot.stderr);
    assert!(!shot.status.success() && said.contains("/scan"), "the nearest topic:\n{said}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

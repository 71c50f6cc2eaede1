//! `belvedere urdf`: its output is the robot that was loaded, in a form that needs no xacro and no package path.

use crate::live::belvedere;
use belvedere::description::load::{LoadOptions, load_robot, robot_names};
use belvedere::description::model::Model;
use belvedere::description::models::package_path;
use belvedere::description::package::PackagePath;
use belvedere::description::xml::Element;
use belvedere::description::{Diagnostics, Rules};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// In Gazebo mode, because one of the articles' robots has a sensor on a missing link.
fn load(name: &str, packages: PackagePath) -> Model {
    let options = LoadOptions {
        packages,
        rules: Rules { gazebo_compat: true, ..Rules::default() },
        xacro_args: Vec::new(),
    };
    let mut diagnostics = Diagnostics::default();
    let robot = load_robot(name, &options, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{:#?}", diagnostics.problems());
    robot.unwrap()
}

/// The standard output and the standard error of the command.
fn urdf(arguments: &[&str]) -> (String, String) {
    let done = belvedere().arg("urdf").args(arguments).output().unwrap();
    let said = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{arguments:?}: {said}");
    (String::from_utf8(done.stdout).unwrap(), said)
}

/// All data of a robot except the places in files.
fn content(robot: &Model) -> String {
    let mut text = format!("{robot:?}");
    while let Some(start) = text.find("source: Source {") {
        let end = start + text[start..].find('}').unwrap();
        text.replace_range(start..=end, "");
    }
    text
}

/// Reads a printed text from a folder without other files. Frames of sensors, which are tested in `sensor_frames.rs`, are
/// removed.
fn read_again(printed: &str) -> Model {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("printed.urdf");
    fs::write(&file, printed).unwrap();
    let mut robot = load(file.to_str().unwrap(), package_path([], None));
    let is_optical = |link: usize| robot.links[link].name.ends_with("_optical");
    robot.joints.retain(|joint| !is_optical(joint.child));
    robot.links.retain(|link| !link.name.ends_with("_optical"));
    robot
}

fn assert_plain(element: &Element) {
    assert!(!element.name.starts_with("xacro:"), "{}", element.name);
    for (name, value) in &element.attributes {
        assert!(!name.starts_with("xacro:") && !value.contains('$'), "{name}={value}");
    }
    element.elements().for_each(assert_plain);
}

#[test]
fn all_our_robots_survive_a_round_trip() {
    let names = robot_names(&package_path([], None));
    assert!(names.len() >= 8, "{names:?}");
    for name in &names {
        let (printed, said) = urdf(&[name]);
        assert_eq!(said, "", "{name}");
        assert_plain(&Element::parse(&printed, Path::new("printed")).unwrap());
        let ours = load(name, package_path([], None));
        assert!(!ours.sensors.is_empty());
        assert_eq!(content(&read_again(&printed)), content(&ours), "{name}");
    }
}

#[test]
fn the_articles_robots_survive_a_round_trip() {
    let shared = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/seed-robot"));
    for (folder, name) in
        [("ceiling-camera", "kobuki_nostack_camera"), ("kinect-hokuyo", "kobuki_hexagons_KinectHokuyo")]
    {
        let folder = shared.join(folder);
        if !folder.is_dir() {
            continue;
        }
        let robot = load(name, package_path([folder.clone()], None));
        let (printed, _) = urdf(&[name, "--package-path", folder.to_str().unwrap()]);
        assert_eq!(content(&read_again(&printed)), content(&robot), "{name}");
    }
}

#[test]
fn the_environment_has_the_same_effect_as_for_run() {
    let mut command = belvedere();
    command.arg("urdf").env("TURTLEBOT_STACKS", "hexagons").env("TURTLEBOT_3D_SENSOR", "kinect");
    let printed = String::from_utf8(command.output().unwrap().stdout).unwrap();
    assert_eq!(printed, urdf(&["kobuki_hexagons_kinect"]).0);
}

/// Files from a user's own packages, from a package that only --package-path or `ROS_PACKAGE_PATH` contains, with names
/// with spaces, and beside the robot's own file.
#[test]
fn files_are_named_by_absolute_paths() {
    let workspace = TempDir::new().unwrap();
    let arm = workspace.path().join("my packages/arm_description");
    fs::create_dir_all(arm.join("urdf")).unwrap();
    fs::create_dir_all(arm.join("meshes")).unwrap();
    for mesh in ["meshes/lower arm.obj", "meshes/100%.obj", "urdf/near.obj"] {
        fs::write(arm.join(mesh), SQUARE).unwrap();
    }
    fs::write(
        arm.join("urdf/arm.xacro"),
        "<robot xmlns:xacro='http://ros.org/wiki/xacro'><xacro:macro name='arm' params='name mesh'>
        <link name='${name}'><visual><geometry><mesh filename='${mesh}' scale='1 2 3'/></geometry></visual></link>
        <joint name='${name}_joint' type='fixed'><parent link='base_link'/><child link='${name}'/>
        <origin xyz='${1/2} 0 0'/></joint></xacro:macro></robot>",
    )
    .unwrap();
    let robot = arm.join("urdf/robot.urdf.xacro");
    fs::write(
        &robot,
        "<robot name='a &lt; &quot;b&quot;' xmlns:xacro='http://ros.org/wiki/xacro'>
        <xacro:include filename='$(find arm_description)/urdf/arm.xacro'/><link name='base_link'/>
        <xacro:arm name='a' mesh='package://arm_description/meshes/lower arm.obj'/>
        <xacro:arm name='b' mesh='package://arm_description/meshes/100%.obj'/>
        <xacro:arm name='c' mesh='near.obj'/>
        <gazebo><plugin name='p' filename='libmine.so'><mesh filename='package://arm_description/its_own'/></plugin></gazebo>
        </robot>",
    )
    .unwrap();
    let (robot, packages) = (robot.to_str().unwrap(), workspace.path().join("my packages"));
    let (printed, said) = urdf(&[robot, "--package-path", packages.to_str().unwrap()]);
    assert_eq!(said, "");
    for expected in ["/meshes/lower%20arm.obj\"", "/meshes/100%25.obj\"", "/urdf/near.obj\"", "my%20packages"]
    {
        assert!(printed.contains(expected), "{printed}");
    }
    assert!(printed.contains("filename=\"package://arm_description/its_own\""), "{printed}");
    assert_eq!(printed.matches("file:///").count(), 3, "{printed}");
    let loaded = load(robot, package_path([packages.clone()], None));
    assert_eq!(loaded.name, "a < \"b\"");
    assert_eq!(content(&read_again(&printed)), content(&loaded));

    let through_ros = belvedere().args(["urdf", robot]).env("ROS_PACKAGE_PATH", &packages).output().unwrap();
    assert_eq!(String::from_utf8(through_ros.stdout).unwrap(), printed);
}

/// Input that urdfdom would refuse: a robot without a name, materials defined twice, late, only by Gazebo, or not at
/// all.
#[test]
fn materials_are_defined_once_and_before_they_are_used() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.urdf.xacro");
    let box_of =
        |material: &str| format!("<visual><geometry><box size='1 1 1'/></geometry>{material}</visual>");
    let text = format!(
        "<robot><material name='Red'><color rgba='1 0 0 1'/></material><material name='Red'><color rgba='0 1 0 1'/></material>
        <material name='Late'/><link name='a'>{}{}</link><link name='b'>{}{}</link><link name='c'>{}</link>
        <joint name='ab' type='fixed'><parent link='a'/><child link='b'/></joint>
        <joint name='ac' type='fixed'><parent link='a'/><child link='c'/></joint></robot>",
        box_of("<material name='Red'/>"),
        box_of("<material name='Late'/>"),
        box_of("<material name='Gazebo/Green'/>"),
        box_of("<material name='Nowhere'/>"),
        box_of("<material name='Late'><color rgba='0 0 1 1'/></material>"),
    );
    fs::write(&file, text).unwrap();
    let (printed, _) = urdf(&[file.to_str().unwrap()]);
    let robot = Element::parse(&printed, Path::new("printed")).unwrap();
    assert_eq!(robot.attribute("name"), Some("robot"));
    let mut defined: Vec<_> = robot
        .elements_named("material")
        .map(|material| {
            let color = material.child("color").unwrap_or_else(|| panic!("{printed}"));
            (material.attribute("name").unwrap(), color.attribute("rgba").unwrap())
        })
        .collect();
    defined.sort_unstable();
    let names: Vec<_> = defined.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["Gazebo/Green", "Late", "Nowhere", "Red"]);
    assert_eq!((defined[1].1, defined[3].1), ("0 0 1 1", "1 0 0 1"));
    let original = load(file.to_str().unwrap(), package_path([], None));
    for (again, before) in read_again(&printed).links.iter().zip(&original.links) {
        for (again, before) in again.visuals.iter().zip(&before.visuals) {
            assert_eq!(again.material.diffuse, before.material.diffuse);
        }
    }
}

#[test]
fn a_missing_file_keeps_its_name_and_is_reported() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("r.urdf");
    let robot = "<robot name='r'><link name='l'><visual><geometry>\n<mesh filename='package://gone/m.stl'/></geometry></visual></link></robot>";
    fs::write(&file, robot).unwrap();
    let (printed, said) = urdf(&[file.to_str().unwrap()]);
    assert!(printed.contains("package://gone/m.stl"), "{printed}");
    assert!(said.contains("r.urdf:2") && said.contains("there is no mesh 'package://gone/m.stl'"), "{said}");
}

#[test]
fn files_that_are_not_robots_are_refused() {
    let folder = TempDir::new().unwrap();
    for (name, text, says) in [
        ("w.urdf", "<sdf><world/></sdf>", "the outermost element is <sdf>"),
        (
            "x.urdf.xacro",
            "<robot name='r'>\n<xacro:gone xmlns:xacro='x'/></robot>",
            "x.urdf.xacro:2: error: ",
        ),
        (
            "y.urdf.xacro",
            "<robot name='r' xmlns:xacro='x'>\n<link><xacro:attribute name='${1 + 1}' value='1'/></link></robot>",
            "'2' cannot be the name",
        ),
        (
            "z.urdf.xacro",
            "<robot name='r' xmlns:xacro='x'>\n<xacro:element xacro:name='a b'/></robot>",
            "'a b' cannot be the name",
        ),
    ] {
        let file = folder.path().join(name);
        fs::write(&file, text).unwrap();
        let done = belvedere().arg("urdf").arg(&file).output().unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(1), "{said}");
        assert!(done.stdout.is_empty());
        assert!(said.contains(says) && said.lines().count() == 1, "{said}");
    }
}

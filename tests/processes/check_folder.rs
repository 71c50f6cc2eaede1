//! `check --all` reports the result for each file of a folder, and `check` alone that of one file.

use crate::live::output;
use std::fs;
use tempfile::TempDir;

fn write(folder: &TempDir, name: &str, text: &str) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

/// Returns the standard output, the standard error and the exit code of `check` with these arguments.
fn checked(arguments: &[&str]) -> (String, String, Option<i32>) {
    let done = output(&[&["check"], arguments].concat());
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (text(done.stdout), text(done.stderr), done.status.code())
}

const XACRO: &str = "xmlns:xacro='http://ros.org/wiki/xacro'";

/// A folder like a repository: packages beside each other, models, worlds.
fn repository() -> TempDir {
    let folder = TempDir::new().unwrap();
    write(&folder, "arm_description/package.xml", "<package><name>arm_description</name></package>");
    write(
        &folder,
        "arm_description/urdf/link.xacro",
        &format!(
            "<robot {XACRO}><xacro:macro name='part' params='name'><link name='${{name}}'/></xacro:macro></robot>"
        ),
    );
    // Its macros are defined by the files that include it.
    write(
        &folder,
        "arm_description/urdf/needs.xacro",
        &format!(
            "<robot {XACRO}><xacro:property name='w' value='${{2 * width}}'/><xacro:macro name='m'><a b='${{w}}'/></xacro:macro></robot>"
        ),
    );
    let arm = |inside: &str| {
        format!(
            "<robot name='arm' {XACRO}><xacro:include filename='$(find arm_description)/urdf/link.xacro'/>
             <xacro:part name='base'/>{inside}</robot>"
        )
    };
    write(&folder, "arm_bringup/arm.urdf.xacro", &arm(""));
    write(
        &folder,
        "arm_bringup/size.urdf.xacro",
        &arm(
            "<link name='$(arg tip)'/><joint name='j' type='fixed'><parent link='base'/><child link='$(arg tip)'/></joint>",
        ),
    );
    write(
        &folder,
        "arm_bringup/colours.urdf",
        &format!("<robot {XACRO}><material name='m'><color rgba='1 0 0 1'/></material></robot>"),
    );
    write(&folder, "arm_bringup/typo.urdf", "<robot name='r'><link name='l'><visul/></link></robot>");
    write(&folder, "arm_bringup/broken.urdf", "<robot name='r'>\n<link name='l'></robot>");
    write(&folder, "arm_bringup/.hidden/broken.urdf", "<robot>");
    let model = "<sdf version='1.6'><model name='crate'><static>1</static><link name='l'/></model></sdf>";
    write(&folder, "models/crate/model.sdf", model);
    write(&folder, "models/crate/model.config", "<model><name>crate</name><sdf>model.sdf</sdf></model>");
    write(&folder, "models/meshes/model.config", "<model><name>meshes</name></model>");
    write(&folder, "models/lost/model.config", "<model><name>lost</name><sdf>lost.sdf</sdf></model>");
    // The world's own robot publishes the same streams as the TurtleBot, so no TurtleBot is added.
    let world = |inside: &str| format!("<sdf version='1.6'><world name='w'>{inside}</world></sdf>");
    let own = "<include><uri>model://crate</uri></include><model name='own'><static>1</static><link name='l'>
               <sensor name='s' type='ray'><topic>/scan</topic><update_rate>5</update_rate><ray><range><min>0.1</min><max>5</max></range></ray></sensor></link></model>";
    write(&folder, "worlds/own.world", &world(own));
    write(&folder, "worlds/gone.sdf", &world("<include><uri>model://gone</uri></include>"));
    folder
}

#[test]
fn each_file_of_a_folder_has_a_line_and_none_stops_the_others() {
    let folder = repository();
    let at = folder.path().to_str().unwrap();
    let (said, warned, code) = checked(&["--all", at]);
    assert_eq!(code, Some(1), "{said}\n{warned}");
    let row = |file: &str| {
        let line = said.lines().find(|line| line.starts_with(&format!("{file} ")));
        line.unwrap_or_else(|| panic!("no {file} in\n{said}"))[file.len()..].trim().to_owned()
    };
    for (file, kind, result) in [
        ("arm_bringup/arm.urdf.xacro", "robot", "1 note"),
        ("arm_bringup/colours.urdf", "robot", "macros only"),
        ("arm_bringup/broken.urdf", "robot", "error: arm_bringup/broken.urdf:2: error: "),
        ("arm_bringup/size.urdf.xacro", "robot", "error: arm_bringup/size.urdf.xacro:2: error: "),
        ("arm_bringup/typo.urdf", "robot", "1 warning and 1 note"),
        ("arm_description/urdf/link.xacro", "robot", "macros only"),
        ("arm_description/urdf/needs.xacro", "robot", "macros only"),
        ("models/crate/model.sdf", "model", "1 note"),
        (
            "models/lost/model.config",
            "model",
            "error: models/lost/model.config:1: error: <sdf> names lost.sdf",
        ),
        ("worlds/gone.sdf", "world", "error: worlds/gone.sdf:1: error: "),
        ("worlds/own.world", "world", "ok"),
    ] {
        let (found_kind, found) =
            row(file).split_once(' ').map(|(a, b)| (a.to_owned(), b.trim().to_owned())).unwrap();
        assert_eq!(found_kind, kind, "{said}");
        let fits = if result.starts_with("error") { found.starts_with(result) } else { found == result };
        assert!(fits, "{file}: {found}\n{said}");
    }
    let last = said.lines().last().unwrap();
    assert_eq!(last, "11 files: 1 ok, 2 with notes, 1 with warnings, 3 macros only, 4 failed", "{said}");
    assert!(warned.contains("4 of 11 files cannot be run"), "{warned}");

    // Arguments of xacro apply to all robots, and warnings count as errors on request.
    let (said, _, _) = checked(&["--all", at, "tip:=hand"]);
    assert!(
        said.ends_with("11 files: 1 ok, 3 with notes, 1 with warnings, 3 macros only, 3 failed\n"),
        "{said}"
    );
    let (said, _, _) = checked(&["--all", at, "--strict"]);
    assert!(said.ends_with("11 files: 1 ok, 2 with notes, 3 macros only, 5 failed\n"), "{said}");
    // The folder is left out of every path, however it is written, and of nothing else.
    let lost = |at: &str| {
        let (said, _, _) = checked(&["--all", at]);
        said.lines().find(|line| line.starts_with("worlds/gone.sdf")).unwrap().to_owned()
    };
    let dotted = format!("{at}/worlds/../");
    for at in [at, &format!("{at}/"), &dotted] {
        let line = lost(at);
        assert!(line.contains("error: worlds/gone.sdf:1: error: there is no model"), "{line}");
        assert!(line.contains(", worlds/models/gone, worlds/../models/gone, "), "{line}");
    }
    let good = folder.path().join("models/crate");
    let (said, _, code) = checked(&["--all", good.to_str().unwrap()]);
    assert_eq!((said.lines().last(), code), (Some("1 file: 1 with notes"), Some(0)), "{said}");
}

#[test]
fn a_folder_without_anything_to_check_is_an_error() {
    let folder = TempDir::new().unwrap();
    let at = folder.path().to_str().unwrap();
    let nowhere = folder.path().join("nowhere");
    for (arguments, words) in [
        (&["--all", at][..], "there is no .urdf, .xacro, .sdf or .world file in this folder"),
        (&["--all", nowhere.to_str().unwrap()], "cannot read"),
        (&["playground", "--all", at], "'playground' is given together with --all"),
    ] {
        let (_, warned, code) = checked(arguments);
        assert_eq!(code, Some(1), "{arguments:?}");
        assert!(warned.contains(words), "{arguments:?}: {warned}");
    }
}

#[test]
fn a_robot_is_reported_alone_and_robot_none_is_refused() {
    let (said, _, code) = checked(&["kobuki_nostack_camera"]);
    assert_eq!(code, Some(0));
    assert!(said.starts_with("robot "), "{said}");
    let (said, _, _) = checked(&["kobuki_nostack_camera", "--world", "empty"]);
    assert!(said.starts_with("world "), "{said}");
    let (_, warned, code) = checked(&["kobuki_nostack_camera", "--robot", "none"]);
    assert_eq!(code, Some(1));
    let words = "'kobuki_nostack_camera' is a robot, but --robot none is given; leave out --robot none";
    assert!(warned.contains(words), "{warned}");
}

#[test]
fn a_picture_that_cannot_be_decoded_is_a_warning() {
    let folder = TempDir::new().unwrap();
    write(&folder, "a.png", "no picture");
    let visual = "<visual><geometry><box size='1 1 1'/></geometry><material name='m'><texture filename='NAME'/></material></visual>";
    for (name, words) in [
        ("a.png", "a.png cannot be used, so the surface is drawn without it"),
        ("gone.png", "there is no texture 'gone.png': looked for "),
    ] {
        let text =
            format!("<robot name='r'>\n<link name='l'>{}</link></robot>", visual.replace("NAME", name));
        write(&folder, "r.urdf", &text);
        let file = folder.path().join("r.urdf");
        let file = file.to_str().unwrap();
        let (said, warned, code) = checked(&[file]);
        assert_eq!(code, Some(0), "{warned}");
        let warning = said.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{said}"));
        assert!(warning.starts_with(&format!("{file}:2: warning: ")), "{warning}");
        assert!(said.ends_with("no errors, 1 warning and 1 note\n"), "{said}");
        assert_eq!(checked(&[file, "--strict"]).2, Some(1));
    }
}

#[test]
fn names_that_differ_in_what_no_topic_can_hold_do_not_refuse_a_world() {
    let folder = TempDir::new().unwrap();
    let model = |name: &str| {
        format!(
            "<model name='{name}'><static>1</static><link name='l'><sensor name='s' type='imu'><update_rate>5</update_rate>
             </sensor></link></model>"
        )
    };
    let (one, two) = (model("a b"), model("a:b"));
    write(&folder, "w.world", &format!("<sdf version='1.6'><world name='w'>{one}{two}</world></sdf>"));
    let file = folder.path().join("w.world");
    let (said, warned, code) = checked(&[file.to_str().unwrap(), "--robot", "none"]);
    assert_eq!(code, Some(0), "{said}\n{warned}");
    for topic in ["/world/w/model/a_b/link/l/sensor/s/imu: ", "/world/w/model/a_b/link/l/sensor/s/imu_2: "] {
        assert!(said.contains(topic), "{topic}\n{said}");
    }
    assert!(said.contains("it is published as /world/w/model/a_b/link/l/sensor/s/imu_2"), "{said}");
}

#[test]
fn a_folder_without_all_is_named() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().to_str().unwrap();
    let (_, said, code) = checked(&[path]);
    assert!(said.contains("this is a folder") && said.contains("check --all"), "{said}");
    assert_eq!(code, Some(1));
}

/// A file that is checked by itself may have the name of a model of the world in which robots are checked.
#[test]
fn a_floor_of_ones_own_is_no_error_in_a_folder() {
    let folder = TempDir::new().unwrap();
    let floor =
        "<sdf version='1.6'><model name='ground_plane'><static>1</static><link name='l'/></model></sdf>";
    write(&folder, "ground_plane/model.sdf", floor);
    let (said, _, code) = checked(&["--all", folder.path().to_str().unwrap()]);
    assert_eq!((said.lines().last(), code), (Some("1 file: 1 with notes"), Some(0)), "{said}");
}

/// A wheel that Gazebo turns without end drives, also if its joint is written as SDF writes it.
#[test]
fn a_wheel_with_the_limits_of_sdf_drives() {
    let folder = TempDir::new().unwrap();
    let cart = |limit: &str, axis: &str| {
        let inertial = "<inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/></inertial>";
        let ball = "<collision><geometry><sphere radius='.1'/></geometry></collision>";
        let wheel = |side: &str, y: &str| {
            format!(
                "<link name='{side}'>{inertial}{ball}</link><joint name='{side}_joint' type='revolute'><parent link='b'/>
                 <child link='{side}'/><origin xyz='0 {y} 0' rpy='0 0 1.57'/><axis xyz='{axis}'/>
                 <limit lower='-{limit}' upper='{limit}' effort='9' velocity='9'/></joint>"
            )
        };
        let text = format!(
            "<robot name='cart'><link name='b'>{inertial}</link>{}{}<gazebo><plugin name='d' filename='libgazebo_ros_diff_drive.so'>
             <left_joint>l_joint</left_joint><right_joint>r_joint</right_joint><wheel_separation>.4</wheel_separation>
             <wheel_diameter>.2</wheel_diameter></plugin></gazebo>{}</robot>",
            wheel("l", ".2"),
            wheel("r", "-.2"),
            "<gazebo><plugin name='r' filename='librotor.so'/></gazebo>".repeat(3),
        );
        write(&folder, "cart.urdf", &text);
        let (said, _, _) = checked(&[folder.path().join("cart.urdf").to_str().unwrap()]);
        said
    };
    let said = cart("1e+16", "1 0 0");
    assert!(said.contains("base differential drive") && !said.contains("cannot drive"), "{said}");
    assert_eq!(
        said.matches("the plugin 'librotor.so' of model 'cart' is not simulated").count(),
        1,
        "{said}"
    );
    let said = cart("2", "1 0 0");
    assert!(
        said.contains("cannot drive: joint 'l_joint' turns only from -2 to 2 rad; make it continuous"),
        "{said}"
    );
    let said = cart("1e16", "0 0 1");
    assert!(
        said.contains("'l_joint' does not turn about the base's y axis; turn its axis so that"),
        "{said}"
    );
}

#[test]
fn the_folder_itself_is_shown_as_a_dot() {
    let folder = TempDir::new().unwrap();
    let text = format!("<robot name='r' {XACRO}><xacro:include filename='$(find nobodys)/a.xacro'/></robot>");
    write(&folder, "r.urdf.xacro", &text);
    let at = format!("{}/", folder.path().display());
    let (said, _, _) = checked(&["--all", &at]);
    assert!(said.contains("package 'nobodys' is in none of the folders ., "), "{said}");
}

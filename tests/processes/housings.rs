//! A lidar in a housing sees through it, and sees everything else.

use crate::live::{Simulator, belvedere, next_frame};
use std::fmt::Write as _;
use tempfile::TempDir;

const WORLD: &str = "<sdf version='1.6'><world name='w'>
    <model name='wall'><pose>3 0 1 0 0 0</pose><static>true</static><link name='l'><collision name='c'><geometry><box><size>0.2 20 4</size></box></geometry></collision></link></model>
    </world></sdf>";

/// A closed box of 0.1 m around the origin as a mesh, without this number of its sides.
fn cube(left_out: usize) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let at = [0, 1, 2].map(|axis| if corner >> axis & 1 == 1 { 0.05 } else { -0.05 });
        writeln!(text, "v {} {} {}", at[0], at[1], at[2]).unwrap();
    }
    let faces = ["1 3 7 5", "2 6 8 4", "1 5 6 2", "3 4 8 7", "1 2 4 3", "5 7 8 6"];
    for face in &faces[left_out..] {
        let [a, b, c, d] = face.split(' ').collect::<Vec<_>>()[..] else { panic!() };
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    text
}

/// A floating robot with a lidar of four beams (ahead, left, behind, right), its housing, and more.
fn robot(housing: &str, more: &str) -> String {
    format!(
        "<robot name='r'><link name='base'><inertial><mass value='5'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial></link>
         <gazebo reference='base'><turnGravityOff>true</turnGravityOff></gazebo>
         <gazebo reference='laser'><turnGravityOff>true</turnGravityOff></gazebo>
         <link name='laser'>{housing}</link>
         <joint name='to_laser' type='fixed'><parent link='base'/><child link='laser'/><origin xyz='0 0 1'/></joint>
         {more}
         <gazebo reference='laser'><sensor type='ray' name='laser'><update_rate>10</update_rate>
         <ray><scan><horizontal><samples>4</samples><min_angle>0</min_angle><max_angle>4.71238898</max_angle></horizontal></scan>
         <range><min>0.12</min><max>20</max></range></ray>
         <plugin name='laser' filename='libgazebo_ros_laser.so'><topicName>/scan</topicName></plugin>
         </sensor></gazebo></robot>"
    )
}

fn shape(geometry: &str) -> String {
    format!("<collision><geometry>{geometry}</geometry></collision>")
}

/// The four ranges of a robot in front of the wall, and the folder with its files.
fn ranges(text: &str, arguments: &[&str]) -> [f32; 4] {
    let folder = TempDir::new().unwrap();
    let file = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path.to_str().unwrap().to_owned()
    };
    file("closed.obj", &cube(0));
    file("half.obj", &cube(3));
    let (robot, world) = (
        file("robot.urdf", &text.replace("FOLDER", folder.path().to_str().unwrap())),
        file("w.world", WORLD),
    );
    let mut all = vec!["--robot", &robot, "--world", &world, "--drive", "still"];
    all.extend_from_slice(arguments);
    let simulator = Simulator::start(&all);
    let frame = next_frame(&mut simulator.subscribe("/scan"));
    let planes: &[f32] = bytemuck::cast_slice(frame.payload());
    planes[..4].try_into().unwrap()
}

#[track_caller]
fn assert_sees(found: [f32; 4], expected: [f32; 4]) {
    let near = |(is, wanted): (&f32, &f32)| is == wanted || (is - wanted).abs() < 1e-3;
    assert!(found.iter().zip(&expected).all(near), "{found:?} instead of {expected:?}");
}

const FREE: [f32; 4] = [2.9, f32::INFINITY, f32::INFINITY, f32::INFINITY];

#[test]
fn a_housing_does_not_blind_its_lidar() {
    for housing in [
        shape("<box size='.1 .1 .1'/>"),
        shape("<cylinder radius='.055' length='.04'/>"),
        shape("<sphere radius='.4'/>"),
        shape("<mesh filename='file://FOLDER/closed.obj'/>"),
    ] {
        assert_sees(ranges(&robot(&housing, ""), &[]), FREE);
    }
    // The housing of another link that is fixed to it, and two housings at once.
    let base = format!(
        "<link name='hull'>{}</link><joint name='to_hull' type='fixed'><parent link='base'/><child link='hull'/><origin xyz='0.1 0 0.8'/></joint>",
        shape("<box size='.6 .5 .5'/>")
    );
    assert_sees(ranges(&robot(&shape("<box size='.1 .1 .1'/>"), &base), &[]), FREE);
}

#[test]
fn objects_beside_the_lidar_are_seen() {
    let near = f32::NEG_INFINITY;
    // A mast behind the lidar, a tenth of a metre and half a metre away.
    for (x, behind) in [(-0.1, near), (-0.5, 0.48)] {
        let mast = format!(
            "<link name='mast'>{}</link><joint name='to_mast' type='fixed'><parent link='base'/><child link='mast'/><origin xyz='{x} 0 1'/></joint>",
            shape("<cylinder radius='.02' length='1'/>")
        );
        let found = ranges(&robot(&shape("<box size='.1 .1 .1'/>"), &mast), &[]);
        assert_sees(found, [FREE[0], FREE[1], behind, FREE[3]]);
    }
    // Half a box leaves the sensor's own side open: it is not a housing, and blocks the view.
    let half = ranges(&robot(&shape("<mesh filename='file://FOLDER/half.obj'/>"), ""), &[]);
    assert!(half.contains(&near), "{half:?}");
    // A shape that a joint moves is not a housing.
    let drum = format!(
        "<link name='drum'><inertial><mass value='1'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial>{}</link>
         <gazebo reference='drum'><turnGravityOff>true</turnGravityOff></gazebo>
         <joint name='turn' type='continuous'><parent link='base'/><child link='drum'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/></joint>",
        shape("<cylinder radius='.3' length='.5'/>")
    );
    let found = ranges(&robot("", &drum), &[]);
    assert_sees(found, [0.3; 4]);
    // In Gazebo mode, surfaces nearer than the least range are seen through, and a housing is like any other shape.
    let hull = shape("<sphere radius='.4'/>");
    assert_sees(ranges(&robot(&hull, ""), &["--gazebo-compat"]), [0.4; 4]);
}

#[test]
fn each_of_two_lidars_sees_the_others_housing() {
    let housing = shape("<box size='.1 .1 .1'/>");
    let second = format!(
        "<link name='second'>{housing}</link>
         <joint name='to_second' type='fixed'><parent link='base'/><child link='second'/><origin xyz='1 0 1'/></joint>
         <gazebo reference='second'><sensor type='ray' name='second'><update_rate>10</update_rate>
         <ray><scan><horizontal><samples>4</samples><min_angle>0</min_angle><max_angle>4.71238898</max_angle></horizontal></scan>
         <range><min>0.12</min><max>20</max></range></ray>
         <plugin name='second' filename='libgazebo_ros_laser.so'><topicName>/second</topicName></plugin>
         </sensor></gazebo>"
    );
    let text = robot(&housing, &second);
    assert_sees(ranges(&text, &[]), [0.95, FREE[1], FREE[2], FREE[3]]);
    let text = text.replace(">/scan<", ">/first<").replace(">/second<", ">/scan<");
    assert_sees(ranges(&text, &[]), [1.9, FREE[1], 0.95, FREE[3]]);
}

#[test]
fn check_reports_sensors_inside_shapes() {
    let folder = TempDir::new().unwrap();
    let check = |text: &str| {
        let path = folder.path().join("robot.urdf");
        std::fs::write(&path, text).unwrap();
        let done = belvedere().arg("check").arg(&path).args(["--world", "empty"]).output().unwrap();
        String::from_utf8(done.stdout).unwrap()
    };
    let own = check(&robot(&shape("<box size='.1 .1 .1'/>"), ""));
    assert!(own.contains("'laser' is inside a collision shape of the link 'laser'"), "{own}");
    assert!(own.contains("looks through it"), "{own}");
    let turning = "<link name='drum'><collision><geometry><sphere radius='.3'/></geometry></collision></link>
         <joint name='turn' type='continuous'><parent link='base'/><child link='drum'/><origin xyz='0 0 1'/></joint>";
    let drum = check(&robot("", turning));
    assert!(
        drum.contains("warning") && drum.contains("link 'drum'") && drum.contains("sees nothing else"),
        "{drum}"
    );
    assert!(!check(&robot("", "")).contains("inside"));
}

//! Poses of links: they do not depend on the order and the names in a file.

use crate::sdf;

use crate::live::{belvedere, own_domain};
use crate::sdf::{BOX, Folder, close, good};
use belvedere::description::Diagnostics;
use belvedere::description::load::{LoadOptions, load_robot};
use belvedere::description::model::{Model, World};
use belvedere::description::models::package_path;
use belvedere::robot::placement;
use belvedere::world::physics::Physics;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::collections::BTreeMap;

/// A robot with a base, a mast, an arm and two wheels; the test chooses the order of its elements.
const PARTS: [&str; 15] = [
    "<link name='base_footprint'/>",
    "<link name='base_link'><inertial><mass value='5'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial>
       <collision><geometry><box size='.4 .3 .1'/></geometry></collision></link>",
    "<link name='mast'><inertial><origin xyz='0.01 0 0.3'/><mass value='0.7'/><inertia ixx='.01' iyy='.01' izz='.001' ixy='0' ixz='0' iyz='0'/></inertial>
       <collision><origin xyz='0 0 0.3'/><geometry><cylinder radius='.02' length='.6'/></geometry></collision></link>",
    "<link name='laser'><inertial><mass value='0.13'/><inertia ixx='.001' iyy='.001' izz='.001' ixy='0' ixz='0' iyz='0'/></inertial></link>",
    "<link name='arm'><inertial><origin xyz='0.2 0 0'/><mass value='0.3'/><inertia ixx='.001' iyy='.004' izz='.004' ixy='0' ixz='0' iyz='0'/></inertial>
       <collision><origin xyz='0.2 0 0'/><geometry><box size='.4 .03 .03'/></geometry></collision></link>",
    "<link name='left'><inertial><mass value='0.4'/><inertia ixx='.002' iyy='.002' izz='.003' ixy='0' ixz='0' iyz='0'/></inertial>
       <collision><geometry><cylinder radius='.1' length='.04'/></geometry></collision></link>",
    "<link name='right'><inertial><mass value='0.4'/><inertia ixx='.002' iyy='.002' izz='.003' ixy='0' ixz='0' iyz='0'/></inertial>
       <collision><geometry><cylinder radius='.1' length='.04'/></geometry></collision></link>",
    "<link name='skid'><collision><geometry><sphere radius='.05'/></geometry></collision></link>",
    "<joint name='footprint' type='fixed'><parent link='base_footprint'/><child link='base_link'/><origin xyz='0 0 0.1'/></joint>",
    "<joint name='to_mast' type='fixed'><parent link='base_link'/><child link='mast'/><origin xyz='-0.1 0 0.05'/></joint>",
    "<joint name='to_laser' type='fixed'><parent link='mast'/><child link='laser'/><origin xyz='0.05 0 0.6' rpy='0 0 0.3'/></joint>",
    "<joint name='shoulder' type='revolute'><parent link='mast'/><child link='arm'/><origin xyz='0.03 0 0.4'/><axis xyz='0 1 0'/><limit lower='-1' upper='0.7' effort='1' velocity='1'/></joint>",
    "<joint name='roll_left' type='continuous'><parent link='base_link'/><child link='left'/><origin xyz='0 0.2 0' rpy='-1.5707963 0 0'/><axis xyz='0 0 1'/></joint>",
    "<joint name='roll_right' type='continuous'><parent link='base_link'/><child link='right'/><origin xyz='0 -0.2 0' rpy='-1.5707963 0 0'/><axis xyz='0 0 1'/></joint>",
    "<joint name='to_skid' type='fixed'><parent link='base_link'/><child link='skid'/><origin xyz='-0.15 0 -0.05'/></joint>",
];

const LASER: &str = "<gazebo reference='laser'><sensor type='ray' name='laser'><update_rate>10</update_rate>
    <ray><scan><horizontal><samples>360</samples><min_angle>-3.1</min_angle><max_angle>3.1</max_angle></horizontal></scan>
    <range><min>0.01</min><max>20</max></range></ray>
    <plugin name='laser' filename='libgazebo_ros_laser.so'><topicName>/scan</topicName><frameName>laser</frameName></plugin>
    </sensor></gazebo>";

const WORLD: &str = "<sdf version='1.6'><world name='w'>
    <model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
    <model name='wall'><pose>3 0.2 1 0 0.1 0.2</pose><static>true</static><link name='l'><collision name='c'><geometry><box><size>0.3 4 2</size></box></geometry></collision></link></model>
    <model name='ball'><pose>-2 1 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><sphere><radius>0.5</radius></sphere></geometry></collision></link></model>
    </world></sdf>";

/// Orders of this many elements: the original one, the reverse, and random ones.
fn orders(count: usize, random: usize) -> Vec<Vec<usize>> {
    let mut state = 12_345_u64;
    let mut draw = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut orders = vec![(0..count).collect(), (0..count).rev().collect()];
    for _ in 0..random {
        let mut order: Vec<usize> = (0..count).collect();
        (1..count).rev().for_each(|last| order.swap(last, draw(last + 1)));
        orders.push(order);
    }
    orders
}

fn robot_in(order: &[usize]) -> String {
    let parts: String = order.iter().map(|part| PARTS[*part]).collect();
    format!("<robot name='r'>{parts}{LASER}</robot>")
}

fn robot(text: &str) -> Model {
    let folder = Folder::new();
    let path = folder.write("robot.urdf", text);
    let packages = package_path([], None);
    let options =
        LoadOptions { packages, rules: belvedere::description::Rules::default(), xacro_args: Vec::new() };
    let mut diagnostics = Diagnostics::default();
    let robot = load_robot(path.to_str().unwrap(), &options, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{:#?}", diagnostics.problems());
    robot.unwrap()
}

fn world() -> World {
    sdf::load(Folder::new().write("w.world", WORLD).to_str().unwrap(), false).0.unwrap()
}

/// The current positions of a model's links, by name.
fn places(physics: &Physics, index: usize, model: &Model) -> BTreeMap<String, Pose> {
    let pose = |(number, _)| physics.world_from_link(index, number);
    model.links.iter().enumerate().map(|(number, link)| (link.name.clone(), pose((number, link)))).collect()
}

/// The positions of the links of a world's only model after this many steps.
fn after(world: &World, steps: usize) -> BTreeMap<String, DVec3> {
    let mut physics = Physics::new(world).unwrap();
    (0..steps).for_each(|_| physics.step());
    let at = places(&physics, 0, &world.models[0]);
    at.into_iter().map(|(name, pose)| (name, pose.translation())).collect()
}

#[test]
fn poses_of_links_follow_from_joints_whatever_the_order_of_the_file() {
    let world = world();
    let start = Pose::from_xyz_rpy(DVec3::new(0.5, 0.25, 0.0), DVec3::new(0.0, 0.0, 0.5));
    let mut first = None;
    for order in orders(PARTS.len(), 10) {
        let robot = robot(&robot_in(&order));
        let mut physics = Physics::new(&world).unwrap();
        let index = physics.insert_model(&placement(&robot, start)).unwrap();
        let at_first = places(&physics, index, &robot);
        let offsets = [
            ("base_footprint", DVec3::ZERO),
            ("base_link", DVec3::new(0.0, 0.0, 0.1)),
            ("mast", DVec3::new(-0.1, 0.0, 0.15)),
            ("laser", DVec3::new(-0.05, 0.0, 0.75)),
            ("arm", DVec3::new(-0.07, 0.0, 0.55)),
            ("left", DVec3::new(0.0, 0.2, 0.1)),
            ("right", DVec3::new(0.0, -0.2, 0.1)),
            ("skid", DVec3::new(-0.15, 0.0, 0.05)),
        ];
        for (link, offset) in offsets {
            let (is, expected) = (at_first[link].translation(), start.transform_point(offset));
            assert!((is - expected).length() < 1e-6, "{link} is at {is}, not {expected}: {order:?}");
        }
        (0..1000).for_each(|_| physics.step());
        let at_last = places(&physics, index, &robot);
        // The arm has sunk to its limit, and the robot stands on its wheels.
        assert!((at_last["base_link"].translation().z - 0.1).abs() < 0.005, "{at_last:?}");
        let all = (at_first, at_last, physics.world_from_model(index));
        assert_eq!(first.get_or_insert_with(|| all.clone()), &all, "{order:?}");
    }
}

#[test]
fn the_bytes_of_a_scan_do_not_depend_on_the_order_of_the_file() {
    let folder = Folder::new();
    let world = folder.write("w.world", WORLD);
    let mut first = None;
    for order in orders(PARTS.len(), 2) {
        let robot = folder.write("robot.urdf", robot_in(&order));
        let arguments = ["--drive", "still", "--rate", "max", "--duration", "0.5", "--hash"];
        let run = belvedere()
            .args(["run", "--domain", &own_domain(), "--robot"])
            .arg(&robot)
            .arg("--world")
            .arg(&world)
            .args(arguments)
            .output()
            .unwrap();
        let printed = String::from_utf8(run.stdout).unwrap();
        let scan = printed.lines().find(|line| line.contains("/scan")).map(str::to_owned);
        let scan = scan.unwrap_or_else(|| panic!("{printed}{}", String::from_utf8_lossy(&run.stderr)));
        assert_eq!(first.get_or_insert_with(|| scan.clone()), &scan, "{order:?}");
    }
}

#[test]
fn the_pose_of_a_joint_does_not_move_links() {
    // A bar of 1 m that hangs on a hinge at its end, whatever the joint's own pose, held by a static model or link.
    let bar = |static_of: &str, hinge: &str, links_last: bool| {
        let links = "<link name='bar'><pose>0.5 0 2 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.001</ixx><iyy>0.0833</iyy><izz>0.0833</izz></inertia></inertial></link>
             <link name='base'><pose>0 0 2 0 0 0</pose></link>";
        let joints = format!(
            "<joint name='bar' type='revolute'>{hinge}<parent>{static_of}</parent><child>bar</child><axis><xyz>0 1 0</xyz></axis></joint>
             <joint name='hold' type='fixed'><parent>world</parent><child>base</child></joint>"
        );
        let parts = if links_last { joints + links } else { links.to_owned() + &joints };
        good("1.6", &format!("<model name='m'>{parts}</model>"))
    };
    for static_of in ["base", "world"] {
        for links_last in [false, true] {
            let world = bar(static_of, "<pose>-0.5 0 0 0 0 0</pose>", links_last);
            let at = after(&world, 0);
            close(at["bar"], DVec3::new(0.5, 0.0, 2.0));
            close(at["base"], DVec3::new(0.0, 0.0, 2.0));
            // From the horizontal it falls to the bottom in K(½) √(2 l / 3 g) = 1.854 · 0.2608 s = 0.4836 s.
            let at = after(&world, 483);
            let down = at["bar"] - DVec3::new(0.0, 0.0, 2.0);
            assert!((down.length() - 0.5).abs() < 0.005, "{static_of}: {at:?}");
            assert!(down.x.abs() < 0.03 && down.z < 0.0, "{static_of}: {at:?}");
            close(at["base"], DVec3::new(0.0, 0.0, 2.0));
        }
    }
}

#[test]
fn models_with_the_same_name_keep_their_poses() {
    let folder = Folder::new();
    folder.write("crate/model.config", "<model><name>crate</name><sdf version='1.6'>model.sdf</sdf></model>");
    let of_crate = format!(
        "<sdf version='1.6'><model name='crate'><static>true</static><link name='l'><collision name='c'>{BOX}</collision></link></model></sdf>"
    );
    folder.write("crate/model.sdf", of_crate);
    let include = |pose: &str| {
        format!("<include><uri>file://{}</uri><pose>{pose}</pose></include>", folder.path("crate").display())
    };
    let twice = include("1 0 0 0 0 0") + &include("5 0 0 0 0 0.5") + &include("9 0 0 0 0 0");
    let (world, problems) = folder.load("1.6", &twice, false);
    let world = world.unwrap();
    let at = |number: usize| world.models[number].world_from_model.translation().x;
    assert_eq!((at(0), at(1), at(2)), (1.0, 5.0, 9.0), "{problems:#?}");
    let names: Vec<&str> = world.models.iter().map(|model| model.name.as_str()).collect();
    assert_eq!(names, ["crate", "crate_0", "crate_1"]);
    assert_eq!(problems.len(), 2, "{problems:#?}");
    // The same inside a model; its static parts stay still while the rest falls.
    let nested = format!(
        "<model name='m'><pose>0 0 3 0 0 0</pose>{twice}<link name='loose'><pose>0 5 0 0 0 0</pose><collision name='c'>{BOX}</collision></link></model>"
    );
    let (world, problems) = folder.load("1.6", &nested, false);
    assert_eq!(problems.len(), 2, "{problems:#?}");
    let world = world.unwrap();
    for steps in [0, 100] {
        let at = after(&world, steps);
        close(at["crate::l"], DVec3::new(1.0, 0.0, 3.0));
        close(at["crate_0::l"], DVec3::new(5.0, 0.0, 3.0));
        close(at["crate_1::l"], DVec3::new(9.0, 0.0, 3.0));
        let fallen = 3.0 - at["loose"].z;
        let expected = 0.5 * 9.8 * (0.001 * steps as f64).powi(2);
        assert!((fallen - expected).abs() < 0.001, "{fallen} instead of {expected}");
    }
    // A floor that consists only of an include of a static model.
    let (world, problems) =
        folder.load("1.6", &format!("<model name='floor'>{}</model>", include("0 0 1 0 0 0")), false);
    assert!(problems.is_empty() && world.unwrap().models[0].is_static, "{problems:#?}");
}

#[test]
fn lights_and_saved_states_are_relative_to_the_frame_that_they_name() {
    let world = good(
        "1.8",
        "<model name='a'><pose>1 2 3 0 0 1.5707963267948966</pose><link name='l'/></model>
         <model name='b'><link name='l'/></model>
         <light name='lamp' type='point'><pose relative_to='a'>1 0 0 0 0 0</pose></light>
         <light name='moved' type='point'/>
         <state world_name='w'><model name='b'><pose relative_to='a'>2 0 0 0 0 0</pose></model>
         <light name='moved'><pose relative_to='a::l'>0 1 0 0 0 0</pose></light></state>",
    );
    close(world.lights[0].world_from_light.translation(), DVec3::new(1.0, 3.0, 3.0));
    close(world.lights[1].world_from_light.translation(), DVec3::new(0.0, 2.0, 3.0));
    close(world.models[1].world_from_model.translation(), DVec3::new(1.0, 4.0, 3.0));
}

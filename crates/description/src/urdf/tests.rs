//! Small robots: what is read, and one error for each mistake.

use super::load_urdf;
use crate::Rules;
use crate::diagnostics::Diagnostics;
use crate::model::{Geometry, JointKind, Model};
use crate::models::package_path;
use crate::xml::Element;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

fn load_as(inside: &str, gazebo_compat: bool) -> (Option<Model>, Vec<String>) {
    let text = format!("<robot name='r'>{inside}</robot>");
    let robot = Element::parse(&text, Path::new("r.urdf")).unwrap();
    let mut diagnostics = Diagnostics::default();
    let rules = Rules { gazebo_compat, ..Rules::default() };
    let model = load_urdf(&robot, &package_path([], None), rules, &mut diagnostics);
    (model, diagnostics.problems().iter().map(ToString::to_string).collect())
}

fn accepted(inside: &str) -> Model {
    let (model, problems) = load_as(inside, false);
    assert!(problems.is_empty(), "{problems:?}");
    model.unwrap()
}

fn joint(name: &str, parent: &str, child: &str) -> String {
    format!("<joint name='{name}' type='fixed'><parent link='{parent}'/><child link='{child}'/></joint>")
}

#[test]
fn poses_follow_from_joints_in_any_order() {
    let model = accepted(
        "<link name='tip'/><link name='arm'/><link name='base'/>\
         <joint name='b' type='prismatic'><parent link='arm'/><child link='tip'/><origin xyz='1 0 0'/>\
         <axis xyz='0 0 2'/><limit lower='-1' upper='0.5'/></joint>\
         <joint name='a' type='continuous'><parent link='base'/><child link='arm'/>\
         <origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/></joint>",
    );
    let tip = model.links[0].model_from_link;
    assert!((tip.translation() - DVec3::new(0.0, 1.0, 1.0)).length() < 1e-12, "{tip:?}");
    assert!((tip.transform_vector(DVec3::X) - DVec3::Y).length() < 1e-12, "turned by {FRAC_PI_2}");
    assert_eq!(model.joints[0].kind, JointKind::Prismatic { lower: -1.0, upper: 0.5 });
    assert_eq!((model.joints[0].axis, model.joints[1].axis), (DVec3::Z, DVec3::X));
    assert_eq!((model.joints[0].parent, model.joints[0].child), (1, 0));
    assert!(!model.is_static);
}

#[test]
fn a_shape_without_extent_is_left_out_as_gazebo_does() {
    let flat = |length: &str| {
        format!(
            "<link name='base'><visual><geometry><cylinder radius='0.2' length='{length}'/></geometry></visual></link>"
        )
    };
    let (model, problems) = load_as(&flat("0"), false);
    assert_eq!(
        problems,
        [
            "r.urdf:1: warning: attribute 'length' of <cylinder> is '0', so the shape is left out; lengths must be above 0"
        ]
    );
    assert!(model.unwrap().links[0].visuals.is_empty());
    let (_, problems) = load_as(&flat("-1"), false);
    assert!(problems[0].contains("error"), "{problems:?}");
}

#[test]
fn links_have_mass_shapes_and_looks() {
    let model = accepted(
        "<material name='Orange'><color rgba='1 0.5 0 1'/></material>\
         <link name='base'><inertial><mass value='2'/><origin xyz='0 0 1'/><inertia ixx='2' iyy='2' izz='3' iyz='0.5'/></inertial>\
         <visual><geometry><box size='1 2 3'/></geometry><material name='Orange'/></visual>\
         <visual><geometry><sphere radius='1'/></geometry><material name='Own'><color rgba='0 0 1 0.5'/></material></visual>\
         <visual><geometry><capsule radius='1' length='2'/></geometry><material name='Own'/></visual>\
         <collision name='c'><origin xyz='0 1 0'/><geometry><cylinder radius='0.5' length='2'/></geometry></collision></link>\
         <gazebo reference='base'><mu1>0.3</mu1><mu2>0.3</mu2><laserRetro>7</laserRetro>\
         <turnGravityOff>true</turnGravityOff></gazebo>",
    );
    let base = &model.links[0];
    let inertial = base.inertial.unwrap();
    assert_eq!((inertial.mass_kg, inertial.inertia), (2.0, [2.0, 2.0, 3.0, 0.0, 0.0, 0.5]));
    assert_eq!(inertial.link_from_inertial.translation(), DVec3::Z);
    let alphas: Vec<_> = base.visuals.iter().map(|visual| visual.material.alpha).collect();
    assert_eq!(alphas[..3], [1.0, 0.5, 0.5]);
    let colors: Vec<_> = base.visuals.iter().map(|visual| visual.material.diffuse).collect();
    assert_eq!(colors, [[1.0, 0.5, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]);
    let collision = &base.collisions[0];
    assert!(matches!(collision.geometry, Geometry::Cylinder { radius: 0.5, length: 2.0 }));
    assert_eq!((collision.friction, collision.laser_retro), (Some(0.3), 7.0));
    assert_eq!((collision.link_from_collision.translation(), base.gravity), (DVec3::Y, false));
}

#[test]
fn gazebo_materials_override_those_of_urdf() {
    let robot = |name: &str| {
        format!(
            "<link name='b'><visual><geometry><box size='1 1 1'/></geometry><material name='m'>\
             <color rgba='1 0 0 1'/></material></visual></link>\
             <gazebo reference='b'><material>{name}</material></gazebo>"
        )
    };
    assert_eq!(accepted(&robot("Gazebo/Blue")).links[0].visuals[0].material.diffuse, [0.0, 0.0, 1.0]);
    let (model, problems) = load_as(&robot("Gazebo/Bleu"), false);
    assert_eq!(model.unwrap().links[0].visuals[0].material.diffuse, [1.0, 0.0, 0.0]);
    assert!(problems.len() == 1 && problems[0].contains("did you mean 'Gazebo/Blue'"), "{problems:?}");
}

#[test]
fn sensors_sit_on_their_links() {
    let model = accepted(
        "<link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\
         <gazebo reference='j'><implicitSpringDamper>0</implicitSpringDamper></gazebo>\
         <gazebo reference='b'><sensor name='eye' type='camera'><pose>1 2 3 0 0 0</pose></sensor></gazebo>",
    );
    assert_eq!((model.sensors[0].name.as_str(), model.sensors[0].link), ("eye", 1));
    assert_eq!(model.sensors[0].link_from_sensor.translation(), DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn a_sensor_on_an_unknown_link_is_one_error_or_is_left_out() {
    let robot = "<link name='camera_link'/>\n<gazebo reference='camera_lnk'><sensor name='eye' type='camera'/></gazebo>";
    let (_, problems) = load_as(robot, false);
    assert_eq!(problems.len(), 1, "{problems:?}");
    for part in ["r.urdf:2: error: ", "'eye'", "'camera_lnk'", "'camera_link'", "--gazebo-compat"] {
        assert!(problems[0].contains(part), "{problems:?}");
    }
    let (model, problems) = load_as(robot, true);
    assert!(model.unwrap().sensors.is_empty());
    assert!(problems.len() == 1 && problems[0].contains(": warning: the sensor 'eye'"), "{problems:?}");
}

#[test]
fn every_mistake_is_one_error_that_names_it() {
    let shape = |shape: &str| format!("<link name='a'><visual><geometry>{shape}</geometry></visual></link>");
    let two = "<link name='a'/><link name='b'/>";
    let cases = [
        (String::new(), "the robot has no links"),
        ("<link/>".into(), "<link> has no name"),
        ("<link name='a'/><link name='a'/>".into(), "two links are called 'a' (the first at r.urdf:1)"),
        (
            format!("{two}<link name='c'/>{}{}", joint("j", "a", "b"), joint("j", "a", "c")),
            "two joints are called 'j'",
        ),
        (two.into(), "2 roots: no joint has 'a' (r.urdf:1) or 'b'"),
        (
            format!("{two}{}", joint("j", "a", "bb")),
            "the child link 'bb', which does not exist; did you mean 'b'?",
        ),
        (format!("{two}{}{}", joint("j", "a", "b"), joint("k", "b", "a")), "joints make a loop: "),
        (
            format!("<link name='c'/>{two}{}{}", joint("j", "a", "b"), joint("k", "b", "a")),
            "joints make a loop: ",
        ),
        (
            format!("{two}<link name='c'/>{}{}", joint("j", "a", "b"), joint("k", "c", "b")),
            "'b' is the child of two joints: 'j' (r.urdf:1) and 'k'",
        ),
        (
            format!("{two}<joint name='j' type='planar'><parent link='a'/><child link='b'/></joint>"),
            "'planar'",
        ),
        (format!("{two}<joint name='j' type='fixed'><parent link='a'/></joint>"), "has no <child>"),
        (
            format!("{two}<joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint>"),
            "has no <limit>",
        ),
        (
            format!(
                "{two}<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 0'/></joint>"
            ),
            "the axis of the joint 'j' is '0 0 0'",
        ),
        (shape("<box size='1 -1 1'/>"), "'size' of <box> is '1 -1 1'"),
        (shape("<sphere radius='-1'/>"), "'radius' of <sphere> is '-1'"),
        (shape("<cylinder radius='1'/>"), "<cylinder> has no attribute 'length'"),
        (shape("<cone/>"), "<cone> is not a shape"),
        (shape(""), "<visual> has no shape"),
        (shape("<mesh filename='package://nowhere/x.stl'/>"), "there is no mesh 'package://nowhere/x.stl'"),
        (shape("<mesh filename='http://x/x.stl'/>"), "'http://' is unsupported"),
        (
            "<link name='a'><inertial><mass value='-1'/></inertial></link>".into(),
            "the mass of link 'a' is -1 kg",
        ),
        (
            "<material name='m'><color rgba='2 0 0 1'/></material><link name='a'/>".into(),
            "'rgba' of <color> is '2 0 0 1'",
        ),
    ];
    for (robot, expected) in cases {
        let (_, problems) = load_as(&robot, false);
        assert_eq!(problems.len(), 1, "{robot}: {problems:?}");
        assert!(
            problems[0].starts_with("r.urdf:1: error: ") && problems[0].contains(expected),
            "{problems:?}"
        );
        assert!(problems[0].contains("; "), "no remedy: {problems:?}");
    }
}

#[test]
fn extensions_are_set_by_text_or_attribute() {
    let link = |inside: &str| {
        let (model, problems) = load_as(
            &format!(
                "<link name='a'><visual><geometry><box size='1 1 1'/></geometry></visual><collision><geometry>\
                 <box size='1 1 1'/></geometry></collision></link><gazebo reference='a'>{inside}</gazebo>"
            ),
            false,
        );
        (model.unwrap().links.remove(0), problems)
    };
    let (a, problems) = link(
        "<mu1 value='0.25'/><laserRetro value=' 7 '/><optics><transmittance>0.9</transmittance></optics><turnGravityOff value='True'/><material value='Gazebo/Red'/>",
    );
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!((a.collisions[0].friction, a.collisions[0].laser_retro, a.gravity), (Some(0.25), 7.0, false));
    assert_eq!(a.visuals[0].material.diffuse, [1.0, 0.0, 0.0]);
    assert_eq!((a.visuals[0].optics.transmittance, a.collisions[0].optics.transmittance), (0.9, 0.9));
    assert!(link("<turnGravityOff>no</turnGravityOff>").0.gravity);
    // Elements of SDF, which libsdformat copies into the link; URDF's own names take precedence.
    for (inside, gravity, self_collide) in [
        ("<gravity>false</gravity><self_collide>1</self_collide>", false, true),
        ("<gravity>1</gravity><turnGravityOff>true</turnGravityOff>", false, false),
        ("<self_collide>true</self_collide><selfCollide>false</selfCollide>", true, false),
    ] {
        let (a, problems) = link(inside);
        assert_eq!(
            (a.gravity, a.self_collide, problems.len()),
            (gravity, self_collide, 0),
            "{inside}: {problems:?}"
        );
    }
    let (_, problems) = link("<enable_wind>true</enable_wind>");
    assert!(
        problems.len() == 1 && problems[0].contains("is not simulated: there is no wind"),
        "{problems:?}"
    );
    let (a, problems) = link("<mu1>-1</mu1>");
    assert!(a.collisions[0].friction.unwrap() >= 1e6);
    assert!(problems.len() == 1 && problems[0].contains("warning: <mu1> of link 'a' is -1"), "{problems:?}");
}

#[test]
fn a_root_called_world_holds_a_robot_without_moving_joints() {
    assert!(accepted(&format!("<link name='world'/><link name='b'/>{}", joint("j", "world", "b"))).is_static);
}

#[test]
fn labels_are_the_links_own_or_the_robots() {
    let plugin = |file: &str, name: &str, label: &str| {
        format!("<plugin filename='{file}' name='{name}'><label>{label}</label></plugin>")
    };
    let robot = |extensions: &str| {
        load_as(
            &format!(
                "<link name='base'><visual><geometry><box size='1 1 1'/></geometry></visual></link>\
                 <link name='head'><visual><geometry><sphere radius='1'/></geometry></visual>\
                 <visual><geometry><sphere radius='2'/></geometry></visual></link>{}\n{extensions}",
                joint("neck", "base", "head")
            ),
            false,
        )
    };
    let labels = |extensions: &str| {
        let (model, problems) = robot(extensions);
        assert!(problems.is_empty(), "{extensions}: {problems:?}");
        model
            .unwrap()
            .links
            .into_iter()
            .flat_map(|link| link.visuals)
            .map(|visual| visual.label)
            .collect::<Vec<_>>()
    };
    let gz = plugin("gz-sim-label-system", "gz::sim::systems::Label", "7");
    let ignition = plugin("ignition-gazebo-label-system", "ignition::gazebo::systems::Label", "9");
    assert_eq!(labels(""), [None; 3]);
    assert_eq!(labels(&format!("<gazebo reference='head'>{gz}</gazebo>")), [None, Some(7), Some(7)]);
    assert_eq!(
        labels(&format!("<gazebo reference='head'><visual>{gz}</visual></gazebo>")),
        [None, Some(7), Some(7)]
    );
    // In either order.
    for (first, second) in [("", " reference='base'"), (" reference='base'", "")] {
        let [first_label, second_label] = if first.is_empty() { [&gz, &ignition] } else { [&ignition, &gz] };
        let both = format!("<gazebo{first}>{first_label}</gazebo><gazebo{second}>{second_label}</gazebo>");
        assert_eq!(labels(&both), [Some(9), Some(7), Some(7)]);
    }
    for (label, expected) in
        [("-1", "<label> is -1; write a whole number"), ("x", "'x' is not a finite number")]
    {
        let (_, problems) = robot(&format!(
            "<gazebo reference='head'>{}</gazebo>",
            plugin("gz-sim-label-system", "l", label)
        ));
        assert!(problems.len() == 1 && problems[0].starts_with("r.urdf:2: error: "), "{problems:?}");
        assert!(problems[0].contains(expected), "{problems:?}");
    }
    let (_, problems) =
        robot("<gazebo reference='head'><plugin filename='gz-sim-label-system' name='l'/></gazebo>");
    assert!(problems.len() == 1 && problems[0].contains("the plugin Label has no <label>"), "{problems:?}");
}

#[test]
fn tags_belong_to_a_link_of_one_visual() {
    let tag = "<visual><fiducial><family>tag36h11</family><id>4</id><size>0.1</size></fiducial></visual>";
    let robot = |link: &str| {
        let shapes = "<link name='base'><visual><geometry><box size='1 1 1'/></geometry></visual></link>\
                      <link name='head'><visual><geometry><sphere radius='1'/></geometry></visual>\
                      <visual><origin xyz='1 0 0'/><geometry><sphere radius='2'/></geometry></visual></link>";
        let neck = joint("neck", "base", "head");
        load_as(&format!("{shapes}{neck}\n<gazebo reference='{link}'>{tag}</gazebo>"), false)
    };
    let (model, problems) = robot("base");
    assert!(problems.is_empty(), "{problems:?}");
    assert_eq!(model.unwrap().links[0].visuals[0].fiducials[0].id, 4);
    let (_, problems) = robot("head");
    assert!(problems.len() == 1 && problems[0].starts_with("r.urdf:2: error: "), "{problems:?}");
    assert!(problems[0].contains("the link 'head', which needs exactly one visual"), "{problems:?}");
}

#[test]
fn plugins_that_gazebo_does_not_load_from_a_link_or_joint_are_told() {
    let robot = |reference: &str, plugin: &str| {
        load_as(
            &format!(
                "<link name='a'/><link name='b'/>{}<gazebo reference='{reference}'>{plugin}</gazebo>",
                joint("j", "a", "b")
            ),
            false,
        )
    };
    let pump = "\n<plugin name='pump' filename='libpump.so'/>";
    for (reference, what) in [("j", "joint"), ("a", "link")] {
        let (model, problems) = robot(reference, pump);
        let told = format!(
            "r.urdf:2: warning: the plugin 'pump' (libpump.so) belongs to the {what} '{reference}', and Gazebo loads no plugins of \
             {what}s: it is left out; write it into a <gazebo> without a reference"
        );
        assert!(model.is_some());
        assert_eq!(problems, [told]);
    }
    let label =
        "<plugin filename='gz-sim-label-system' name='gz::sim::systems::Label'><label>3</label></plugin>";
    assert_eq!(robot("a", label).1, [""; 0]);
}

#[test]
fn extensions_directly_in_a_link_or_joint_are_told_with_their_place() {
    let one = |inside: &str| {
        let joint = "<joint name='j' type='fixed'><parent link='a'/><child link='b'/><springStiffness>1</springStiffness></joint>";
        let (model, problems) =
            load_as(&format!("<link name='a'>\n{inside}</link><link name='b'/>{joint}"), false);
        assert!(model.is_some() && problems.len() == 2, "{problems:#?}");
        assert!(
            problems[0].contains("<springStiffness> of <joint> is left out")
                && problems[0].contains("reads it from <gazebo reference=\"JOINT\">"),
            "{problems:#?}"
        );
        problems[1].clone()
    };
    for name in ["kinematic", "turnGravityOff", "selfCollide", "mu1", "material", "sensor"] {
        assert_eq!(
            one(&format!("<{name}>1</{name}>")),
            format!(
                "r.urdf:2: warning: <{name}> of <link> is left out, because Gazebo reads it from <gazebo reference=\"LINK\">; \
                 move it there"
            )
        );
    }
    assert!(one("<gravity>0</gravity>").contains("<turnGravityOff>"));
    assert!(one("<plugin name='p' filename='libp.so'/>").contains("<gazebo> without a reference"));
}

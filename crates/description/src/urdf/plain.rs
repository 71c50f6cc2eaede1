//! An expanded robot in the form that ROS's own URDF parser accepts, which is stricter than this one.

use super::files::name_files_absolutely;
use super::load_urdf;
use super::material::is_definition;
use crate::diagnostics::Diagnostics;
use crate::gazebo_materials::gazebo_material;
use crate::package::PackagePath;
use crate::rules::Rules;
use crate::sensor_frames::{new_frames, sensor_frames};
use crate::xml::{Element, Node};
use glam::{DVec3, EulerRot};
use std::collections::HashSet;

/// Rewrites what urdfdom, the parser of `robot_state_publisher` and rviz, refuses or cannot find: a robot without a name,
/// a material that is defined twice (by a file that was included twice) or after its first use, and file names that
/// only this package path and the robot's own files can resolve. For [`load_urdf`](super::load_urdf) the robot stays the
/// same, except for the ambient colours of Gazebo's own materials, which URDF cannot express.
pub(crate) fn make_plain(robot: &mut Element, packages: &PackagePath, diagnostics: &mut Diagnostics) {
    if robot.attribute("name").is_none() {
        robot.attributes.insert(0, ("name".into(), "robot".into()));
    }
    define_materials_once(robot);
    name_files_absolutely(robot, packages, diagnostics);
}

/// Adds a link and a fixed joint for each sensor frame for which the robot has no link.
pub(crate) fn add_sensor_frames(robot: &mut Element, packages: &PackagePath) {
    // Problems of the robot are reported elsewhere.
    let Some(model) = load_urdf(robot, packages, Rules::default(), &mut Diagnostics::default()) else {
        return;
    };
    for frame in new_frames(&sensor_frames(&model, "")) {
        let source = &model.sensors[frame.sensor].source;
        let element = |name: &str, attributes: &[(&str, String)], children: Vec<Element>| Element {
            name: name.into(),
            attributes: attributes.iter().map(|(name, value)| ((*name).into(), value.clone())).collect(),
            children: children.into_iter().map(Node::Element).collect(),
            source: source.clone(),
        };
        let DVec3 { x, y, z } = frame.parent_from_frame.translation();
        let (yaw, pitch, roll) = frame.parent_from_frame.rotation().to_euler(EulerRot::ZYX);
        let place = [("xyz", format!("{x} {y} {z}")), ("rpy", format!("{roll} {pitch} {yaw}"))];
        let joint = vec![
            element("parent", &[("link", model.links[frame.parent].name.clone())], Vec::new()),
            element("child", &[("link", frame.name.clone())], Vec::new()),
            element("origin", &place, Vec::new()),
        ];
        let joint_name = format!("{}_joint", frame.name);
        let is_fixed = [("name", joint_name), ("type", "fixed".into())];
        robot.children.push(Node::Element(element("link", &[("name", frame.name.clone())], Vec::new())));
        robot.children.push(Node::Element(element("joint", &is_fixed, joint)));
    }
}

/// Keeps only the first definition of each name, which applies to the whole robot.
fn define_materials_once(robot: &mut Element) {
    let mut defined = HashSet::new();
    robot.children.retain(|child| match child {
        Node::Element(material) if material.name == "material" => {
            let name = material.attribute("name").unwrap_or_default();
            is_definition(material) && !name.is_empty() && defined.insert(name.to_owned())
        }
        _ => true,
    });
    let visuals = || robot.elements_named("link").flat_map(|link| link.elements_named("visual"));
    let materials = || visuals().filter_map(|visual| visual.child("material"));
    let name_of = |material: &Element| material.attribute("name").unwrap_or_default().to_owned();
    let missing: Vec<Node> = materials()
        .filter(|used| !is_definition(used) && !name_of(used).is_empty() && defined.insert(name_of(used)))
        .map(|used| {
            let elsewhere = materials().find(|other| is_definition(other) && name_of(other) == name_of(used));
            Node::Element(elsewhere.cloned().unwrap_or_else(|| known_or_grey(used)))
        })
        .collect();
    robot.children.splice(0..0, missing);
}

/// Returns a definition for a material that the file does not define: Gazebo's, or else the default grey.
fn known_or_grey(used: &Element) -> Element {
    let [red, green, blue] =
        gazebo_material(used.attribute("name").unwrap_or_default()).unwrap_or_default().diffuse;
    let color = Element {
        name: "color".into(),
        attributes: vec![("rgba".into(), format!("{red} {green} {blue} 1"))],
        children: Vec::new(),
        source: used.source.clone(),
    };
    Element { children: vec![Node::Element(color)], ..used.clone() }
}

//! `<gazebo>`: sensors, and the properties of a link that Gazebo overrides.
//!
//! For a link, these are read: `sensor`, `material`, `mu1`, `laserRetro`, `turnGravityOff`, `selfCollide`, `kinematic`,
//! `dampingFactor`, the plugin `Label` and our own `<visual><fiducial>`; for a joint: `sensor`, `springStiffness` and `springReference`;
//! for the whole robot: `static`, `self_collide` and its plugins. The rest is accepted and ignored: contact parameters of ODE
//! (`mu2`, `kp`, `kd`, `minDepth`, `maxVel`, …), which other physics engines do not have.

use super::Loader;
use crate::diagnostics::Diagnostics;
use crate::fiducial::fiducials;
use crate::gazebo_materials::{gazebo_material, gazebo_material_names};
use crate::label::{is_label, label};
use crate::model::{JointDynamics, JointIndex, LinkIndex, Model};
use crate::optics::optics;
use crate::plugin;
use crate::sensor::{JointMount, is_on_joint, parse_joint_sensor, parse_sensor};
use crate::suggestion::closest;
use crate::values::{child_bool, child_pose, child_text, friction_coefficient, not_negative, number, share};
use crate::xml::Element;
use belvedere_sensors::Pose;

/// Returns the value of an extension: its attribute `value`, or else its text, as libsdformat reads it.
fn value(extension: &Element) -> String {
    extension.attribute("value").map_or_else(|| extension.text(), |value| value.trim().to_owned())
}

/// Returns the number in an extension, if the extension is there.
fn number_of(parent: &Element, name: &str, diagnostics: &mut Diagnostics) -> Option<f64> {
    let child = parent.child(name)?;
    number(&value(child), &format!("<{name}>"), &child.source, diagnostics)
}

impl Loader<'_> {
    pub(super) fn extensions(&mut self, robot: &Element, model: &mut Model) {
        let mut of_robot = None;
        for element in robot.elements_named("gazebo") {
            for light in element.elements_named("light") {
                let what = format!(
                    "the light '{}' of a robot is left out",
                    light.attribute("name").unwrap_or_default()
                );
                self.diagnostics.warning(&light.source, what, "put it into the world");
            }
            match element.attribute("reference").filter(|name| !name.is_empty()) {
                None => {
                    if let Some(is_static) = child_bool(element, "static", self.diagnostics) {
                        model.is_static = is_static;
                    }
                    if child_bool(element, "self_collide", self.diagnostics) == Some(true) {
                        model.links.iter_mut().for_each(|link| link.self_collide = true);
                    }
                    of_robot = label(element, self.diagnostics).or(of_robot);
                    plugin::read(element, model, self.rules, self.diagnostics);
                }
                Some(name) => match self.link_names.get(name).copied() {
                    Some(link) => self.extend_link(element, link, model),
                    None => self.unknown_reference(element, name, model),
                },
            }
        }
        // A link's own label takes precedence, wherever in the file it is.
        if let Some(label) = of_robot {
            for visual in model.links.iter_mut().flat_map(|link| &mut link.visuals) {
                visual.label.get_or_insert(label);
            }
        }
    }

    fn extend_link(&mut self, element: &Element, index: LinkIndex, model: &mut Model) {
        for sensor in element.elements_named("sensor") {
            // A name may be that of a link and of a joint: each sensor is on what it can be on.
            let link = &model.links[index].name;
            if is_on_joint(sensor)
                && let Some(joint) = self.joint_names.get(link).copied()
            {
                self.joint_sensor(sensor, joint, model);
                continue;
            }
            let pose = child_pose(sensor, self.rules.gazebo_compat, self.diagnostics);
            model.sensors.extend(parse_sensor(sensor, index, pose, self.rules, self.diagnostics));
        }
        self.no_plugins(element, "link", &model.links[index].name);
        let link = &mut model.links[index];
        // Gazebo copies the content of <visual> into each visual of the link.
        for element in std::iter::once(element).chain(element.elements_named("visual")) {
            if let Some(label) = label(element, self.diagnostics) {
                link.visuals.iter_mut().for_each(|visual| visual.label = Some(label));
            }
        }
        for element in element.elements_named("visual") {
            let tags = fiducials(element, self.diagnostics);
            // The visuals of a mesh of several materials count as one.
            let mut places = link.visuals.iter().map(|visual| visual.link_from_visual);
            let first = places.next();
            let is_one = first.is_some() && places.all(|place| Some(place) == first);
            if is_one {
                link.visuals[0].fiducials.extend(tags);
            } else if !tags.is_empty() {
                self.diagnostics.error(
                    &element.source,
                    format!("a <fiducial> is on the link '{}', which needs exactly one visual", link.name),
                    "give the tag a link of its own, with one <visual>",
                );
            }
        }
        // libsdformat copies elements of SDF into the link, behind those that it makes of URDF's names, and the first counts.
        if let Some(has_gravity) = child_bool(element, "gravity", self.diagnostics) {
            link.gravity = has_gravity;
        }
        if let Some(collides) = child_bool(element, "self_collide", self.diagnostics) {
            link.self_collide = collides;
        }
        // As in libsdformat, every value that does not mean false means true.
        if let Some(off) = element.child("turnGravityOff").map(value) {
            link.gravity = matches!(off.to_ascii_lowercase().as_str(), "false" | "no" | "0");
        }
        // As in libsdformat, only these values mean true.
        if let Some(collides) = element.child("selfCollide").map(value) {
            link.self_collide = matches!(collides.to_ascii_lowercase().as_str(), "true" | "yes" | "1");
        }
        if let Some(kinematic) = element.child("kinematic").map(value) {
            link.is_kinematic = matches!(kinematic.to_ascii_lowercase().as_str(), "true" | "yes" | "1");
        }
        if let Some(decay) = number_of(element, "dampingFactor", self.diagnostics) {
            let what = format!("<dampingFactor> of link '{}'", link.name);
            link.velocity_decay = [share(decay, &what, &element.source, self.diagnostics); 2];
        }
        if let Some(optics) = optics(element, self.diagnostics) {
            link.collisions.iter_mut().for_each(|collision| collision.optics = optics);
            link.visuals.iter_mut().for_each(|visual| visual.optics = optics);
        }
        if let Some(retro) = number_of(element, "laserRetro", self.diagnostics) {
            for collision in &mut link.collisions {
                collision.laser_retro = retro as f32;
            }
            for visual in &mut link.visuals {
                visual.laser_retro = retro as f32;
            }
        }
        if let (Some(friction), Some(child)) =
            (number_of(element, "mu1", self.diagnostics), element.child("mu1"))
        {
            let what = format!("<mu1> of link '{}'", link.name);
            let friction = friction_coefficient(friction, &what, &child.source, self.diagnostics);
            for collision in &mut link.collisions {
                collision.friction = Some(friction);
            }
        }
        if let Some(material) = element.child("material") {
            let name = material
                .child("script")
                .and_then(|script| child_text(script, "name"))
                .unwrap_or_else(|| value(material));
            if let Some(look) = gazebo_material(&name) {
                for visual in &mut link.visuals {
                    visual.material = look.clone();
                }
            } else {
                let names: Vec<String> = gazebo_material_names().collect();
                self.diagnostics.warning(
                    &material.source,
                    format!("Gazebo has no material '{name}': link '{}' keeps its look", link.name),
                    self.diagnostics.did_you_mean_or(
                        &name,
                        names.iter().map(String::as_str),
                        "name one as Gazebo/Red, or write <color> in the visual's <material>",
                    ),
                );
            }
        }
    }

    /// Reads a sensor on a joint. The sensor's frame is that of the joint's child.
    fn joint_sensor(&mut self, sensor: &Element, index: JointIndex, model: &mut Model) {
        let mount = JointMount { joint: &model.joints[index], index, child_from_joint: Pose::IDENTITY };
        let pose = child_pose(sensor, self.rules.gazebo_compat, self.diagnostics);
        let read = parse_joint_sensor(sensor, &mount, pose, self.rules, self.diagnostics);
        model.sensors.extend(read);
    }

    /// Warns of plugins of a link or a joint. Gazebo copies them into its `<link>` or `<joint>`, from which it loads none; a
    /// `Label` is copied further, into the visuals.
    fn no_plugins(&mut self, element: &Element, kind: &str, name: &str) {
        for plugin in element.elements_named("plugin").filter(|plugin| kind == "joint" || !is_label(plugin)) {
            let written = |attribute: &str| plugin.attribute(attribute).unwrap_or_default();
            let what = format!(
                "the plugin '{}' ({}) belongs to the {kind} '{name}', and Gazebo loads no plugins of {kind}s: it is left out",
                written("name"),
                written("filename")
            );
            self.diagnostics.warning(&plugin.source, what, "write it into a <gazebo> without a reference");
        }
    }

    /// Reads the spring of a joint.
    fn extend_joint(&mut self, element: &Element, dynamics: &mut JointDynamics) {
        if let Some(stiffness) = number_of(element, "springStiffness", self.diagnostics) {
            dynamics.spring_stiffness =
                not_negative(stiffness, "<springStiffness>", &element.source, self.diagnostics);
        }
        if let Some(reference) = number_of(element, "springReference", self.diagnostics) {
            dynamics.spring_reference = reference;
        }
    }

    /// Handles a reference that is not the name of a link: a joint, or a mistake.
    fn unknown_reference(&mut self, element: &Element, name: &str, model: &mut Model) {
        if let Some(index) = self.joint_names.get(name).copied() {
            self.no_plugins(element, "joint", name);
            self.extend_joint(element, &mut model.joints[index].dynamics);
            for sensor in element.elements_named("sensor") {
                self.joint_sensor(sensor, index, model);
            }
            return;
        }
        let links = model.links.iter().map(|link| link.name.as_str());
        let near = self.diagnostics.did_you_mean(name, links).unwrap_or_default();
        let mut has_sensor = false;
        for sensor in element.elements_named("sensor") {
            has_sensor = true;
            let near = mount_for(sensor, name, model).unwrap_or_else(|| near.clone());
            let what = format!(
                "the sensor '{}' is on the link '{name}', which does not exist",
                sensor.attribute("name").unwrap_or_default()
            );
            if self.rules.gazebo_compat {
                self.diagnostics.warning(
                    &element.source,
                    format!("{what}: it is left out, as in Gazebo"),
                    near,
                );
            } else {
                let remedy = format!(
                    "{near} Correct the reference, or leave the sensor out as Gazebo does with --gazebo-compat"
                );
                self.diagnostics.error(&element.source, what, remedy.trim_start());
            }
        }
        if !has_sensor {
            self.diagnostics.warning(
                &element.source,
                format!("<gazebo reference=\"{name}\"> names no link and no joint: it is left out"),
                near,
            );
        }
    }
}

/// Returns "did you mean …" for a sensor: the closest name among the links that are named like mounts of such a sensor.
fn mount_for(sensor: &Element, name: &str, model: &Model) -> Option<String> {
    let words: &[&str] = match sensor.attribute("type").unwrap_or_default() {
        "ray" | "gpu_ray" | "lidar" | "gpu_lidar" => &["laser", "lidar", "scan", "hokuyo", "velodyne"],
        "camera" | "wideanglecamera" | "depth" | "depth_camera" => &["camera", "rgb", "depth", "optical"],
        "imu" => &["imu", "gyro"],
        _ => return None,
    };
    let links = model.links.iter().map(|link| link.name.as_str());
    let mounts = links.filter(|link| words.iter().any(|word| link.contains(word)));
    closest(name, mounts).map(|near| format!("did you mean '{near}'?"))
}

//! Force-torque sensors: `<force_torque>` of a sensor on a joint, with direction, frame and noise.

use super::instrument::InstrumentPlugin;
use super::noise::instrument;
use super::reader::Reader;
use super::{Kind, Sensor, SensorKind};
use crate::diagnostics::Diagnostics;
use crate::model::{Joint, JointIndex, JointKind};
use crate::rules::Rules;
use crate::values::child_text;
use crate::xml::Element;
use belvedere_sensors::Pose;
use belvedere_sensors::noise::InstrumentConfig;
use glam::DQuat;

/// A sensor that measures the force and the torque that a joint transmits. It measures in the frame of the sensor's link
/// and pose.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTorque {
    /// The joint.
    pub joint: JointIndex,
    /// The axes along which it measures.
    pub frame: MeasureFrame,
    /// True if it measures the wrench of the parent on the child; by default it measures that of the child on the parent.
    pub parent_to_child: bool,
    /// Noise of the force, in N.
    pub force: InstrumentConfig<3>,
    /// Noise of the torque, in N·m.
    pub torque: InstrumentConfig<3>,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

/// The axes along which a force-torque sensor measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MeasureFrame {
    /// The axes of the joint's child link.
    #[default]
    Child,
    /// The axes of the joint's parent link.
    Parent,
    /// The axes of the sensor, from its pose in the joint.
    Sensor,
}

pub(super) const KIND: Kind = Kind {
    types: &["force_torque"],
    plugins: &[],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::ForceTorque(reader.force_torque(sensor)?.into())),
};

/// A joint on which a sensor is mounted.
pub(crate) struct JointMount<'a> {
    /// The joint and its index in the model.
    pub(crate) joint: &'a Joint,
    pub(crate) index: JointIndex,
    /// The frame of the joint, which a sensor's pose is in.
    pub(crate) child_from_joint: Pose,
}

impl JointMount<'_> {
    /// Returns the link, and the pose in it, at which a sensor with this pose in the joint measures along these axes.
    ///
    /// A revolute joint has the same position in both of its links, and a prismatic joint the same axes.
    pub(crate) fn place(&self, frame: MeasureFrame, joint_from_sensor: Pose) -> (usize, Pose) {
        let Joint { parent_from_child, parent, child, kind, .. } = *self.joint;
        let child_from_sensor = self.child_from_joint * joint_from_sensor;
        let along = |pose: Pose, axes: DQuat| Pose::new(pose.translation(), axes);
        match frame {
            MeasureFrame::Sensor => (child, child_from_sensor),
            MeasureFrame::Child => (child, along(child_from_sensor, DQuat::IDENTITY)),
            MeasureFrame::Parent if matches!(kind, JointKind::Prismatic { .. }) => {
                (child, along(child_from_sensor, parent_from_child.inverse().rotation()))
            }
            MeasureFrame::Parent => (parent, along(parent_from_child * child_from_sensor, DQuat::IDENTITY)),
        }
    }
}

/// Returns true if a `<sensor>` has a type that measures a joint.
pub(crate) fn is_on_joint(sensor: &Element) -> bool {
    KIND.has_type(sensor)
}

/// Reads a `<sensor>` on a joint. `joint_from_sensor` is its `<pose>`. Any type other than `force_torque` gives none and a
/// warning.
pub(crate) fn parse_joint_sensor(
    sensor: &Element,
    mount: &JointMount<'_>,
    joint_from_sensor: Pose,
    rules: Rules,
    diagnostics: &mut Diagnostics,
) -> Option<Sensor> {
    if !is_on_joint(sensor) {
        let what = format!(
            "the sensor '{}' of type '{}' is on the joint '{}': it is left out",
            sensor.attribute("name").unwrap_or_default(),
            sensor.attribute("type").unwrap_or_default(),
            mount.joint.name
        );
        let remedy = "sensors of joints are force_torque; put sensors of other types on a link";
        diagnostics.warning(&sensor.source, what, remedy);
        return None;
    }
    let mut read =
        super::read_sensor(sensor, &KIND, mount.joint.child, joint_from_sensor, rules, diagnostics)?;
    if let SensorKind::ForceTorque(it) = &mut read.kind {
        it.joint = mount.index;
        (read.link, read.link_from_sensor) = mount.place(it.frame, joint_from_sensor);
    }
    Some(read)
}

impl Reader<'_> {
    fn force_torque(&mut self, sensor: &Element) -> Option<ForceTorque> {
        let element = sensor.child("force_torque");
        let frames = [
            ("child", MeasureFrame::Child),
            ("parent", MeasureFrame::Parent),
            ("sensor", MeasureFrame::Sensor),
        ];
        let frame = self.choice(element, "frame", &frames);
        let directions = [("child_to_parent", false), ("parent_to_child", true)];
        let parent_to_child = self.choice(element, "measure_direction", &directions);
        let [force, torque] = ["force", "torque"].map(|name| self.axes(element, name));
        if let Some(element) = element {
            let read = ["frame", "measure_direction", "force", "torque"];
            let remedy = format!("take it out: a <force_torque> has {}", read.join(", "));
            self.left_out(element, |name| read.contains(&name), &remedy);
        }
        let plugin = self.instrument_plugin(sensor, &KIND);
        Some(ForceTorque {
            // The caller knows where the sensor is mounted.
            joint: 0,
            frame: frame?,
            parent_to_child: parent_to_child?,
            force: force?,
            torque: torque?,
            plugin,
        })
    }

    /// Reads the noise of three axes, each with its own `<noise>`.
    fn axes(&mut self, parent: Option<&Element>, name: &str) -> Option<InstrumentConfig<3>> {
        let element = parent.and_then(|parent| parent.child(name));
        let names = ["x", "y", "z"];
        let [x, y, z] = names.map(|axis| self.noise_in(element, axis));
        if let Some(element) = element {
            self.left_out(element, |name| names.contains(&name), "take it out: there are x, y and z");
        }
        Some(instrument([x?, y?, z?]))
    }

    /// Returns the value of the word in the child element `name`; the first one if there is no such element.
    fn choice<T: Copy>(&mut self, parent: Option<&Element>, name: &str, words: &[(&str, T)]) -> Option<T> {
        let Some(element) = parent.and_then(|parent| parent.child(name)) else { return Some(words[0].1) };
        let written = parent.and_then(|parent| child_text(parent, name)).unwrap_or_default();
        let found = words.iter().find(|(word, _)| *word == written).map(|(_, value)| *value);
        if found.is_none() {
            let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            self.diagnostics.error(
                &element.source,
                format!("{} is '{written}'", self.what(name)),
                format!("write {}", known.join(" or ")),
            );
        }
        found
    }
}

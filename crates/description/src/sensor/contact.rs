//! Contact sensors: `<contact>` of a sensor, with the collisions that it watches, and `libgazebo_ros_bumper.so` of ROS 1 and
//! ROS 2.

use super::gz::{frame_name, gz_topic};
use super::instrument::InstrumentPlugin;
use super::plugin::{absolute, topic};
use super::reader::Reader;
use super::ros_version::is_ros2;
use super::{Kind, SensorKind, ros2};
use crate::diagnostics::{Diagnostics, Source};
use crate::model::LinkIndex;
use crate::topic as topics;
use crate::values::child_text;
use crate::xml::Element;

/// The frame of the messages of Gazebo's plugins, and of a sensor without a plugin.
const WORLD: &str = "world";

/// A sensor that reports what touches some of the collisions of its link.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSensor {
    /// The collisions that it watches: each is a link, and its index among the collisions of that link.
    pub collisions: Vec<(LinkIndex, usize)>,
    /// The names of collisions in the file that have not been looked up yet.
    named: Vec<(String, Source)>,
    /// The plugin that publishes it. Its frame is `world`, or the one that the file names.
    pub plugin: Option<InstrumentPlugin>,
}

/// A collision that a contact sensor may name.
pub(crate) struct Known {
    /// Its name.
    pub(crate) name: String,
    /// Its link, and its index among the collisions of that link.
    pub(crate) place: (LinkIndex, usize),
}

pub(super) const KIND: Kind = Kind {
    types: &["contact"],
    plugins: &["gazebo_ros_bumper"],
    is_extended: false,
    read: |reader, sensor| Some(SensorKind::Contact(reader.contact(sensor).into())),
};

impl ContactSensor {
    /// Looks up the collisions that a file names. The first known one of a name counts. A name that is not known gives a
    /// warning, and so does a sensor without names. Such a sensor hears nothing, as in Gazebo.
    pub(crate) fn look_up(
        &mut self,
        (sensor, source): (&str, &Source),
        known: &[Known],
        diagnostics: &mut Diagnostics,
    ) {
        let there = || {
            let names: Vec<&str> = known.iter().map(|known| known.name.as_str()).collect();
            if names.is_empty() {
                "give the link a <collision>".to_owned()
            } else {
                format!("there are: {}", names.join(", "))
            }
        };
        if self.named.is_empty() {
            let what = format!("sensor '{sensor}' names no collision, so it reports no contacts");
            let remedy = format!("write <contact><collision>NAME</collision></contact>; {}", there());
            diagnostics.warning(source, what, remedy);
        }
        for (name, source) in std::mem::take(&mut self.named) {
            match known.iter().find(|known| known.name == name) {
                Some(known) if self.collisions.contains(&known.place) => {}
                Some(known) => self.collisions.push(known.place),
                None => {
                    let what = format!(
                        "<collision> of sensor '{sensor}' is '{name}', and its link has no such collision: the \
                         sensor does not watch it"
                    );
                    let names = known.iter().map(|known| known.name.as_str());
                    let remedy = diagnostics.did_you_mean_or(&name, names, &there());
                    diagnostics.warning(&source, what, remedy);
                }
            }
        }
    }
}

impl Reader<'_> {
    fn contact(&mut self, sensor: &Element) -> ContactSensor {
        let element = sensor.child("contact");
        let collisions = element.iter().flat_map(|contact| contact.elements_named("collision"));
        let named = collisions.map(|collision| (collision.text(), collision.source.clone()));
        // What SDF writes if there is no <collision>.
        let named = named.filter(|(name, _)| !name.is_empty() && name != "__default__").collect();
        let plugin = match self.plugin(sensor, &KIND) {
            Some(plugin) => Some(Self::bumper(plugin)),
            None => self.contact_topic(sensor, element),
        };
        ContactSensor { collisions: Vec::new(), named, plugin }
    }

    /// Reads `libgazebo_ros_bumper.so`. As in Gazebo, only the sensor has a rate.
    fn bumper(plugin: &Element) -> InstrumentPlugin {
        let of_ros2 = is_ros2(plugin);
        let (topic, frame) = if of_ros2 {
            (ros2::topic(plugin, "bumper_states", &[]), child_text(plugin, "frame_name"))
        } else {
            (topic(plugin, "", "bumperTopicName", "bumper_states"), child_text(plugin, "frameName"))
        };
        let frame_name = frame.filter(|name| !name.is_empty()).unwrap_or_else(|| WORLD.into());
        InstrumentPlugin { topic, frame_name }
    }

    /// Returns the names of a sensor without a plugin: its topic is that of `<contact>`, as in gz-sim.
    fn contact_topic(&mut self, sensor: &Element, contact: Option<&Element>) -> Option<InstrumentPlugin> {
        let of_sensor = gz_topic(sensor)?;
        let own = contact.and_then(|contact| {
            topics::check(contact, self.diagnostics);
            child_text(contact, "topic").filter(|topic| !topic.is_empty() && topic != "__default_topic__")
        });
        let topic = own.map_or(of_sensor, |topic| absolute(&[&topic]));
        let frame = frame_name(sensor);
        Some(InstrumentPlugin { topic, frame_name: if frame.is_empty() { WORLD.into() } else { frame } })
    }
}

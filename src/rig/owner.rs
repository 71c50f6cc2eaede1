//! [`Owner`]: the source of a stream, which messages name.

use crate::description::diagnostics::Source;
use crate::description::model::{BasePlugin, ModelPlugin, Sensor};
use crate::entities::{Entity, EntityId};

/// The part of a model that publishes a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// The simulation itself.
    Simulation,
    /// The model as a robot: its transforms and joint states.
    Robot,
    /// The base.
    Base,
    /// Another plugin, by its number in `Model::plugins`.
    Plugin(usize),
    /// A sensor, by its number in `Model::sensors`.
    Sensor(usize),
}

/// The source of a stream.
#[derive(Debug, Clone, PartialEq)]
pub struct Owner {
    /// The model; `None` for the simulation's own streams.
    pub entity: Option<EntityId>,
    /// The part of it.
    pub part: Part,
    /// Its name in messages, such as `sensor 'front' of model 'car'`.
    pub name: String,
    /// Its place in the files.
    pub source: Source,
}

impl Owner {
    /// The simulation itself.
    pub fn simulation() -> Self {
        Self {
            entity: None,
            part: Part::Simulation,
            name: "the simulation".into(),
            source: Source::new("the simulation", 0),
        }
    }

    /// A model as a robot.
    pub(super) fn robot(id: EntityId, entity: &Entity) -> Self {
        Self::of(id, entity, Part::Robot, "the robot's own state", &entity.model.source)
    }

    /// The base of a model.
    pub(super) fn base(id: EntityId, entity: &Entity, base: &BasePlugin) -> Self {
        let what = format!("the {} base", base.drive.name());
        Self::of(id, entity, Part::Base, &what, &base.source)
    }

    /// Another plugin of a model.
    pub(super) fn plugin(id: EntityId, entity: &Entity, number: usize, plugin: &ModelPlugin) -> Self {
        let (what, source) = match plugin {
            ModelPlugin::Base(base) => (base.drive.name(), &base.source),
            ModelPlugin::Pose(pose) => ("the plugin of the true pose", &pose.source),
            ModelPlugin::JointStates(states) => ("the plugin of joint states", &states.source),
        };
        Self::of(id, entity, Part::Plugin(number), what, source)
    }

    /// A sensor of a model.
    pub(super) fn sensor(id: EntityId, entity: &Entity, number: usize, sensor: &Sensor) -> Self {
        let what = format!("sensor '{}'", sensor.name);
        Self::of(id, entity, Part::Sensor(number), &what, &sensor.source)
    }

    fn of(id: EntityId, entity: &Entity, part: Part, what: &str, source: &Source) -> Self {
        let name = format!("{what} of model '{}'", entity.name);
        Self { entity: Some(id), part, name, source: source.clone() }
    }
}

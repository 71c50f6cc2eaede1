//! [`Entities`]: the models in the world, their start poses, and the meaning of names.

use crate::description::model::{LinkIndex, Model, Sensor};
use crate::description::suggestion::did_you_mean_or;
use crate::robot::{self, Feeler, InertialUnit, Robot};
use crate::world::physics::{ModelIndex, Physics, Placement};
use belvedere_sensors::Pose;

/// Names that mean the world itself; Gazebo's services know the same.
const WORLD_NAMES: [&str; 4] = ["", "world", "map", "/map"];

/// Longest name in a command, in bytes.
pub const MAX_NAME_BYTES: usize = 63;

/// Checks a name that a user gives a model.
///
/// # Errors
/// A message, if it means the world or a link of a model, or is too long for a command.
pub fn model_name(name: &str) -> Result<String, String> {
    if WORLD_NAMES.contains(&name) {
        Err(format!("'{name}' is the world itself"))
    } else if name.contains("::") {
        Err("'::' separates a model from its link".to_owned())
    } else if name.len() > MAX_NAME_BYTES {
        Err(format!("it has more than {MAX_NAME_BYTES} bytes"))
    } else {
        Ok(name.to_owned())
    }
}

/// Checks a ROS namespace and removes slashes at its ends. It consists of names separated by /, which start with a
/// letter and contain letters, digits and _.
///
/// # Errors
/// A message with the problem and a remedy.
pub fn namespace(given: &str) -> Result<String, String> {
    let bare = given.strip_prefix('/').unwrap_or(given);
    let bare = bare.strip_suffix('/').unwrap_or(bare);
    let is_name = |part: &str| {
        part.starts_with(|first: char| first.is_ascii_alphabetic())
            && part.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
    };
    if bare.is_empty() || bare.split('/').all(is_name) {
        Ok(bare.to_owned())
    } else {
        Err(format!(
            "'{given}' is not a ROS namespace; write a letter and then letters, digits and _, as in robot_1"
        ))
    }
}

/// Identifies a model in a simulation. The index of a deleted model is used again, with a later generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EntityId {
    index: ModelIndex,
    generation: u32,
}

impl EntityId {
    /// Returns its index in the world.
    pub fn index(self) -> ModelIndex {
        self.index
    }
}

/// The way in which a model was added to the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// In the world file.
    World,
    /// At the start, as one of the simulated robots.
    Start,
    /// While the simulation was running.
    Spawned,
}

/// A model in the world.
#[derive(Debug)]
pub struct Entity {
    /// Its name.
    pub name: String,
    /// Prefix of its topics and frames, as in `/NAMESPACE/scan`; empty for none.
    pub namespace: String,
    /// Its description.
    pub model: Model,
    /// Start pose of its frame.
    pub start: Pose,
    /// The way in which it was added.
    pub origin: Origin,
    /// The name that distinguishes the noise of its sensors from others'; see `Entities::noise_name`.
    pub noise_name: String,
    /// Its base and its state, if it is a robot.
    pub robot: Option<Robot>,
    /// Its inertial units, in the order of its sensors.
    pub units: Vec<InertialUnit>,
    /// What its contact sensors feel, in the order of its sensors.
    pub feelers: Vec<Feeler>,
}

impl Entity {
    /// Returns its placement in physics at the start.
    pub(crate) fn placement(&self) -> Placement<'_> {
        if self.robot.is_some() {
            robot::placement(&self.model, self.start)
        } else {
            Placement::of_thing(&self.model, self.start)
        }
    }

    /// Returns its sensors.
    pub fn sensors(&self) -> &[Sensor] {
        &self.model.sensors
    }

    /// Returns one of its topics in its namespace.
    pub fn topic(&self, topic: &str) -> String {
        if self.namespace.is_empty() {
            return topic.to_owned();
        }
        format!("/{}/{}", self.namespace, topic.trim_start_matches('/'))
    }

    /// Returns one of its frames in its namespace; an empty frame stays empty. In a namespace, a leading slash, as ROS
    /// 1 plugins write it, is removed, because tf2 frames contain none.
    pub fn frame(&self, frame: &str) -> String {
        let bare = if self.namespace.is_empty() { frame } else { frame.trim_start_matches('/') };
        if bare.is_empty() { String::new() } else { self.scoped(bare) }
    }

    /// Returns a name in its namespace.
    pub fn scoped(&self, name: &str) -> String {
        scoped(&self.namespace, name)
    }
}

/// Returns a name in a namespace, unchanged if the namespace is empty.
pub(crate) fn scoped(namespace: &str, name: &str) -> String {
    if namespace.is_empty() { name.to_owned() } else { format!("{namespace}/{name}") }
}

/// All models. The place of a deleted model is empty until another model is added.
#[derive(Debug, Default)]
pub struct Entities {
    places: Vec<Place>,
}

#[derive(Debug, Default)]
struct Place {
    /// Number of models that had this place before.
    generation: u32,
    entity: Option<Entity>,
}

impl Place {
    fn id(&self, index: ModelIndex) -> EntityId {
        EntityId { index, generation: self.generation }
    }
}

impl Entities {
    /// Adds a model at the index that physics has given it.
    pub(crate) fn add(&mut self, index: ModelIndex, entity: Entity) -> EntityId {
        if index >= self.places.len() {
            self.places.resize_with(index + 1, Place::default);
        }
        let place = &mut self.places[index];
        place.entity = Some(entity);
        place.id(index)
    }

    /// Returns the name that distinguishes the noise of a new model's sensors from others': its namespace, or its name.
    /// It is empty for the first robot at the start without a namespace, so that the noise of a single robot does not
    /// depend on its name.
    pub(crate) fn noise_name(&self, name: &str, namespace: &str, origin: Origin) -> String {
        let has_none = |entity: &Entity| entity.noise_name.is_empty();
        match (namespace, origin) {
            ("", Origin::Start) if !self.iter().any(|(_, entity)| has_none(entity)) => String::new(),
            ("", _) => name.to_owned(),
            (namespace, _) => namespace.to_owned(),
        }
    }

    /// Removes a model.
    pub(crate) fn remove(&mut self, id: EntityId) {
        if let Some(place) = self.places.get_mut(id.index).filter(|place| place.generation == id.generation) {
            *place = Place { generation: place.generation + 1, entity: None };
        }
    }

    /// Returns the model with this identity, unless it was deleted.
    pub fn get(&self, id: EntityId) -> Option<&Entity> {
        self.places.get(id.index).filter(|place| place.generation == id.generation)?.entity.as_ref()
    }

    /// Returns the model at this index, if there is one.
    pub(crate) fn at(&self, index: ModelIndex) -> Option<&Entity> {
        self.places.get(index)?.entity.as_ref()
    }

    /// Like [`Entities::get`], but mutable.
    pub(crate) fn get_mut(&mut self, id: EntityId) -> Option<&mut Entity> {
        self.places.get_mut(id.index).filter(|place| place.generation == id.generation)?.entity.as_mut()
    }

    /// Returns the robot with this identity.
    pub fn robot(&self, id: EntityId) -> Option<&Robot> {
        self.get(id)?.robot.as_ref()
    }

    /// Iterates over all models, mutably.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = (EntityId, &mut Entity)> {
        let places = self.places.iter_mut().enumerate();
        places.filter_map(|(index, place)| Some((place.id(index), place.entity.as_mut()?)))
    }

    /// Reads encoders, gyros, accelerometers and contacts after a step.
    pub(crate) fn observe(&mut self, physics: &Physics) {
        for (_, entity) in self.iter_mut() {
            entity.robot.iter_mut().for_each(|robot| robot.observe(physics));
            entity.units.iter_mut().for_each(|unit| unit.observe(physics));
            entity.feelers.iter_mut().for_each(|feeler| feeler.observe(physics));
        }
    }

    /// Iterates over all robots, mutably.
    pub fn robots_mut(&mut self) -> impl Iterator<Item = &mut Robot> {
        self.iter_mut().filter_map(|(_, entity)| entity.robot.as_mut())
    }

    /// Iterates over all models with their identities.
    pub fn iter(&self) -> impl Iterator<Item = (EntityId, &Entity)> {
        let places = self.places.iter().enumerate();
        places.filter_map(|(index, place)| Some((place.id(index), place.entity.as_ref()?)))
    }

    /// Iterates over all places, including empty ones, for building physics.
    pub(crate) fn placements(&self) -> impl Iterator<Item = Option<Placement<'_>>> {
        self.places.iter().map(|place| place.entity.as_ref().map(Entity::placement))
    }

    /// Iterates over the models that were spawned while the simulation was running.
    pub fn spawned(&self) -> impl Iterator<Item = &Entity> {
        self.iter().map(|(_, entity)| entity).filter(|entity| entity.origin == Origin::Spawned)
    }

    /// Finds a model by its name.
    ///
    /// # Errors
    /// A message, if there is none.
    pub fn find(&self, name: &str) -> Result<(EntityId, &Entity), String> {
        self.iter().find(|(_, entity)| entity.name == name).ok_or_else(|| {
            let names = || self.iter().map(|(_, entity)| entity.name.as_str());
            let mut all: Vec<_> = names().take(12).collect();
            if names().nth(12).is_some() {
                all.push("…");
            }
            let there = did_you_mean_or(name, names(), &format!("there are: {}", all.join(", ")));
            format!("there is no model '{name}'; {there}")
        })
    }

    /// Returns true if a name is taken, or means the world.
    pub fn is_taken(&self, name: &str) -> bool {
        WORLD_NAMES.contains(&name) || self.iter().any(|(_, entity)| entity.name == name)
    }

    /// Returns the pose of a frame in the world: a model, `model::link`, a link alone, or the world itself.
    ///
    /// # Errors
    /// A message, if there is no such frame.
    pub fn world_from_frame(&self, name: &str, physics: &Physics) -> Result<Pose, String> {
        if WORLD_NAMES.contains(&name) {
            return Ok(Pose::IDENTITY);
        }
        if let Some((id, _)) = self.iter().find(|(_, entity)| entity.name == name) {
            return Ok(physics.world_from_model(id.index));
        }
        let link = |(id, entity): (EntityId, &Entity)| -> Option<(ModelIndex, LinkIndex)> {
            let own = name.strip_prefix(&entity.name).and_then(|rest| rest.strip_prefix("::"));
            Some((id.index, entity.model.link_named(own.unwrap_or(name))?))
        };
        let (model, link) = self.iter().find_map(link).ok_or_else(|| {
            format!(
                "there is no reference frame '{name}'; name a model, one of its links as model::link, or world"
            )
        })?;
        Ok(physics.world_from_link(model, link))
    }
}

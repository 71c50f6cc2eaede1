//! Who is in the world, where each was at the start, and what names mean.

use crate::description::model::{LinkIndex, Model, Sensor};
use crate::description::suggestion::did_you_mean_or;
use crate::robot::{self, InertialUnit, Robot};
use crate::world::physics::{ModelIndex, Physics, Placement};
use belvedere_sensors::Pose;

/// Names that mean the world itself; Gazebo's services know the same.
const WORLD_NAMES: [&str; 4] = ["", "world", "map", "/map"];

/// Longest name that a command can give, in bytes.
pub const MAX_NAME_BYTES: usize = 63;

/// A name that a model may be given from outside.
///
/// # Errors
/// In words: it means the world, or something of a model's, or no command could name it.
pub fn model_name(name: &str) -> Result<String, String> {
    if WORLD_NAMES.contains(&name) {
        Err(format!("'{name}' is the world itself"))
    } else if name.contains("::") {
        Err("'::' stands between a model and its link".to_owned())
    } else if name.len() > MAX_NAME_BYTES {
        Err(format!("it has more than {MAX_NAME_BYTES} bytes"))
    } else {
        Ok(name.to_owned())
    }
}

/// A namespace that ROS takes, without slashes at its ends: names of letters, digits and _, a letter first, apart by /.
///
/// # Errors
/// In words: what is wrong with it, and what would be right.
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
            "'{given}' is no namespace in ROS; write a letter and then letters, digits and _, as in robot_1"
        ))
    }
}

/// One model in a simulation. The index of a deleted one is given to another, which is of a later generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EntityId {
    index: ModelIndex,
    generation: u32,
}

impl EntityId {
    /// Its index in the world.
    pub fn index(self) -> ModelIndex {
        self.index
    }
}

/// How a model came into the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// With the world file.
    World,
    /// At the start, as a robot that the simulation is of.
    Start,
    /// While it ran.
    Spawned,
}

/// A model in the world.
#[derive(Debug)]
pub struct Entity {
    /// What it is called.
    pub name: String,
    /// Stands before its topics and frames, as in `/NAMESPACE/scan`; empty for none.
    pub namespace: String,
    /// What it is.
    pub model: Model,
    /// Where its frame was at the start.
    pub start: Pose,
    /// How it came.
    pub origin: Origin,
    /// What the noise of its sensors differs by from others'; `Entities::noise_name` chooses it.
    pub noise_name: String,
    /// What of it drives and tells of itself, if it is a robot.
    pub robot: Option<Robot>,
    /// What its inertial units feel, in the order of its sensors.
    pub units: Vec<InertialUnit>,
}

impl Entity {
    /// How it takes part in physics, at its start.
    pub(crate) fn placement(&self) -> Placement<'_> {
        if self.robot.is_some() {
            robot::placement(&self.model, self.start)
        } else {
            Placement::of_thing(&self.model, self.start)
        }
    }

    /// What it carries that senses.
    pub fn sensors(&self) -> &[Sensor] {
        &self.model.sensors
    }

    /// One of its topics, in its namespace.
    pub fn topic(&self, topic: &str) -> String {
        if self.namespace.is_empty() {
            return topic.to_owned();
        }
        format!("/{}/{}", self.namespace, topic.trim_start_matches('/'))
    }

    /// One of its frames, in its namespace; none stays none. A slash before it, as plugins of ROS 1 write it, is left out
    /// there, since no frame of tf2 has one within.
    pub fn frame(&self, frame: &str) -> String {
        let bare = if self.namespace.is_empty() { frame } else { frame.trim_start_matches('/') };
        if bare.is_empty() { String::new() } else { self.scoped(bare) }
    }

    /// A name of something of it, in its namespace.
    pub fn scoped(&self, name: &str) -> String {
        scoped(&self.namespace, name)
    }
}

/// A name in a namespace: itself if that is empty.
pub(crate) fn scoped(namespace: &str, name: &str) -> String {
    if namespace.is_empty() { name.to_owned() } else { format!("{namespace}/{name}") }
}

/// Everybody; places of those that were deleted are empty until another comes.
#[derive(Debug, Default)]
pub struct Entities {
    places: Vec<Place>,
}

#[derive(Debug, Default)]
struct Place {
    /// How many were here before.
    generation: u32,
    entity: Option<Entity>,
}

impl Place {
    fn id(&self, index: ModelIndex) -> EntityId {
        EntityId { index, generation: self.generation }
    }
}

impl Entities {
    /// Takes one in at the index that physics gave it.
    pub(crate) fn add(&mut self, index: ModelIndex, entity: Entity) -> EntityId {
        if index >= self.places.len() {
            self.places.resize_with(index + 1, Place::default);
        }
        let place = &mut self.places[index];
        place.entity = Some(entity);
        place.id(index)
    }

    /// What the noise of the sensors of one who comes differs by from others': the namespace, or the name; nothing for the
    /// first robot of the start that has no namespace, so that the one robot of a simulation may be called anything.
    pub(crate) fn noise_name(&self, name: &str, namespace: &str, origin: Origin) -> String {
        let has_none = |entity: &Entity| entity.noise_name.is_empty();
        match (namespace, origin) {
            ("", Origin::Start) if !self.iter().any(|(_, entity)| has_none(entity)) => String::new(),
            ("", _) => name.to_owned(),
            (namespace, _) => namespace.to_owned(),
        }
    }

    /// Empties a place.
    pub(crate) fn remove(&mut self, id: EntityId) {
        if let Some(place) = self.places.get_mut(id.index).filter(|place| place.generation == id.generation) {
            *place = Place { generation: place.generation + 1, entity: None };
        }
    }

    /// The one of that identity, unless it was deleted.
    pub fn get(&self, id: EntityId) -> Option<&Entity> {
        self.places.get(id.index).filter(|place| place.generation == id.generation)?.entity.as_ref()
    }

    /// The same, to be changed.
    pub(crate) fn get_mut(&mut self, id: EntityId) -> Option<&mut Entity> {
        self.places.get_mut(id.index).filter(|place| place.generation == id.generation)?.entity.as_mut()
    }

    /// The robot of that place.
    pub fn robot(&self, id: EntityId) -> Option<&Robot> {
        self.get(id)?.robot.as_ref()
    }

    /// Everybody, to be changed.
    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = (EntityId, &mut Entity)> {
        let places = self.places.iter_mut().enumerate();
        places.filter_map(|(index, place)| Some((place.id(index), place.entity.as_mut()?)))
    }

    /// Reads encoders, gyros and accelerometers after a step.
    pub(crate) fn observe(&mut self, physics: &Physics) {
        for (_, entity) in self.iter_mut() {
            entity.robot.iter_mut().for_each(|robot| robot.observe(physics));
            entity.units.iter_mut().for_each(|unit| unit.observe(physics));
        }
    }

    /// All robots.
    pub fn robots_mut(&mut self) -> impl Iterator<Item = &mut Robot> {
        self.iter_mut().filter_map(|(_, entity)| entity.robot.as_mut())
    }

    /// All, with their identities.
    pub fn iter(&self) -> impl Iterator<Item = (EntityId, &Entity)> {
        let places = self.places.iter().enumerate();
        places.filter_map(|(index, place)| Some((place.id(index), place.entity.as_ref()?)))
    }

    /// Every place, empty ones too: as physics is built from it.
    pub(crate) fn placements(&self) -> impl Iterator<Item = Option<Placement<'_>>> {
        self.places.iter().map(|place| place.entity.as_ref().map(Entity::placement))
    }

    /// Those that came while it ran.
    pub fn spawned(&self) -> impl Iterator<Item = &Entity> {
        self.iter().map(|(_, entity)| entity).filter(|entity| entity.origin == Origin::Spawned)
    }

    /// The one of that name.
    ///
    /// # Errors
    /// In words, if there is none.
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

    /// Whether a name is taken, or would mean something else.
    pub fn is_taken(&self, name: &str) -> bool {
        WORLD_NAMES.contains(&name) || self.iter().any(|(_, entity)| entity.name == name)
    }

    /// Pose in the world of a frame: a model, `model::link`, a link alone, or the world itself.
    ///
    /// # Errors
    /// In words, if there is no such frame.
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

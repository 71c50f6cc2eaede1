//! Who is in the world, where each was at the start, and what names mean.

use crate::description::model::{LinkIndex, Model};
use crate::description::values::nearest;
use crate::world::physics::{ModelIndex, Physics};
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

/// How a model came into the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// With the world file.
    World,
    /// As the robot that the simulation is of.
    Robot,
    /// By a command.
    Spawned,
}

/// A model in the world.
#[derive(Debug, Clone)]
pub struct Resident {
    /// What it is called.
    pub name: String,
    /// What it is.
    pub model: Model,
    /// Where its frame was at the start.
    pub start: Pose,
    /// How it came.
    pub role: Role,
}

/// Everybody, by [`ModelIndex`]; places of those that were deleted stay empty.
#[derive(Debug, Default)]
pub struct Roster {
    residents: Vec<Option<Resident>>,
}

impl Roster {
    /// Takes one in. Its index is that of physics if all were added in the same order.
    pub fn add(&mut self, resident: Resident) {
        self.residents.push(Some(resident));
    }

    /// Leaves the next place empty.
    pub fn add_nobody(&mut self) {
        self.residents.push(None);
    }

    /// Empties a place.
    pub fn remove(&mut self, index: ModelIndex) {
        if let Some(place) = self.residents.get_mut(index) {
            *place = None;
        }
    }

    /// All, with their places.
    pub fn iter(&self) -> impl Iterator<Item = (ModelIndex, &Resident)> {
        self.residents.iter().enumerate().filter_map(|(index, resident)| Some((index, resident.as_ref()?)))
    }

    /// Every place, empty ones too: as physics is built from it.
    pub fn places(&self) -> impl Iterator<Item = Option<(&Model, Pose, bool)>> {
        self.residents.iter().map(|resident| {
            resident.as_ref().map(|resident| (&resident.model, resident.start, resident.role == Role::Robot))
        })
    }

    /// How many have come by a command.
    pub fn spawned(&self) -> impl Iterator<Item = &Resident> {
        self.iter().map(|(_, resident)| resident).filter(|resident| resident.role == Role::Spawned)
    }

    /// The model of that name.
    ///
    /// # Errors
    /// In words, if there is none.
    pub fn find(&self, name: &str) -> Result<(ModelIndex, &Resident), String> {
        self.iter().find(|(_, resident)| resident.name == name).ok_or_else(|| {
            let names = || self.iter().map(|(_, resident)| resident.name.as_str());
            let near = nearest(name, names()).map(|near| format!("did you mean '{near}'? "));
            let mut all: Vec<_> = names().take(12).collect();
            if names().nth(12).is_some() {
                all.push("…");
            }
            format!("there is no model '{name}'; {}there are: {}", near.unwrap_or_default(), all.join(", "))
        })
    }

    /// Whether a name is taken, or would mean something else.
    pub fn is_taken(&self, name: &str) -> bool {
        WORLD_NAMES.contains(&name) || self.iter().any(|(_, resident)| resident.name == name)
    }

    /// Pose in the world of a frame: a model, `model::link`, a link alone, or the world itself.
    ///
    /// # Errors
    /// In words, if there is no such frame.
    pub fn world_from_frame(&self, name: &str, physics: &Physics) -> Result<Pose, String> {
        if WORLD_NAMES.contains(&name) {
            return Ok(Pose::IDENTITY);
        }
        if let Some((index, _)) = self.iter().find(|(_, resident)| resident.name == name) {
            return Ok(physics.world_from_model(index));
        }
        let link = |(index, resident): (ModelIndex, &Resident)| -> Option<(ModelIndex, LinkIndex)> {
            let own = name.strip_prefix(&resident.name).and_then(|rest| rest.strip_prefix("::"));
            Some((index, resident.model.link_named(own.unwrap_or(name))?))
        };
        let (model, link) = self.iter().find_map(link).ok_or_else(|| {
            format!(
                "there is no reference frame '{name}'; name a model, one of its links as model::link, or world"
            )
        })?;
        Ok(physics.world_from_link(model, link))
    }
}

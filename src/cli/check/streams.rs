//! The streams of a simulation, grouped by the parts of its models.

use crate::rig::report::stream_lines;
use crate::rig::{Outlet, Part, Rig};

/// The streams of a simulation; unknown if its files have errors.
pub(super) struct Streams(Option<Rig>);

impl Streams {
    pub(super) fn of(rig: Rig) -> Self {
        Self(Some(rig))
    }

    pub(super) fn unknown() -> Self {
        Self(None)
    }

    /// Returns the lines about the streams of one part of the model with this number in the world.
    pub(super) fn of_part(&self, model: usize, part: Part) -> Vec<String> {
        let Some(rig) = &self.0 else {
            return vec!["  publishes    not known: the file has errors".into()];
        };
        let is_of_part = |outlet: &&Outlet| {
            let owner = outlet.owner();
            owner.part == part && owner.entity.is_some_and(|entity| entity.index() == model)
        };
        stream_lines(rig.outlets().into_iter().filter(is_of_part))
    }
}

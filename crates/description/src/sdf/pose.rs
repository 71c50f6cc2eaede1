//! `<pose>`: its numbers, and the frame that it is relative to.
//!
//! A pose is relative to its parent element (a joint's to its child link), unless `relative_to` names any frame of the
//! same model or world. In SDF 1.5 and 1.6 the attribute is `frame`, which libsdformat reads as `relative_to` since
//! Gazebo 11. Older ones ignore it, so there a name that is unknown is a warning and no error.

use super::{Loader, Version};
use crate::diagnostics::Source;
use crate::values::parse_pose;
use crate::xml::Element;
use belvedere_sensors::Pose;

/// A pose as the file writes it.
pub(super) struct WrittenPose {
    pub(super) pose: Pose,
    /// The frame that the pose is relative to; `None` for the default of the element's kind.
    pub(super) relative_to: Option<String>,
    /// True before SDF 1.7, where a frame that does not exist is ignored.
    pub(super) is_old: bool,
    pub(super) source: Source,
}

impl Loader<'_> {
    /// Checks the pose of a model that is not inside a world or a model of its file: no frame is around it.
    pub(super) fn check_outermost(&mut self, model: &Element, version: Version) {
        let Some(pose) = model.child("pose") else { return };
        let named = |attribute| pose.attribute(attribute).filter(|name| !name.is_empty());
        let is_old = version < (1, 7);
        let Some(frame) = named("relative_to").or(named("frame").filter(|_| is_old)) else { return };
        let what = format!("the <pose> of a file's own model is relative to '{frame}'");
        let attribute = if named("relative_to").is_some() { "relative_to" } else { "frame" };
        let remedy = format!("take the {attribute} out: there is no frame around the model");
        if is_old {
            self.diagnostics.warning(&pose.source, format!("{what}, which is ignored"), remedy);
        } else {
            self.diagnostics.error(&pose.source, what, remedy);
        }
    }

    /// Reads the `<pose>` inside `parent`; the identity if there is none.
    pub(super) fn pose(&mut self, parent: &Element, version: Version) -> WrittenPose {
        let Some(element) = parent.child("pose") else {
            let source = parent.source.clone();
            return WrittenPose { pose: Pose::IDENTITY, relative_to: None, is_old: false, source };
        };
        let named = |attribute| element.attribute(attribute).filter(|name| !name.is_empty());
        let is_old = version < (1, 7);
        let relative_to = if is_old { named("frame").or(named("relative_to")) } else { named("relative_to") };
        WrittenPose {
            pose: parse_pose(element, self.rules.gazebo_compat, self.diagnostics).unwrap_or(Pose::IDENTITY),
            relative_to: relative_to.map(str::to_owned),
            is_old,
            source: element.source.clone(),
        }
    }
}

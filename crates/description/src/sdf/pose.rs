//! `<pose>`: its numbers, and the frame that it is relative to.
//!
//! Up to SDF 1.6 a pose is relative to its parent element (a joint's to its child link). From 1.7 on `relative_to` may
//! name any frame of the same model or world.

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
    pub(super) source: Source,
}

impl Loader<'_> {
    /// Checks the pose of a model that is not inside a world or a model of its file: no frame is around it.
    pub(super) fn check_outermost(&mut self, model: &Element, version: Version) {
        let pose = model.child("pose");
        let frame = pose.and_then(|pose| pose.attribute("relative_to")).filter(|name| !name.is_empty());
        if let (Some(pose), Some(frame)) = (pose, frame)
            && version >= (1, 7)
        {
            let what = format!("the <pose> of a file's own model is relative to '{frame}'");
            self.diagnostics.error(
                &pose.source,
                what,
                "take the relative_to out: there is no frame around the model",
            );
        }
    }

    /// Reads the `<pose>` inside `parent`; the identity if there is none.
    pub(super) fn pose(&mut self, parent: &Element, version: Version) -> WrittenPose {
        let Some(element) = parent.child("pose") else {
            return WrittenPose { pose: Pose::IDENTITY, relative_to: None, source: parent.source.clone() };
        };
        let mut relative_to = element.attribute("relative_to").filter(|name| !name.is_empty());
        if version < (1, 7) {
            // SDF 1.5 and 1.6 had `frame`, whose meaning was never settled; Gazebo ignores it.
            if let Some(name) = relative_to.take().or(element.attribute("frame").filter(|f| !f.is_empty())) {
                self.diagnostics.warning(
                    &element.source,
                    format!("the frame '{name}' of <pose> is ignored in SDF {}.{}", version.0, version.1),
                    "write <sdf version=\"1.7\"> and relative_to",
                );
            }
        }
        WrittenPose {
            pose: parse_pose(element, self.rules.gazebo_compat, self.diagnostics).unwrap_or(Pose::IDENTITY),
            relative_to: relative_to.map(str::to_owned),
            source: element.source.clone(),
        }
    }
}

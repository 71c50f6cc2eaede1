//! The true pose of a robot with its stream, which is part of the ground truth.

use super::channel::Channel;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::description::Severity;
use crate::entities::EntityId;
use belvedere_bridge::payload::Pose;
use belvedere_bridge::{Kind, StreamSpec};

/// The topic, in the robot's namespace.
const TOPIC: &str = "/truth/pose";
/// The frame that all robots share.
const FRAME: &str = "world";

/// The channel that publishes the pose of a robot's model in the world.
pub(super) struct RobotPoseChannel {
    id: EntityId,
    pose: Outlet,
}

impl RobotPoseChannel {
    /// Opens the stream; `None`, with a warning, if a plugin or a sensor of the robot has its topic.
    pub(super) fn open(opening: &Opening<'_>) -> Result<Option<Self>, RigError> {
        let topic = opening.entity.topic(TOPIC);
        if opening.names.is_taken(&topic) {
            let what = format!(
                "the robot has a stream {topic} of its own: ground truth leaves out the robot's pose"
            );
            let remedy = "give that stream another topic to have both";
            opening.names.note(Severity::Warning, &opening.owner.source, what, remedy);
            return Ok(None);
        }
        let spec = StreamSpec::structs(TOPIC, Kind::Pose, 1).rate_hz(opening.rate.hz());
        Ok(Some(Self { id: opening.id, pose: opening.open_in_world(&spec.frame_id(FRAME))? }))
    }
}

impl Channel for RobotPoseChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.pose]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let pose = context.physics.world_from_model_at(self.id.index(), context.stamp_ns);
        let (position, orientation) = (pose.translation().to_array(), pose.rotation().to_array());
        self.pose.send_structs(context.stamp_ns, &[Pose { position, orientation }]);
    }
}

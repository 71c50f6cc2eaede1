//! Frames that are rendered on demand, regardless of schedules.

use super::{Rig, Scheduled, Stage};
use crate::world::scene::WorldScene;

impl Rig {
    /// Returns true if a channel has a stream on this topic.
    pub fn has(&self, topic: &str) -> bool {
        self.channels.iter().any(|scheduled| scheduled.has(topic))
    }

    /// Publishes the next frame of each channel that has a stream on one of these topics now, regardless of its
    /// schedule.
    pub fn take(&mut self, topics: &[String], stage: Stage<'_>, scene: &mut WorldScene) {
        for scheduled in &mut self.channels {
            if topics.iter().any(|topic| scheduled.has(topic)) {
                scheduled.take(stage.physics.time_ns(), stage, scene, &mut self.workspace);
            }
        }
    }

    /// Publishes the frame with this number of the channel that has a stream on this topic; returns false if there is
    /// none. The frame does not depend on earlier frames, as if it were the first, unless `goes_on` is set: then
    /// optical flow leads back to the previous one.
    pub fn take_numbered(
        &mut self,
        (topic, frame): (&str, u64),
        goes_on: bool,
        stage: Stage<'_>,
        scene: &mut WorldScene,
    ) -> bool {
        let has_topic = |scheduled: &&mut Scheduled| scheduled.has(topic);
        let Some(scheduled) = self.channels.iter_mut().find(has_topic) else { return false };
        if !goes_on {
            scheduled.channel.restart();
        }
        scheduled.publish(frame, stage.physics.time_ns(), stage, scene, &mut self.workspace);
        true
    }
}

impl Scheduled {
    /// Returns true if it has a stream on this topic.
    fn has(&self, topic: &str) -> bool {
        self.channel.outlets().iter().any(|outlet| outlet.topic() == topic)
    }
}

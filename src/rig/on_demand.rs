//! Frames that are taken when somebody asks, whatever is due.

use super::{Rig, Scheduled, Stage};
use crate::world::scene::WorldScene;

impl Rig {
    /// Whether some channel has a stream of this topic.
    pub fn has(&self, topic: &str) -> bool {
        self.channels.iter().any(|scheduled| scheduled.has(topic))
    }

    /// Takes the next frame of each channel that has a stream of one of these topics now, whenever it is due.
    pub fn take(&mut self, topics: &[String], stage: Stage<'_>, scene: &mut WorldScene) {
        for scheduled in &mut self.channels {
            if topics.iter().any(|topic| scheduled.has(topic)) {
                scheduled.take(stage.physics.time_ns(), stage, scene, &mut self.workspace);
            }
        }
    }

    /// Takes the frame of this number of the channel that has a stream of this topic; false if there is none. It depends on
    /// no frame before, as if it was the first that is taken; unless it goes on from one, to which flow leads back.
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
    /// Whether it has a stream of this topic.
    fn has(&self, topic: &str) -> bool {
        self.channel.outlets().iter().any(|outlet| outlet.topic() == topic)
    }
}

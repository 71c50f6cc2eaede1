//! Five hundred boxes, all of which move in every frame.

use super::random::Random;
use belvedere_sensors::Pose;
use glam::DVec3;

/// The number of boxes.
pub const COUNT: usize = 500;
/// Full edge lengths in metres.
pub const SIZE: [f64; 3] = [0.4, 0.3, 0.2];

/// The poses of the boxes.
pub struct MovingBoxes {
    random: Random,
    poses: Vec<Pose>,
}

impl MovingBoxes {
    pub fn new() -> Self {
        let mut boxes = Self { random: Random::new(500), poses: Vec::new() };
        for _ in 0..COUNT {
            let [x, y, z] = [40.0, 30.0, 6.0].map(|edge| boxes.random.range(-0.5, 0.5) * edge);
            let turn = [0; 3].map(|_| boxes.random.range(-3.0, 3.0));
            boxes.poses.push(Pose::from_xyz_rpy(DVec3::new(x, y, z), DVec3::from_array(turn)));
        }
        boxes
    }

    /// Moves each box by some centimetres.
    pub fn step(&mut self) -> &[Pose] {
        let by = DVec3::new(self.random.range(-0.05, 0.05), self.random.range(-0.05, 0.05), 0.0);
        for pose in &mut self.poses {
            *pose = Pose::new(pose.translation() + by, pose.rotation());
        }
        &self.poses
    }
}

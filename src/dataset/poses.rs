//! The robot's pose for each sample: listed, along a path, or random in a region without collisions.

use super::plan::{Plan, Sample};
use super::{DatasetError, studio::Studio};
use crate::description::Severity;
use crate::description::diagnostics::Problem;
use belvedere_sensors::Pose;

/// Number of attempts at a random pose.
const TRIES: u32 = 1000;

impl Plan {
    /// Returns the robot's pose for a sample, `world_from_robot`. `studio` must have the sample's world.
    pub(super) fn pose(&self, sample: Sample, studio: &mut Studio<'_>) -> Result<Pose, DatasetError> {
        let Sample { world, seed, pose, .. } = sample;
        if let Some(listed) = self.listed.get(pose as usize) {
            return Ok(*listed);
        }
        let number = pose - self.listed.len() as u64;
        let on_route = self.route.as_ref().map_or(0, |route| route.count);
        if let Some(route) = self.route.as_ref().filter(|_| number < on_route) {
            return Ok(route.pose(number));
        }
        let Some(random) = &self.random else { return Ok(Pose::IDENTITY) };
        for attempt in 0..TRIES {
            let pose = random.draw(self.seeds[seed], world, number - on_route, attempt);
            if studio.is_free(sample, &pose, random.clearance_m)? {
                return Ok(pose);
            }
        }
        let problem = Problem {
            severity: Severity::Error,
            source: random.source.clone(),
            what: format!(
                "no place for the robot in {TRIES} tries between {:?} and {:?} of the world '{}', with clearance_m = {}",
                random.xyz[0].to_array(),
                random.xyz[1].to_array(),
                self.world_names[world],
                random.clearance_m
            ),
            remedy: "make the region larger or the clearance smaller".into(),
        };
        Err(problem.into())
    }

    /// Returns the sample from which the optical flow of this one starts: the previous pose on the path.
    pub(super) fn before(&self, sample: Sample) -> Option<Sample> {
        let number = sample.pose.checked_sub(self.listed.len() as u64)?;
        let is_on_route = self.route.as_ref().is_some_and(|route| (1..route.count).contains(&number));
        is_on_route.then(|| Sample { index: sample.index - 1, pose: sample.pose - 1, ..sample })
    }
}

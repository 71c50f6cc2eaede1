//! [`StateStreams`]: the poses and velocities of all models and links, published while there are subscribers.

use super::shared_memory::SharedMemory;
use crate::entities::Entities;
use crate::rig::{Outlet, Owner, Rate};
use crate::world::physics::Physics;
use belvedere_bridge::payload::ModelState;
use belvedere_bridge::{Error, Kind, StreamSpec, Text};
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::{Duration, Instant};

/// Rate in Hz, the same as for the robot's own state.
const RATE_HZ: f64 = 50.0;
/// Most models that may be spawned in addition to those at the start.
pub(super) const MAX_SPAWNED_MODELS: usize = 64;
/// Most links of all spawned models together.
pub(super) const MAX_SPAWNED_LINKS: usize = 256;
/// Interval at which states are sent again to new subscribers while simulated time is paused.
const PAUSED_PERIOD: Duration = Duration::from_millis(100);

/// The two streams.
pub(super) struct StateStreams {
    models: Outlet,
    links: Outlet,
    rate: Rate,
    next: u64,
    sent: Instant,
    messages: Vec<ModelState>,
}

impl StateStreams {
    /// Opens both streams, with room for the current models and some more.
    ///
    /// # Errors
    /// Errors of the bridge.
    pub(super) fn open(sink: &SharedMemory, entities: &Entities, physics: &Physics) -> Result<Self, Error> {
        let links: usize = entities.iter().map(|(_, entity)| entity.model.links.len()).sum();
        let publisher = |topic, count| {
            // No history: states are sent only while there are subscribers, so the last one may be old.
            let spec = StreamSpec {
                buffer: 4,
                history: 0,
                ..StreamSpec::structs(topic, Kind::ModelStates, count).frame_id("world").rate_hz(RATE_HZ)
            };
            Outlet::open(sink, &spec, Owner::simulation(), false)
        };
        Ok(Self {
            models: publisher(StreamSpec::MODEL_STATES, entities.iter().count() + MAX_SPAWNED_MODELS)?,
            links: publisher(StreamSpec::LINK_STATES, links + MAX_SPAWNED_LINKS)?,
            rate: Rate::from_hz(RATE_HZ).unwrap_or(Rate::from_period_ns(physics.step_ns())),
            next: 0,
            sent: Instant::now(),
            messages: Vec::new(),
        })
    }

    /// Restarts the schedule.
    pub(super) fn restart(&mut self) {
        self.next = 0;
    }

    /// Sends the states that are due at a timestamp between the last two steps.
    pub(super) fn publish(&mut self, stamp_ns: u64, entities: &Entities, physics: &Physics) {
        if self.rate.stamp_ns(self.next) <= stamp_ns {
            while self.rate.stamp_ns(self.next) <= stamp_ns {
                self.next += 1;
            }
            self.send(stamp_ns, entities, physics);
        }
    }

    /// Sends the states again from time to time while simulated time is paused, for new subscribers.
    pub(super) fn repeat(&mut self, entities: &Entities, physics: &Physics) {
        if self.sent.elapsed() >= PAUSED_PERIOD {
            self.send(physics.time_ns(), entities, physics);
        }
    }

    /// Sends the current states to subscribers.
    pub(super) fn send(&mut self, stamp_ns: u64, entities: &Entities, physics: &Physics) {
        self.sent = Instant::now();
        if self.models.is_wanted() {
            self.messages.clear();
            self.messages.extend(entities.iter().map(|(id, entity)| {
                let pose = physics.world_from_model_at(id.index(), stamp_ns);
                state(&entity.name, &pose, physics.model_velocity(id.index()))
            }));
            self.models.send_structs(stamp_ns, &self.messages);
        }
        if self.links.is_wanted() {
            self.messages.clear();
            let mut name = String::new();
            for (id, entity) in entities.iter() {
                self.messages.extend(entity.model.links.iter().enumerate().map(|(number, link)| {
                    name.clear();
                    name.extend([entity.name.as_str(), "::", link.name.as_str()]);
                    let pose = physics.world_from_link_at(id.index(), number, stamp_ns);
                    state(&name, &pose, physics.link_velocity(id.index(), number))
                }));
            }
            self.links.send_structs(stamp_ns, &self.messages);
        }
    }
}

fn state(name: &str, pose: &Pose, (linear, angular): (DVec3, DVec3)) -> ModelState {
    ModelState {
        name: Text::cut(name),
        position: pose.translation().to_array(),
        orientation: pose.rotation().to_array(),
        linear: linear.to_array(),
        angular: angular.to_array(),
    }
}

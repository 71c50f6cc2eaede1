//! [`Mount`]: the pose of a sensor on its robot.

use super::{Opening, RigContext};
use crate::description::diagnostics::Severity;
use crate::description::model::{LinkIndex, Model, Sensor};
use crate::description::sensor_frames::optical_from_sensor;
use crate::description::text::vector;
use crate::world::physics::{ModelIndex, Physics};
use belvedere_bridge::FrameHeader;
use belvedere_sensors::Pose;
use glam::DVec3;

/// A pose on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mount {
    model: ModelIndex,
    link: LinkIndex,
    link_from_sensor: Pose,
}

impl Mount {
    /// Creates the mount at the sensor's own pose.
    pub(super) fn new(sensor: &Sensor, opening: &Opening<'_>) -> Self {
        Self { model: opening.id.index(), link: sensor.link, link_from_sensor: sensor.link_from_sensor }
    }

    /// Creates the mount of a camera. If the frame of its images is the optical frame of another link that faces the
    /// same way, the sensor is moved to that link, so that its images are correct in their frame. Gazebo leaves its
    /// Kinect (31, 12.5, 16) mm away from it, and `gazebo_compat` does the same.
    pub(super) fn of_picture(sensor: &Sensor, opening: &Opening<'_>, frame: &str) -> Self {
        let own = Self::new(sensor, opening);
        if opening.gazebo_compat {
            return own;
        }
        let moved = optical_mount(sensor, &opening.entity.model, frame)
            .map(|link_from_sensor| Self { link_from_sensor, ..own });
        if let Some(moved) = &moved {
            let offset = moved.link_from_sensor.translation() - own.link_from_sensor.translation();
            if offset.length() > 1e-9 {
                let away = vector(offset);
                let what = format!(
                    "sensor '{}' is moved by {away} m to '{frame}', the frame of its images",
                    sensor.name
                );
                let remedy = "give the sensor the frame's pose; --gazebo-compat leaves it at its own pose";
                opening.names.note(Severity::Note, &sensor.source, what, remedy);
            }
        }
        moved.unwrap_or(own)
    }

    /// Returns the pose of the sensor (x forward, z up) at the context's timestamp.
    pub(super) fn pose(&self, context: &RigContext<'_>) -> Pose {
        self.pose_at(context.physics, context.stamp_ns)
    }

    /// Returns the pose at an earlier time, which must be within physics' history.
    pub(super) fn pose_at(&self, physics: &Physics, time_ns: u64) -> Pose {
        physics.world_from_link_at(self.model, self.link, time_ns) * self.link_from_sensor
    }

    /// Returns the current velocity of the sensor in the world, in m/s.
    pub(super) fn velocity(&self, physics: &Physics) -> DVec3 {
        let (linear, turn) = physics.link_velocity(self.model, self.link);
        let world_from_link = physics.world_from_link(self.model, self.link);
        linear + turn.cross(world_from_link.transform_vector(self.link_from_sensor.translation()))
    }

    /// Writes the pose into a frame's header.
    pub(super) fn write(world_from_sensor: &Pose, header: &mut FrameHeader) {
        header.position = world_from_sensor.translation().to_array();
        header.orientation = world_from_sensor.rotation().to_array().map(|part| part as f32);
    }
}

/// Returns the sensor's pose in its link if it is moved to the optical frame `frame`, provided that it faces the same
/// way.
fn optical_mount(sensor: &Sensor, model: &Model, frame: &str) -> Option<Pose> {
    let named = model.link_named(frame)?;
    if named == sensor.link || model.rigid_root(named) != model.rigid_root(sensor.link) {
        return None;
    }
    let link_from_frame =
        model.links[sensor.link].model_from_link.inverse() * model.links[named].model_from_link;
    let moved = link_from_frame * optical_from_sensor();
    let looks_alike = moved.rotation().dot(sensor.link_from_sensor.rotation()).abs() > 1.0 - 1e-6;
    looks_alike.then(|| Pose::new(moved.translation(), sensor.link_from_sensor.rotation()))
}

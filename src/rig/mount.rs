//! Where on its robot a sensor sits.

use super::{Opening, RigContext};
use crate::description::diagnostics::Severity;
use crate::description::model::{LinkIndex, Model, Sensor};
use crate::description::sensor_frames::optical_from_sensor;
use crate::description::text::vector;
use crate::world::physics::{ModelIndex, Physics};
use belvedere_bridge::FrameHeader;
use belvedere_sensors::Pose;
use glam::DVec3;

/// A place on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mount {
    model: ModelIndex,
    link: LinkIndex,
    link_from_sensor: Pose,
}

impl Mount {
    /// The sensor's own place.
    pub(super) fn new(sensor: &Sensor, opening: &Opening<'_>) -> Self {
        Self { model: opening.id.index(), link: sensor.link, link_from_sensor: sensor.link_from_sensor }
    }

    /// The place of a camera. If its pictures name the optical frame of another link that looks the same way,
    /// the sensor sits there instead, so that what it publishes is true of the frame that it names; Gazebo's
    /// Kinect is off by (31, 12.5, 16) mm there, and stays so with `gazebo_compat`.
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
                    "sensor '{}' is put into the frame '{frame}' that its pictures name, {away} m from its own place",
                    sensor.name
                );
                let remedy = "give the sensor the frame's pose; --gazebo-compat leaves it in its own place";
                opening.names.note(Severity::Note, &sensor.source, what, remedy);
            }
        }
        moved.unwrap_or(own)
    }

    /// Pose of the sensor (x forward, z up) at the stamp of the context.
    pub(super) fn pose(&self, context: &RigContext<'_>) -> Pose {
        self.pose_at(context.physics, context.stamp_ns)
    }

    /// The same at an earlier time, as far back as physics remembers.
    pub(super) fn pose_at(&self, physics: &Physics, time_ns: u64) -> Pose {
        physics.world_from_link_at(self.model, self.link, time_ns) * self.link_from_sensor
    }

    /// Velocity of the sensor in the world now, in m/s.
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

/// The sensor's pose in its link if it sits in the optical frame `frame` and looks as it does now.
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

//! The true pose and velocity of a link with their stream: `libgazebo_ros_p3d.so`.

use super::channel::Channel;
use super::outlet::Outlet;
use super::{Opening, RigContext, RigError};
use crate::description::model::PosePlugin;
use crate::entities::EntityId;
use belvedere_bridge::payload::Odometry;
use belvedere_bridge::{Kind, StreamSpec, Text};
use belvedere_sensors::noise::{Stream, standard_normal};
use glam::DVec3;

/// Noise channel of its velocities.
const POSE_CHANNEL: u16 = 17;

/// The channel that publishes a link's true pose.
pub(super) struct TruePoseChannel {
    id: EntityId,
    plugin: PosePlugin,
    child: Text<64>,
    seed: u64,
    sensor: u32,
    odometry: Outlet,
}

impl TruePoseChannel {
    pub(super) fn open(plugin: &PosePlugin, opening: &Opening<'_>) -> Result<Self, RigError> {
        let link = &opening.entity.model.links[plugin.link].name;
        let child = opening.entity.frame(link);
        // The world's frame is shared by all models.
        let is_shared = matches!(plugin.frame.as_str(), "world" | "map");
        let spec = StreamSpec::structs(&plugin.topic, Kind::Odometry, 1).rate_hz(opening.rate.hz());
        Ok(Self {
            id: opening.id,
            child: Text::new(&child).map_err(|error| RigError::name(&child, &error))?,
            seed: opening.seed,
            sensor: opening.sensor,
            odometry: if is_shared {
                opening.open_in_world(&spec.frame_id(&plugin.frame))?
            } else {
                opening.open(&spec.frame_id(&plugin.frame))?
            },
            plugin: plugin.clone(),
        })
    }
}

impl Channel for TruePoseChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.odometry]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame: u64) {
        let RigContext { physics, stamp_ns, .. } = *context;
        let PosePlugin { link, offset, stddev, .. } = self.plugin;
        let model = self.id.index();
        let world_from_link = physics.world_from_link_at(model, link, stamp_ns);
        // As in the plugin, the offset is added along the axes of the frame, and its rotation is applied after the
        // link's.
        let pose = belvedere_sensors::Pose::new(
            world_from_link.translation() + offset.translation(),
            offset.rotation() * world_from_link.rotation(),
        );
        let (linear, turn) = physics.link_velocity(model, link);
        let stream = Stream { seed: self.seed, sensor: self.sensor, frame, channel: POSE_CHANNEL };
        let noise = |first: u32| {
            let axes = [0, 1, 2].map(|axis| f64::from(standard_normal(&stream, first + axis)));
            DVec3::from_array(axes) * stddev
        };
        let variance = stddev * stddev;
        let mut covariance = [0.0; 36];
        (0..6).for_each(|axis| covariance[axis * 7] = variance);
        self.odometry.send_structs(
            stamp_ns,
            &[Odometry {
                child_frame_id: self.child,
                position: pose.translation().to_array(),
                orientation: pose.rotation().to_array(),
                linear: (linear + noise(0)).to_array(),
                angular: (turn + noise(3)).to_array(),
                pose_covariance: covariance,
                twist_covariance: covariance,
            }],
        );
    }
}

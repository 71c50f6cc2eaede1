//! A logical camera with its stream.

use super::behaviour::Behaviour;
use super::channel::Channel;
use super::mount::Mount;
use super::outlet::Outlet;
use super::report::Say;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, InstrumentPlugin, Sensor};
use crate::description::text::number;
use crate::entities::EntityId;
use belvedere_bridge::payload::SeenModel;
use belvedere_bridge::{Kind, StreamSpec, Text};
use belvedere_sensors::Pose;
use glam::DVec3;

/// The most models in a frame.
const MOST_MODELS: usize = 256;

impl Behaviour for model::LogicalCamera {
    fn name(&self) -> &'static str {
        "logical camera"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(LogicalChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        say("distance", format!("{} to {} m", number(self.near_m), number(self.far_m)));
        let [across, down] = angles(self).map(|half_rad| number((2.0 * half_rad).to_degrees()));
        say("angles", format!("{across}° across, {down}° down"));
    }
}

/// Returns half of the horizontal and of the vertical angle of a camera in rad.
fn angles(camera: &model::LogicalCamera) -> [f64; 2] {
    let across = 0.5 * camera.horizontal_fov_rad;
    [across, libm::atan(libm::tan(across) / camera.aspect_ratio)]
}

/// Returns the six planes of a camera, each as a normal that points into the frustum, and its distance from the sensor.
fn planes(camera: &model::LogicalCamera) -> [(DVec3, f64); 6] {
    let [(across_sin, across_cos), (down_sin, down_cos)] = angles(camera).map(libm::sincos);
    [
        (DVec3::X, camera.near_m),
        (DVec3::NEG_X, -camera.far_m),
        (DVec3::new(across_sin, across_cos, 0.0), 0.0),
        (DVec3::new(across_sin, -across_cos, 0.0), 0.0),
        (DVec3::new(down_sin, 0.0, down_cos), 0.0),
        (DVec3::new(down_sin, 0.0, -down_cos), 0.0),
    ]
}

/// A running camera.
struct LogicalChannel {
    id: EntityId,
    mount: Mount,
    planes: [(DVec3, f64); 6],
    /// True if a name or the number of models was too great for a message and that was told.
    has_told: bool,
    seen: Vec<SeenModel>,
    models: Outlet,
}

impl LogicalChannel {
    fn open(
        sensor: &Sensor,
        camera: &model::LogicalCamera,
        plugin: &InstrumentPlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let (topic, frame) = opening.names(sensor, plugin);
        let spec = StreamSpec::structs(&topic, Kind::SeenModels, MOST_MODELS).frame_id(&frame);
        let spec = StreamSpec { buffer: 4, ..spec };
        Ok(Self {
            id: opening.id,
            mount: Mount::new(sensor, opening),
            planes: planes(camera),
            has_told: false,
            seen: Vec::with_capacity(MOST_MODELS),
            models: opening.open(&spec.rate_hz(opening.rate.hz()))?,
        })
    }

    /// Returns true if a box in the world is not beyond one of the planes.
    fn sees(&self, world_from_sensor: &Pose, [least, greatest]: [DVec3; 2]) -> bool {
        let (middle, half) = ((least + greatest) * 0.5, (greatest - least) * 0.5);
        let middle = world_from_sensor.inverse().transform_point(middle);
        self.planes.iter().all(|(normal, distance)| {
            let reach = world_from_sensor.transform_vector(*normal).abs().dot(half);
            normal.dot(middle) + reach >= *distance
        })
    }

    fn tell(&mut self, what: &str) {
        if !std::mem::replace(&mut self.has_told, true) {
            tracing::warn!(topic = self.models.topic(), "{what}");
        }
    }
}

impl Channel for LogicalChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.models]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, _frame: u64) {
        let RigContext { physics, entities, stamp_ns, .. } = *context;
        let world_from_sensor = self.mount.pose(context);
        let sensor_from_world = world_from_sensor.inverse();
        self.seen.clear();
        let own = self.id;
        for (id, entity) in entities.iter().filter(|(id, _)| *id != own) {
            let world_from_model = physics.world_from_model_at(id.index(), stamp_ns);
            let bounds = physics.bounds(id.index()).unwrap_or([world_from_model.translation(); 2]);
            if !self.sees(&world_from_sensor, bounds) {
                continue;
            }
            let name = Text::cut(&entity.name);
            if name.as_str() != entity.name {
                self.tell(&format!("the name '{}' has more than 127 bytes and is cut", entity.name));
            }
            let pose = sensor_from_world * world_from_model;
            let (position, orientation) = (pose.translation().to_array(), pose.rotation().to_array());
            self.seen.push(SeenModel { name, position, orientation });
        }
        if self.seen.len() > MOST_MODELS {
            self.tell(&format!("{} models: a frame has the {MOST_MODELS} nearest", self.seen.len()));
            let distance = |seen: &SeenModel| DVec3::from(seen.position).length();
            self.seen.sort_by(|one, other| distance(one).total_cmp(&distance(other)));
            self.seen.truncate(MOST_MODELS);
        }
        self.models.send_structs(stamp_ns, &self.seen);
    }
}

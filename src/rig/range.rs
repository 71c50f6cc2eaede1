//! A rangefinder with its stream: the nearest of the beams that fill its cone.

use super::behaviour::Behaviour;
use super::channel::{Channel, is_any_wanted};
use super::lidar::{lidar_config, report};
use super::mount::Mount;
use super::outlet::Outlet;
use super::pictures::noise;
use super::report::Say;
use super::{Opening, RigContext, RigError, Settings};
use crate::description::model::{self, Noise, Radiation, RangePlugin, RaySensor, ScanAxis, Sensor};
use crate::description::text::angle;
use belvedere_bridge::payload::Range;
use belvedere_bridge::{Kind, StreamSpec};
use belvedere_sensors::lidar::{Lidar, Scan};
use belvedere_sensors::noise::{GaussianNoise, Stream, standard_normal};
use belvedere_sensors::{Capture, Pose, Shutter};
use glam::DVec3;

/// Noise channel of the range. It is the channel of a lidar's ranges, which have no noise here.
const RANGE_CHANNEL: u16 = 2;

impl Behaviour for model::Rangefinder {
    fn name(&self) -> &'static str {
        "rangefinder"
    }

    fn open(&self, sensor: &Sensor, opening: &Opening<'_>) -> Result<Option<Box<dyn Channel>>, RigError> {
        let Some(plugin) = &self.plugin else { return Ok(None) };
        Ok(Some(Box::new(RangeChannel::open(sensor, self, plugin, opening)?)))
    }

    fn settings(&self, rate_hz: f64) -> Settings {
        Settings::new(rate_hz).noise_of_ranges(&self.ray)
    }

    fn report(&self, _gazebo_compat: bool, say: Say<'_>) {
        report::ray(&self.ray, say);
        let Some(plugin) = &self.plugin else { return };
        let radiation = match plugin.radiation {
            Radiation::Ultrasound => "ultrasound",
            Radiation::Infrared => "infrared",
        };
        say("cone", format!("{} of {radiation}", angle(plugin.field_of_view_rad)));
    }
}

/// A running rangefinder.
pub(super) struct RangeChannel {
    /// Without noise, because the sensor's noise is added to the nearest range.
    lidar: Lidar,
    noise: GaussianNoise,
    /// Without a return, Gazebo reports the largest range instead of +∞ (REP-117).
    gazebo_compat: bool,
    mount: Mount,
    range: Outlet,
    message: Range,
    ranges: Vec<f32>,
    /// For each range, whether it is in the cone; `None` if all are.
    counts: Option<Vec<bool>>,
    sensor_from_beams: Pose,
}

impl RangeChannel {
    pub(super) fn open(
        sensor: &Sensor,
        rangefinder: &model::Rangefinder,
        plugin: &RangePlugin,
        opening: &Opening<'_>,
    ) -> Result<Self, RigError> {
        let refused = |error: &dyn std::error::Error| RigError::sensor(sensor, error);
        let ray = &rangefinder.ray;
        let exact = RaySensor { noise: Noise::default(), ..ray.clone() };
        let config = lidar_config(&exact, opening).map_err(|error| refused(&error))?;
        let lidar = Lidar::new(config).map_err(|error| refused(&error))?;
        let frame = opening.frame_id(sensor, &plugin.frame_name);
        let spec = StreamSpec::structs(&plugin.topic, Kind::Range, 1);
        Ok(Self {
            noise: noise(&ray.noise).map_err(|error| refused(&error))?,
            gazebo_compat: opening.gazebo_compat,
            mount: Mount::new(sensor, opening),
            range: opening.open_rendered(spec.frame_id(&frame).rate_hz(opening.rate.hz()))?,
            message: Range {
                radiation_type: match plugin.radiation {
                    Radiation::Ultrasound => Range::ULTRASOUND,
                    Radiation::Infrared => Range::INFRARED,
                },
                field_of_view: plugin.field_of_view_rad as f32,
                min_range: ray.range_min_m as f32,
                max_range: ray.range_max_m as f32,
                range: f32::NAN,
            },
            counts: rangefinder.cone_rad.map(|half| beams_within(ray, half)),
            sensor_from_beams: Pose::new(DVec3::ZERO, rangefinder.sensor_from_beams),
            ranges: vec![0.0; lidar.beams()],
            lidar,
        })
    }

    /// Adds noise to a range, if there is one, and clamps it to the limits.
    fn measured(&self, nearest: f32, frame: u64) -> f32 {
        let Range { min_range, max_range, .. } = self.message;
        if !nearest.is_finite() {
            return if self.gazebo_compat { max_range } else { nearest };
        }
        if self.noise.is_none() {
            return nearest;
        }
        let config = self.lidar.config();
        let (seed, sensor) = (config.seed, config.sensor);
        let stream = Stream { seed, sensor, frame, channel: RANGE_CHANNEL };
        let bias = self.noise.bias(seed, sensor, 0);
        self.noise.apply(nearest, bias, standard_normal(&stream, 0)).clamp(min_range, max_range)
    }
}

impl Channel for RangeChannel {
    fn outlets(&self) -> Vec<&Outlet> {
        vec![&self.range]
    }

    fn publish(&mut self, context: &mut RigContext<'_>, frame_number: u64) {
        if !self.range.is_wanted() {
            return;
        }
        let world_from_beams = self.mount.pose(context) * self.sensor_from_beams;
        let at = Shutter::Global(context.scene.moment(world_from_beams));
        if !context.take(&self.lidar, &Capture::new(frame_number, at), Scan::new().ranges(&mut self.ranges)) {
            return;
        }
        // −∞, for an object that is too near, is the nearest of all.
        let ranges = self.ranges.iter().copied().enumerate();
        let counts = |index: usize| self.counts.as_ref().is_none_or(|counts| counts[index]);
        let nearest =
            ranges.filter(|(beam, _)| counts(*beam)).map(|(_, range)| range).fold(f32::INFINITY, f32::min);
        let range = self.measured(nearest, frame_number);
        self.range.send_structs(context.stamp_ns, &[Range { range, ..self.message }]);
    }

    fn is_rendered(&self) -> bool {
        is_any_wanted(self.outlets())
    }

    fn configure(&mut self, settings: &Settings) -> Result<(), Box<dyn std::error::Error>> {
        self.noise = settings.noise(&self.noise)?;
        Ok(())
    }
}

/// Returns for each beam, layer by layer, whether it is within `half_rad` of the middle.
fn beams_within(ray: &RaySensor, half_rad: f64) -> Vec<bool> {
    let angle = |axis: &ScanAxis, sample: u32| {
        let steps = f64::from(axis.samples.saturating_sub(1).max(1));
        axis.min_angle_rad + (axis.max_angle_rad - axis.min_angle_rad) * f64::from(sample) / steps
    };
    let layers = (0..ray.vertical.samples).map(|layer| angle(&ray.vertical, layer));
    let within = |up: f64, left: f64| up.cos() * left.cos() >= half_rad.cos() - 1e-9;
    layers
        .flat_map(|up| (0..ray.horizontal.samples).map(move |beam| within(up, angle(&ray.horizontal, beam))))
        .collect()
}

//! Lidars: `<ray>` and `<lidar>` (angles of the beams, range, noise), and the plugins that publish scans.

mod beams;
mod physics;
mod profile;
mod ray_sensor;

use super::gz::{frame_name, gz_topic};
use super::imu_profile::ImuProfile;
use super::instrument::{InstrumentPlugin, ros2_names};
use super::plugin::{extension, plain_name, topic};
use super::reader::Reader;
use super::{Kind, Sensor, SensorKind};
use crate::diagnostics::Diagnostics;
use crate::model::{CloudLayout, LaserPlugin, Noise, RaySensor, ScanAxis};
use crate::values::{child_bool, child_text};
use crate::xml::Element;
use belvedere_sensors::scanner::presets::{self, Maker, Mode, Preset};
use belvedere_sensors::scanner::{Axis, Columns, Pattern, Raster, Weather};
pub use physics::BeamPhysics;
pub use profile::PacketProfile;
use std::f64::consts::{PI, TAU};

/// A lidar.
#[derive(Debug, Clone, PartialEq)]
pub struct Lidar {
    /// Its beams. For a preset, the even grid that is nearest to its beams, with the preset's ranges and noise.
    pub ray: RaySensor,
    /// The device that it is, if it has a preset.
    pub preset: Option<Preset>,
    /// Beam width, returns and receiver, if each beam has its own time.
    pub physics: BeamPhysics,
    /// The layout of its packets, if its maker has several.
    pub profile: PacketProfile,
    /// The layout of its inertial unit's packets, which its metadata names.
    pub imu_profile: ImuProfile,
    /// The plugin that publishes it.
    pub plugin: Option<LaserPlugin>,
}

impl Lidar {
    /// Returns true if each beam has its own time.
    pub fn is_scanner(&self) -> bool {
        self.preset.is_some() || self.plugin.as_ref().is_some_and(|plugin| plugin.cloud.is_some())
    }
}

pub(super) const KIND: Kind = Kind {
    types: &["ray", "gpu_ray", "lidar", "gpu_lidar"],
    plugins: &[
        "gazebo_ros_laser",
        "gazebo_ros_gpu_laser",
        "gazebo_ros_block_laser",
        "gazebo_ros_velodyne_laser",
        "gazebo_ros_velodyne_gpu_laser",
        "gazebo_ros_ray_sensor",
    ],
    is_extended: true,
    read: |reader, sensor| reader.lidar(sensor).map(SensorKind::Ray),
};

impl Reader<'_> {
    fn lidar(&mut self, sensor: &Element) -> Option<Lidar> {
        let preset = self.scanner_preset(sensor)?;
        let (physics, profile) = self.beam_physics(sensor, preset.as_ref())?;
        let is_cloud = preset.as_ref().is_some_and(is_cloud);
        let mut ray = match &preset {
            Some(preset) => {
                let visibility_mask = self.visibility_mask(sensor, sensor)?;
                RaySensor { visibility_mask, ..ray_of(preset, sensor) }
            }
            None => self.ray(sensor)?,
        };
        let mut plugin = match self.plugin(sensor, &KIND) {
            Some(plugin) => Some(self.laser_plugin(plugin, &mut ray)?),
            None => gz_plugin(sensor, preset.as_ref()),
        };
        if let (true, Some(plugin)) = (is_cloud, &mut plugin) {
            plugin.cloud.get_or_insert_default();
        }
        let is_ouster = preset.as_ref().is_some_and(|preset| preset.maker == Maker::Ouster);
        let imu_profile = self.imu_profile(sensor, is_ouster)?.unwrap_or_default();
        let lidar = Lidar { ray, preset, physics, profile, imu_profile, plugin };
        self.check_physics(sensor, &lidar)?;
        Some(lidar)
    }

    /// Reads `<plugin filename="belvedere"><preset>`; the inner none means that there is none.
    #[expect(clippy::option_option, reason = "outer: readable; inner: there")]
    fn scanner_preset(&mut self, sensor: &Element) -> Option<Option<Preset>> {
        let Some(own) = extension(sensor) else { return Some(None) };
        let names = || {
            ["preset", "columns", "udp_profile_lidar", "udp_profile_imu"].into_iter().chain(physics::NAMES)
        };
        let remedy = format!("remove it: a lidar has {}", names().collect::<Vec<_>>().join(", "));
        self.left_out(own, |name| names().any(|known| known == name), &remedy);
        if child_text(own, "preset").is_none() {
            return Some(None);
        }
        self.preset_name(own, &presets::NAMES).map(presets::named)
    }

    /// Checks that the beam parameters fit the rest of the lidar.
    fn check_physics(&mut self, sensor: &Element, lidar: &Lidar) -> Option<()> {
        let Some(own) = extension(sensor) else { return Some(()) };
        let wrong = |reader: &mut Self, name: &str, what: &str, remedy: &str| {
            let what = format!("{} {what}", reader.what(name));
            reader.diagnostics.error(Self::place(Some(own), name, own), what, remedy);
            None
        };
        let written = physics::NAMES.into_iter().find(|name| own.child(name).is_some());
        if let (Some(name), false) = (written, lidar.is_scanner()) {
            let remedy = "write a <preset>, or publish it by libgazebo_ros_velodyne_laser.so";
            return wrong(self, name, "only applies to scanners, and this lidar is Gazebo's", remedy);
        }
        let is_scan = lidar.plugin.as_ref().is_some_and(|plugin| plugin.cloud.is_none());
        if is_scan && lidar.physics.returns.count() > 1 {
            let remedy =
                "write strongest, first, last or mean, or publish clouds by libgazebo_ros_velodyne_laser.so";
            return wrong(self, "returns", "requests several returns, but a scan has one per ray", remedy);
        }
        let BeamPhysics { receiver, weather, .. } = lidar.physics;
        if weather != Weather::CLEAR && receiver.is_none() && lidar.ray.range_max_m == f64::INFINITY {
            let name = ["fog_visibility", "rain_rate", "snow_rate"]
                .into_iter()
                .find(|name| own.child(name).is_some());
            let remedy = "write <receiver_reach> in metres, or a <max> of <range> that is finite";
            return wrong(
                self,
                name.unwrap_or_default(),
                "is weather, and this lidar has an infinite range",
                remedy,
            );
        }
        Some(())
    }

    /// What it does to what the sensor measures becomes the sensor's.
    fn laser_plugin(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<LaserPlugin> {
        let name = plain_name(plugin);
        if name == "gazebo_ros_ray_sensor" {
            return self.ray_sensor_plugin(plugin);
        }
        let is_velodyne = name.starts_with("gazebo_ros_velodyne");
        // Hokuyo's plugin adds no noise of its own.
        if !matches!(name, "gazebo_ros_laser" | "gazebo_ros_gpu_laser") {
            self.add_noise(plugin, ray)?;
        }
        let mut cloud = None;
        if is_velodyne {
            cloud = Some(CloudLayout {
                is_organized: child_bool(plugin, "organize_cloud", self.diagnostics).unwrap_or(false),
                min_intensity: self.number(Some(plugin), "min_intensity", f64::NEG_INFINITY)?,
            });
            ray.range_min_m = ray.range_min_m.max(self.not_negative(Some(plugin), "min_range")?);
            if plugin.child("max_range").is_some() {
                ray.range_max_m = ray.range_max_m.min(self.number(Some(plugin), "max_range", 0.0)?);
            }
            if ray.range_min_m >= ray.range_max_m {
                self.diagnostics.error(
                    Self::place(Some(plugin), "min_range", plugin),
                    format!(
                        "sensor '{}' and its plugin leave the ranges from {} to {} m",
                        self.sensor, ray.range_min_m, ray.range_max_m
                    ),
                    "write <min_range> below <max_range> and below the sensor's own <max>",
                );
                return None;
            }
        }
        if is_velodyne && (plugin.child("ros").is_some() || plugin.child("frame_name").is_some()) {
            let InstrumentPlugin { topic, frame_name } = ros2_names(plugin);
            return Some(LaserPlugin { topic, frame_name, cloud, points_topic: None });
        }
        self.plugin_rate_hz = self.rate(plugin, "updateRate")?;
        Some(LaserPlugin {
            topic: topic(plugin, "", "topicName", if is_velodyne { "/points" } else { "/world" }),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
            cloud,
            points_topic: None,
        })
    }

    /// `gaussianNoise` of a plugin: both noises are drawn, each for itself.
    pub(super) fn add_noise(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<()> {
        let stddev = self.not_negative(Some(plugin), "gaussianNoise")?;
        ray.noise.stddev = libm::hypot(ray.noise.stddev, stddev);
        Some(())
    }
}

/// Checks that a preset has the columns and the rate in the file, and selects that mode; without them the default mode.
pub(super) fn turn(read: &mut Sensor, sensor: &Element, diagnostics: &mut Diagnostics) -> Option<()> {
    let rate_hz = read.effective_rate_hz();
    let SensorKind::Ray(Lidar { preset: Some(preset), ray, .. }) = &mut read.kind else { return Some(()) };
    let own = extension(sensor);
    let columns = own.and_then(|own| child_text(own, "columns"));
    // 0 columns do not exist.
    let count = columns.as_ref().map(|columns| columns.parse().unwrap_or(0));
    if let Some(chosen) = preset.in_mode(count, rate_hz) {
        ray.horizontal = horizontal_of(&chosen);
        if rate_hz.is_none() {
            read.update_rate_hz = Some(chosen.rate_hz);
        }
        *preset = chosen;
        return Some(());
    }
    let place = match columns {
        Some(_) => Reader::place(own, "columns", sensor),
        None => Reader::place(Some(sensor), "update_rate", sensor),
    };
    let written =
        [columns.map(|columns| ("columns", columns)), rate_hz.map(|rate| ("update_rate", rate.to_string()))];
    let what = written
        .into_iter()
        .flatten()
        .map(|(name, value)| format!("<{name}> of sensor '{}' is {value}", read.name));
    let what = what.collect::<Vec<_>>().join(", ");
    let remedy = match preset.modes {
        [] => format!(
            "write a rate from {} Hz, or none for {} Hz, and no <columns>",
            choices(preset),
            preset.rate_hz
        ),
        _ => format!("choose from {}", choices(preset)),
    };
    diagnostics.error(place, format!("{what}, which is not a mode of {}", preset.name), remedy);
    None
}

/// Returns the rates and numbers of columns that a preset supports.
pub fn choices(preset: &Preset) -> String {
    let [slowest, fastest] = preset.rates_hz;
    if preset.modes.is_empty() {
        return format!("{slowest} to {fastest}");
    }
    let mode = |mode: &Mode| format!("{} columns at {} Hz", mode.columns.at_angles(), mode.rate_hz);
    preset.modes.iter().map(mode).collect::<Vec<_>>().join(", ")
}

/// Returns true for Gazebo's GPU lidars.
fn sees_visuals(sensor: &Element) -> bool {
    matches!(sensor.attribute("type"), Some("gpu_ray" | "gpu_lidar"))
}

/// Returns the plugin that stands for gz-sim's publishing: the scan, and its points on a topic of their own. A preset
/// publishes one of the two.
fn gz_plugin(sensor: &Element, preset: Option<&Preset>) -> Option<LaserPlugin> {
    let topic = gz_topic(sensor)?;
    let points = format!("{topic}/points");
    let (topic, points_topic) = match preset {
        None => (topic, Some(points)),
        Some(preset) if is_cloud(preset) => (points, None),
        Some(_) => (topic, None),
    };
    Some(LaserPlugin { topic, frame_name: frame_name(sensor), cloud: None, points_topic })
}

/// Returns true if a preset measures in space rather than in a plane.
fn is_cloud(preset: &Preset) -> bool {
    !matches!(preset.pattern, Pattern::Spinning(head) if head.lasers.len() == 1)
}

/// Returns the azimuths at which a preset measures.
fn horizontal_of(preset: &Preset) -> ScanAxis {
    let whole = |samples| ScanAxis { samples, min_angle_rad: -PI, max_angle_rad: PI };
    let head = match preset.pattern {
        Pattern::Spinning(head) => head,
        Pattern::Raster(raster) => return pixels_of(&raster, 0),
        Pattern::Rosette(rosette) => {
            let most = rosette.half_angle_rad().unwrap_or(0.0);
            let samples = (1e9 / preset.rate_hz / rosette.firing_time_ns as f64) as u32;
            return ScanAxis { samples, min_angle_rad: -most, max_angle_rad: most };
        }
        Pattern::Prisms(prisms) => {
            let samples = (1e9 / preset.rate_hz / f64::from(prisms.volley_time_ns)) as u32;
            if prisms.axis == Axis::Up {
                return whole(samples);
            }
            let most = prisms.half_angle_rad();
            return ScanAxis { samples, min_angle_rad: -most, max_angle_rad: most };
        }
        _ => return whole(1),
    };
    match head.columns {
        Columns::Every { time_ns } => whole((1e9 / preset.rate_hz / time_ns as f64) as u32),
        Columns::Turn { per_turn, count, .. } if per_turn == count => whole(count),
        Columns::Turn { per_turn, first, count } => {
            let step = TAU / f64::from(per_turn);
            let min_angle_rad = head.first_azimuth_rad + f64::from(first) * step;
            let max_angle_rad = min_angle_rad + f64::from(count - 1) * step;
            ScanAxis { samples: count, min_angle_rad, max_angle_rad }
        }
    }
}

/// Returns the angles of the pixel centres, across or up.
fn pixels_of(raster: &Raster, axis: usize) -> ScanAxis {
    let [most, _] = raster.angles(axis);
    ScanAxis { samples: raster.pixels[axis], min_angle_rad: -most, max_angle_rad: most }
}

/// Returns the beams, ranges and noise of a preset.
fn ray_of(preset: &Preset, sensor: &Element) -> RaySensor {
    let mut vertical = ScanAxis { samples: 1, min_angle_rad: 0.0, max_angle_rad: 0.0 };
    if let Pattern::Spinning(head) = preset.pattern {
        let elevations = || head.lasers.iter().map(|laser| laser.elevation_rad);
        vertical.samples = head.lasers.len() as u32;
        vertical.min_angle_rad = elevations().fold(f64::INFINITY, f64::min);
        vertical.max_angle_rad = elevations().fold(f64::NEG_INFINITY, f64::max);
    }
    if let Pattern::Raster(raster) = &preset.pattern {
        vertical = pixels_of(raster, 1);
    }
    let [range_min_m, range_max_m] = preset.range_m;
    RaySensor {
        sees_visuals: sees_visuals(sensor),
        visibility_mask: u32::MAX,
        horizontal: horizontal_of(preset),
        vertical,
        range_min_m,
        range_max_m,
        range_resolution_m: 0.0,
        noise: Noise {
            stddev: preset.stddev_m,
            bias_stddev: preset.bias_stddev_m,
            precision: preset.resolution_m,
            ..Noise::default()
        },
    }
}

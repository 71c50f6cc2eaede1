//! Lidars: `<ray>` and `<lidar>` (angles of the beams, range, noise), and the plugins that publish scans.

use super::gz::{frame_name, gz_topic};
use super::plugin::{plain_name, topic};
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::description::model::{LaserPlugin, RaySensor, ScanAxis};
use crate::description::values::child_text;
use crate::description::xml::Element;
use belvedere_sensors::lidar::{MAX_BEAMS, MAX_SAMPLES};

/// A lidar.
#[derive(Debug, Clone, PartialEq)]
pub struct Lidar {
    /// Its beams.
    pub ray: RaySensor,
    /// What publishes it.
    pub plugin: Option<LaserPlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["ray", "gpu_ray", "lidar", "gpu_lidar"],
    plugins: &[
        "gazebo_ros_laser",
        "gazebo_ros_gpu_laser",
        "gazebo_ros_block_laser",
        "gazebo_ros_velodyne_laser",
        "gazebo_ros_velodyne_gpu_laser",
    ],
    is_extended: false,
    read: |reader, sensor| reader.lidar(sensor).map(SensorKind::Ray),
};

impl Reader<'_> {
    fn lidar(&mut self, sensor: &Element) -> Option<Lidar> {
        let mut ray = self.ray(sensor)?;
        let plugin = self.plugin(sensor, &KIND).and_then(|plugin| self.laser_plugin(plugin, &mut ray));
        let of_gz = || Some(LaserPlugin { topic: gz_topic(sensor)?, frame_name: frame_name(sensor) });
        Some(Lidar { ray, plugin: plugin.or_else(of_gz) })
    }

    /// The `<ray>` or `<lidar>` of a sensor.
    pub(super) fn ray(&mut self, sensor: &Element) -> Option<RaySensor> {
        let ray = sensor.child("ray").or_else(|| sensor.child("lidar"));
        let scan = ray.and_then(|ray| ray.child("scan"));
        let horizontal = self.axis(scan, "horizontal", 640);
        let vertical = self.axis(scan, "vertical", 1);
        let range = ray.and_then(|ray| ray.child("range"));
        let limits = self.range(range, sensor);
        let resolution = self.not_negative(range, "resolution");
        let noise = self.noise(ray);

        let (horizontal, vertical) = (horizontal?, vertical?);
        let beams = u64::from(horizontal.samples) * u64::from(vertical.samples);
        if beams > u64::from(MAX_BEAMS) {
            self.diagnostics.error(
                Self::place(ray, "scan", sensor),
                format!(
                    "sensor '{}' has {} × {} = {beams} beams",
                    self.sensor, horizontal.samples, vertical.samples
                ),
                format!("write fewer <samples>: at most {MAX_BEAMS} beams in all"),
            );
            return None;
        }
        let (range_min_m, range_max_m) = limits?;
        Some(RaySensor {
            sees_visuals: matches!(sensor.attribute("type"), Some("gpu_ray" | "gpu_lidar")),
            horizontal,
            vertical,
            range_min_m,
            range_max_m,
            range_resolution_m: resolution?,
            noise: noise?,
        })
    }

    fn axis(&mut self, scan: Option<&Element>, name: &str, default_samples: u32) -> Option<ScanAxis> {
        let axis = scan.and_then(|scan| scan.child(name));
        let samples = self.truncated(axis, "samples", default_samples, MAX_SAMPLES);
        let min = self.number(axis, "min_angle", 0.0);
        let max = self.number(axis, "max_angle", 0.0);
        let (samples, min_angle_rad, max_angle_rad) = (samples?, min?, max?);
        if min_angle_rad > max_angle_rad {
            if let Some(axis) = axis {
                self.diagnostics.warning(
                    Self::place(Some(axis), "min_angle", axis),
                    format!(
                        "{} is {min_angle_rad} and <max_angle> is {max_angle_rad} (<{name}>): they are exchanged",
                        self.what("min_angle")
                    ),
                    "write <min_angle> not above <max_angle>",
                );
            }
            return Some(ScanAxis { samples, min_angle_rad: max_angle_rad, max_angle_rad: min_angle_rad });
        }
        Some(ScanAxis { samples, min_angle_rad, max_angle_rad })
    }

    /// Smallest and largest range; the largest may be `inf`.
    fn range(&mut self, range: Option<&Element>, sensor: &Element) -> Option<(f64, f64)> {
        let min = self.not_negative(range, "min");
        let is_infinite = range
            .and_then(|range| child_text(range, "max"))
            .is_some_and(|text| matches!(text.to_ascii_lowercase().as_str(), "inf" | "+inf" | "infinity"));
        let max = if is_infinite { Some(f64::INFINITY) } else { self.number(range, "max", 0.0) };
        let (min, max) = (min?, max?);
        if min < max {
            return Some((min, max));
        }
        self.diagnostics.error(
            Self::place(range, "max", sensor),
            format!("the <range> of sensor '{}' has <min> {min} and <max> {max}", self.sensor),
            "write <range><min> below <max>, in metres; <max> may be inf",
        );
        None
    }

    /// What it does to what the sensor measures becomes the sensor's.
    fn laser_plugin(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<LaserPlugin> {
        let name = plain_name(plugin);
        // Hokuyo's plugin leaves noise to the sensor.
        if !matches!(name, "gazebo_ros_laser" | "gazebo_ros_gpu_laser") {
            self.add_noise(plugin, ray)?;
        }
        if name.starts_with("gazebo_ros_velodyne") {
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
        self.plugin_rate_hz = self.rate(plugin, "updateRate")?;
        Some(LaserPlugin {
            topic: topic(plugin, "", "topicName", "/world"),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
        })
    }

    /// `gaussianNoise` of a plugin: both noises are drawn, each for itself.
    pub(super) fn add_noise(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<()> {
        let stddev = self.not_negative(Some(plugin), "gaussianNoise")?;
        ray.noise.stddev = libm::hypot(ray.noise.stddev, stddev);
        Some(())
    }
}

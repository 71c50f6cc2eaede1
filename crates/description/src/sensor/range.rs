//! Rangefinders, which report the nearest hit of a cone of beams: `<ray>` with `libgazebo_ros_range.so` or Team Hector's plugin,
//! and `<sonar>`.

use super::gz::{frame_name, gz_topic};
use super::plugin::{plain_name, topic};
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::model::{Noise, Radiation, RangePlugin, RaySensor, ScanAxis};
use crate::values::child_text;
use crate::xml::Element;
use glam::DQuat;
use std::f64::consts::FRAC_PI_2;

/// Beams across a sonar's cone: the spacing is a twentieth of the cone.
const SONAR_BEAMS: u32 = 21;

/// A sonar or infrared rangefinder.
#[derive(Debug, Clone, PartialEq)]
pub struct Rangefinder {
    /// The beams that fill its cone.
    pub ray: RaySensor,
    /// Half the angle of a round cone outside which beams are ignored; none if all count.
    pub cone_rad: Option<f64>,
    /// Orientation of the beams in the sensor: those of a sonar point along its −z.
    pub sensor_from_beams: DQuat,
    /// The plugin that publishes it.
    pub plugin: Option<RangePlugin>,
}

pub(super) const KIND: Kind = Kind {
    types: &["ray", "gpu_ray", "sonar"],
    plugins: &["gazebo_ros_range", "hector_gazebo_ros_sonar"],
    is_extended: false,
    read: |reader, sensor| reader.rangefinder(sensor).map(SensorKind::Range),
};

impl Reader<'_> {
    fn rangefinder(&mut self, sensor: &Element) -> Option<Rangefinder> {
        if sensor.attribute("type") == Some("sonar") {
            return self.sonar(sensor);
        }
        let mut ray = self.ray(sensor)?;
        let plugin = self.publisher(sensor, &mut ray);
        Some(Rangefinder { ray, cone_rad: None, sensor_from_beams: DQuat::IDENTITY, plugin })
    }

    fn publisher(&mut self, sensor: &Element, ray: &mut RaySensor) -> Option<RangePlugin> {
        let plugin = self.plugin(sensor, &KIND)?;
        match plain_name(plugin) {
            "hector_gazebo_ros_sonar" => self.hector_sonar(plugin, ray),
            _ => self.range_plugin(plugin, ray),
        }
    }

    /// Reads `<sonar>`: a cone from the sensor along its −z with the given radius at its end.
    fn sonar(&mut self, sensor: &Element) -> Option<Rangefinder> {
        let sonar = sensor.child("sonar");
        let min = self.not_negative(sonar, "min");
        let max = self.checked(sonar, "max", 1.0, |max| max > 0.0, "write metres above 0");
        let radius = self.checked(sonar, "radius", 0.5, |radius| radius > 0.0, "write metres above 0");
        if let Some(geometry) = sonar.and_then(|sonar| sonar.child("geometry"))
            && geometry.text() != "cone"
        {
            let what = format!("{} is '{}': a cone is simulated", self.what("geometry"), geometry.text());
            self.diagnostics.warning(&geometry.source, what, "write cone");
        }
        let (range_min_m, range_max_m, radius) = (min?, max?, radius?);
        if range_min_m >= range_max_m {
            self.diagnostics.error(
                Self::place(sonar, "max", sensor),
                format!(
                    "the <sonar> of sensor '{}' has <min> {range_min_m} and <max> {range_max_m}",
                    self.sensor
                ),
                "write <min> below <max>, in metres",
            );
            return None;
        }
        let half = libm::atan2(radius, range_max_m);
        let axis = ScanAxis { samples: SONAR_BEAMS, min_angle_rad: -half, max_angle_rad: half };
        let mut ray = RaySensor {
            horizontal: axis,
            vertical: axis,
            range_min_m,
            range_max_m,
            range_resolution_m: 0.0,
            noise: Noise::default(),
            sees_visuals: false,
            visibility_mask: u32::MAX,
        };
        let of_topic = || {
            let (radiation, frame_name) = (Radiation::Ultrasound, frame_name(sensor));
            Some(RangePlugin {
                topic: gz_topic(sensor)?,
                frame_name,
                radiation,
                field_of_view_rad: 2.0 * half,
            })
        };
        let plugin = self.publisher(sensor, &mut ray).or_else(of_topic);
        let sensor_from_beams = DQuat::from_rotation_y(FRAC_PI_2);
        Some(Rangefinder { ray, cone_rad: Some(half), sensor_from_beams, plugin })
    }

    fn hector_sonar(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<RangePlugin> {
        self.add_noise(plugin, ray)?;
        ray.noise.mean += self.number(Some(plugin), "offset", 0.0)?;
        self.plugin_rate_hz = match plugin.child("updateRate") {
            Some(_) => self.rate(plugin, "updateRate")?,
            None => Some(10.0),
        };
        let across = |axis: &ScanAxis| axis.max_angle_rad - axis.min_angle_rad;
        Some(RangePlugin {
            topic: topic(plugin, "", "topicName", "sonar"),
            frame_name: child_text(plugin, "frameId").unwrap_or_else(|| "/sonar_link".into()),
            radiation: Radiation::Ultrasound,
            field_of_view_rad: across(&ray.horizontal).min(across(&ray.vertical)),
        })
    }

    fn range_plugin(&mut self, plugin: &Element, ray: &mut RaySensor) -> Option<RangePlugin> {
        self.add_noise(plugin, ray)?;
        self.plugin_rate_hz = self.rate(plugin, "updateRate")?;
        let is_angle = |angle: f64| (0.0..=std::f64::consts::TAU).contains(&angle);
        Some(RangePlugin {
            topic: topic(plugin, "", "topicName", "/range"),
            frame_name: child_text(plugin, "frameName").unwrap_or_else(|| "/world".into()),
            // As in the plugin, every other value means the other kind.
            radiation: match child_text(plugin, "radiation").as_deref() {
                None | Some("ultrasound") => Radiation::Ultrasound,
                Some(_) => Radiation::Infrared,
            },
            field_of_view_rad: self.checked(
                Some(plugin),
                "fov",
                0.05,
                is_angle,
                "write the full angle in radians, from 0 to 6.2832",
            )?,
        })
    }
}

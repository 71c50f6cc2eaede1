//! Inertial measurement units: `<imu>` with its noise and its frame of reference, and `libgazebo_ros_imu_sensor.so`.

use super::gz::{frame_name, gz_topic};
use super::imu_profile::ImuProfile;
use super::instrument::{InstrumentPlugin, ros2_names};
use super::noise::instrument;
use super::plugin::{absolute, extension};
use super::reader::Reader;
use super::{Kind, SensorKind};
use crate::values::{child_bool, child_text, numbers};
use crate::xml::Element;
use belvedere_sensors::Pose;
use belvedere_sensors::imu::{ImuConfig, presets};
use belvedere_sensors::noise::InstrumentConfig;
use glam::{DMat3, DQuat, DVec3};

/// An inertial measurement unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Imu {
    /// Errors of its gyros and accelerometers.
    pub config: ImuConfig,
    /// The axes that its orientation is relative to; none if it reports no orientation.
    pub reference: Option<OrientationReference>,
    /// A rotation that is applied before the reported orientation and to nothing else: `rpyOffset`.
    pub orientation_offset: DQuat,
    /// Standard deviation of each part of the orientation's quaternion.
    pub orientation_stddev: f64,
    /// Errors of the reported heading, in rad about the world's z.
    pub heading: InstrumentConfig<1>,
    /// The layout of its packets, if it is an Ouster's and sends any.
    pub packets: Option<ImuProfile>,
    /// The plugin that publishes it.
    pub plugin: Option<InstrumentPlugin>,
}

/// The axes that an orientation is relative to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OrientationReference {
    /// Axes rotated by this relative to the world's.
    World(DQuat),
    /// Axes rotated by this relative to east, north and up.
    East(DQuat),
    /// Axes rotated by this relative to those of the unit at the start.
    Start(DQuat),
}

pub(super) const KIND: Kind = Kind {
    types: &["imu"],
    plugins: &["gazebo_ros_imu_sensor"],
    is_extended: true,
    read: |reader, sensor| Some(SensorKind::Imu(reader.imu(sensor)?.into())),
};

/// The three axes' names.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Imu {
    /// Returns the unit that a model's plugin creates: its orientation is in the world.
    pub(crate) fn of_plugin(config: &ImuConfig, plugin: InstrumentPlugin) -> Self {
        Self {
            config: *config,
            reference: Some(OrientationReference::World(DQuat::IDENTITY)),
            orientation_offset: DQuat::IDENTITY,
            orientation_stddev: 0.0,
            heading: InstrumentConfig::default(),
            packets: None,
            plugin: Some(plugin),
        }
    }
}

impl Reader<'_> {
    fn imu(&mut self, sensor: &Element) -> Option<Imu> {
        let imu = sensor.child("imu");
        let read = [
            "angular_velocity",
            "linear_acceleration",
            "orientation_reference_frame",
            "enable_orientation",
            "noise",
            "topic",
        ];
        if let Some(imu) = imu {
            let remedy = format!("remove it: an <imu> has {}", read[..4].join(", "));
            self.left_out(imu, |name| read.contains(&name), &remedy);
        }
        let gyro = self.triad(imu, "angular_velocity", "rate");
        let accelerometer = self.triad(imu, "linear_acceleration", "accel");
        let reference = self.reference(imu);
        let tells =
            imu.and_then(|imu| child_bool(imu, "enable_orientation", self.diagnostics)).unwrap_or(true);
        let config = ImuConfig::default().gyro(gyro?).accelerometer(accelerometer?);
        let config = self.inertial_extension(sensor, config)?;
        let mut unit = Imu {
            config,
            reference: if tells { Some(reference?) } else { None },
            orientation_offset: DQuat::IDENTITY,
            orientation_stddev: 0.0,
            heading: InstrumentConfig::default(),
            packets: self.imu_profile(sensor, true)?,
            plugin: None,
        };
        if let Some(plugin) = self.plugin(sensor, &KIND) {
            unit.plugin = Some(self.imu_plugin(plugin, &mut unit)?);
        } else {
            unit.plugin =
                gz_topic(sensor).map(|topic| InstrumentPlugin { topic, frame_name: frame_name(sensor) });
        }
        Some(unit)
    }

    /// Reads the noise of three axes: one for each, or one for all in the `<noise>` of files before SDF 1.6.
    fn triad(&mut self, imu: Option<&Element>, name: &str, old_name: &str) -> Option<InstrumentConfig<3>> {
        let old = imu.and_then(|imu| imu.child("noise")).and_then(|noise| noise.child(old_name));
        let triad = imu.and_then(|imu| imu.child(name));
        let noises = match (triad, old) {
            (None, Some(old)) => [self.noise_of(old, &[]); 3],
            _ => AXES.map(|axis| self.noise_in(triad, axis)),
        };
        let [x, y, z] = noises;
        Some(instrument([x?, y?, z?]))
    }

    fn reference(&mut self, imu: Option<&Element>) -> Option<OrientationReference> {
        let start = OrientationReference::Start(DQuat::IDENTITY);
        let Some(frame) = imu.and_then(|imu| imu.child("orientation_reference_frame")) else {
            return Some(start);
        };
        let axes = |x, y, z| {
            let turned = DQuat::from_mat3(&DMat3::from_cols(x, y, z));
            Some(OrientationReference::East(turned))
        };
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        match child_text(frame, "localization").as_deref().unwrap_or("CUSTOM") {
            "ENU" => axes(x, y, z),
            "NWU" => axes(y, -x, z),
            "NED" => axes(y, x, -z),
            "CUSTOM" => {
                let Some(custom) = frame.child("custom_rpy") else { return Some(start) };
                let what = self.what("custom_rpy");
                let rpy = numbers::<3>(&custom.text(), &what, &custom.source, self.diagnostics)?;
                let turned = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::from(rpy)).rotation();
                match custom.attribute("parent_frame").unwrap_or_default() {
                    "" => Some(OrientationReference::Start(turned)),
                    "world" => Some(OrientationReference::World(turned)),
                    other => {
                        self.diagnostics.warning(
                            &custom.source,
                            format!(
                                "{what} is relative to '{other}', which is not simulated: the world is used"
                            ),
                            "write parent_frame=\"world\", or none for the unit's own axes at the start",
                        );
                        Some(OrientationReference::World(turned))
                    }
                }
            }
            other => {
                let what = self.what("localization");
                self.diagnostics.warning(
                    Self::place(Some(frame), "localization", frame),
                    format!(
                        "{what} is '{other}', which is not simulated: orientations are those in the world"
                    ),
                    "write ENU, NWU, NED or CUSTOM",
                );
                Some(OrientationReference::World(DQuat::IDENTITY))
            }
        }
    }

    fn imu_plugin(&mut self, plugin: &Element, unit: &mut Imu) -> Option<InstrumentPlugin> {
        let names = ["initialOrientationAsReference", "initial_orientation_as_reference"];
        let starts = names.map(|name| child_bool(plugin, name, self.diagnostics).unwrap_or(false));
        if unit.reference.is_some() && !starts.contains(&true) {
            // The plugin always uses the world, whatever the sensor specifies (REP-145).
            unit.reference = Some(OrientationReference::World(DQuat::IDENTITY));
        }
        if plugin.child("ros").is_some() || plugin.child("frame_name").is_some() {
            return Some(ros2_names(plugin));
        }
        let stddev = self.not_negative(Some(plugin), "gaussianNoise")?;
        for triad in [&mut unit.config.gyro, &mut unit.config.accelerometer] {
            triad.stddev = triad.stddev.map(|own| libm::hypot(own, stddev));
        }
        unit.orientation_stddev = stddev;
        if let Some(offset) = plugin.child("rpyOffset") {
            let rpy =
                numbers::<3>(&offset.text(), &self.what("rpyOffset"), &offset.source, self.diagnostics)?;
            unit.orientation_offset = Pose::from_xyz_rpy(DVec3::ZERO, DVec3::from(rpy)).rotation();
        }
        // Once a second by default.
        self.plugin_rate_hz = match plugin.child("updateRateHZ") {
            Some(_) => self.rate(plugin, "updateRateHZ")?,
            None => Some(1.0),
        };
        if plugin.child("frameName").is_none() {
            self.diagnostics.warning(
                &plugin.source,
                format!(
                    "the plugin of sensor '{}' has no <frameName>: the sensor's link is used",
                    self.sensor
                ),
                "write <frameName>, without which Gazebo publishes nothing",
            );
        }
        let topic = child_text(plugin, "topicName").unwrap_or_else(|| "imu_data".into());
        Some(InstrumentPlugin {
            topic: match child_text(plugin, "robotNamespace") {
                Some(namespace) if !topic.starts_with('/') => absolute(&[&namespace, &topic]),
                _ => topic,
            },
            frame_name: child_text(plugin, "frameName").unwrap_or_default(),
        })
    }

    /// Reads `<plugin filename="belvedere">`: a preset, or figures with Kalibr's names, for which SDF has no elements.
    fn inertial_extension(&mut self, sensor: &Element, mut config: ImuConfig) -> Option<ImuConfig> {
        let Some(own) = extension(sensor) else { return Some(config) };
        let words: Vec<String> = ["gyroscope", "accelerometer"]
            .iter()
            .flat_map(|triad| FIGURES.iter().map(move |figure| format!("{triad}_{figure}")))
            .collect();
        let others = ["preset", "udp_profile_imu"];
        let remedy = format!("remove it: the plugin has {}, {}", others.join(", "), words.join(", "));
        self.left_out(own, |name| others.contains(&name) || words.iter().any(|word| word == name), &remedy);
        if own.child("preset").is_some() {
            config = presets::named(self.preset_name(own, &presets::NAMES)?)?.config();
        }
        config.gyro = self.figures(own, "gyroscope", config.gyro)?;
        config.accelerometer = self.figures(own, "accelerometer", config.accelerometer)?;
        Some(config)
    }

    fn figures(
        &mut self,
        own: &Element,
        triad: &str,
        mut config: InstrumentConfig<3>,
    ) -> Option<InstrumentConfig<3>> {
        let mut axes = |figure: &str, to: &mut [f64; 3], least: f64| {
            let Some(child) = own.child(&format!("{triad}_{figure}")) else { return Some(()) };
            let (what, text) = (self.what(&child.name), child.text());
            // Either one number for all axes, or one for each.
            *to = if text.split_whitespace().count() == 1 {
                [numbers::<1>(&text, &what, &child.source, self.diagnostics)?[0]; 3]
            } else {
                numbers::<3>(&text, &what, &child.source, self.diagnostics)?
            };
            if to.iter().any(|value| *value < least) {
                let remedy = format!("write {least} or more, once or for x, y and z");
                self.diagnostics.error(&child.source, format!("{what} is {text}"), remedy);
                return None;
            }
            Some(())
        };
        axes("noise_density", &mut config.density, 0.0)?;
        axes("random_walk", &mut config.drift, 0.0)?;
        axes("bias_correlation_time", &mut config.drift_time_s, 1e-9)?;
        axes("turn_on_bias_stddev", &mut config.bias_stddev, 0.0)?;
        let mut scale = [0, 1, 2].map(|axis| config.sensitivity[axis][axis] - 1.0);
        axes("scale_error", &mut scale, -1.0)?;
        let mut range = [config.limit; 3];
        axes("range", &mut range, 1e-9)?;
        config.limit = range[0];
        config = config.scale_errors(scale);
        if let Some(child) = own.child(&format!("{triad}_misalignment")) {
            let what = self.what(&child.name);
            let [xy, xz, yx, yz, zx, zy] =
                numbers::<6>(&child.text(), &what, &child.source, self.diagnostics)?;
            let [[xx, ..], [_, yy, _], [.., zz]] = config.sensitivity;
            config.sensitivity = [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]];
        }
        Some(config)
    }
}

/// The figures of each triad in the extension.
const FIGURES: [&str; 7] = [
    "noise_density",
    "random_walk",
    "bias_correlation_time",
    "turn_on_bias_stddev",
    "scale_error",
    "misalignment",
    "range",
];

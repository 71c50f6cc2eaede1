//! Reading and checking of the values in a plugin's elements.

use crate::Rules;
use crate::diagnostics::Diagnostics;
use crate::elements;
use crate::model::{
    JointIndex, JointKind, LinkIndex, Model, OdometryOrigin, OdometryPlugin, Sensor, SensorKind, Wheels,
};
use crate::sensor::ros2;
use crate::topic;
use crate::values::{child_bool, number, numbers};
use crate::xml::Element;
use belvedere_sensors::Pose;
use belvedere_sensors::noise::InstrumentConfig;
use glam::DVec3;

/// The parameters of one plugin. A value may have several names because Gazebo's plugins were renamed.
pub(super) struct Parameters<'a> {
    pub(super) plugin: &'a Element,
    pub(super) model: &'a Model,
    rules: Rules,
    diagnostics: &'a mut Diagnostics,
    /// The plugin's name in the tables of elements.
    context: &'a str,
}

impl<'a> Parameters<'a> {
    /// Begins to read a plugin, and reports what is not simulated or unknown in it.
    pub(super) fn new(
        plugin: &'a Element,
        context: &'a str,
        model: &'a Model,
        rules: Rules,
        diagnostics: &'a mut Diagnostics,
    ) -> Self {
        topic::check(plugin, diagnostics);
        elements::report_plugin(plugin, context, diagnostics);
        Self { plugin, model, rules, diagnostics, context }
    }

    /// Returns the first element that has one of these names. Names that the plugin does not know are not read.
    pub(super) fn element(&self, names: &[&str]) -> Option<&'a Element> {
        let plugin: &'a Element = self.plugin;
        let mut known = names.iter().filter(|name| elements::knows(self.context, name));
        let is_given = |element: &&Element| !element.text().is_empty() || element.elements().next().is_some();
        known.find_map(|name| plugin.child(name)).filter(is_given)
    }

    pub(super) fn text(&self, names: &[&str]) -> Option<String> {
        self.element(names).map(Element::text)
    }

    /// Reads a finite number that fulfils a condition; `remedy` states the condition. None after an error.
    pub(super) fn number(
        &mut self,
        names: &[&str],
        default: f64,
        is_valid: impl Fn(f64) -> bool,
        remedy: &str,
    ) -> Option<f64> {
        let Some(element) = self.element(names) else { return Some(default) };
        let what = format!("<{}> of plugin '{}'", element.name, self.name());
        let value = number(&element.text(), &what, &element.source, self.diagnostics)?;
        if is_valid(value) {
            return Some(value);
        }
        self.diagnostics.error(&element.source, format!("{what} is {value}"), remedy);
        None
    }

    pub(super) fn positive(&mut self, names: &[&str], default: f64) -> Option<f64> {
        self.number(names, default, |value| value > 0.0, "write a number above 0")
    }

    /// Reads a length in m that a wheel or a base can have.
    pub(super) fn length(&mut self, names: &[&str], default: f64) -> Option<f64> {
        let is_length = |value: f64| (1e-4..=1e4).contains(&value);
        self.number(names, default, is_length, "write metres, from 0.0001 to 10000")
    }

    /// Reads one number for all axes, or one for each.
    fn axes<const N: usize>(
        &mut self,
        name: &str,
        default: f64,
        is_valid: impl Fn(f64) -> bool,
    ) -> Option<[f64; N]> {
        let Some(element) = self.element(&[name]) else { return Some([default; N]) };
        let text = element.text();
        let is_right = |value: &f64| value.is_finite() && is_valid(*value);
        let numbers: Option<Vec<f64>> =
            text.split_whitespace().map(|word| word.parse().ok().filter(is_right)).collect();
        let numbers = numbers.unwrap_or_default();
        if let [all] = numbers[..] {
            return Some([all; N]);
        }
        if let Ok(each) = numbers.try_into() {
            return Some(each);
        }
        let what = format!("<{name}> of plugin '{}' is '{text}'", self.name());
        let least = if is_valid(-1.0) { "" } else { ", 0 or more" };
        let each = if N > 1 { format!(", or {N}") } else { String::new() };
        self.diagnostics.error(&element.source, what, format!("write one number{least}{each}"));
        None
    }

    /// Reads the error model of Team Hector's plugins: a mean, white noise, and a bias with a deviation and a frequency with
    /// which it is forgotten. Parameter names have the prefix, or are in lower case without one.
    pub(super) fn hector_noise<const N: usize>(&mut self, prefix: &str) -> Option<InstrumentConfig<N>> {
        let name = |what: &str| match (prefix, what.split_at(1)) {
            ("", (first, rest)) => format!("{}{rest}", first.to_ascii_lowercase()),
            _ => format!("{prefix}{what}"),
        };
        let not_negative = |value: f64| value >= 0.0;
        let offset = self.axes(&name("Offset"), 0.0, |_| true);
        let drift = self.axes::<N>(&name("Drift"), 0.0, not_negative);
        let frequency = self.axes::<N>(&name("DriftFrequency"), 1.0 / 3600.0, not_negative);
        let white = self.axes(&name("GaussianNoise"), 0.0, not_negative);
        let (drift, frequency) = (drift?, frequency?);
        // The process converges to this deviation. Hector's plugin steps by the time instead of its root, and agrees at 1 Hz.
        let driven = std::array::from_fn(|axis| drift[axis] * libm::sqrt(2.0 * frequency[axis]));
        let time_s = frequency.map(|hz| if hz > 0.0 { 1.0 / hz } else { f64::INFINITY });
        let config = InstrumentConfig::default().mean(offset?).stddev(white?);
        Some(config.drift(driven).drift_time_s(time_s))
    }

    /// Creates a sensor that has the plugin's name.
    pub(super) fn sensor(
        &self,
        link: LinkIndex,
        link_from_sensor: Pose,
        rate_hz: Option<f64>,
        kind: SensorKind,
    ) -> Sensor {
        Sensor {
            name: self.name().to_owned(),
            link,
            link_from_sensor,
            always_on: true,
            update_rate_hz: rate_hz,
            plugin_rate_hz: None,
            kind,
            source: self.plugin.source.clone(),
        }
    }

    pub(super) fn not_negative(&mut self, names: &[&str], default: f64) -> Option<f64> {
        self.number(names, default, |value| value >= 0.0, "write 0 or more")
    }

    pub(super) fn flag(&mut self, names: &[&str], default: bool) -> bool {
        self.element(names)
            .and_then(|element| child_bool(self.plugin, &element.name, self.diagnostics))
            .unwrap_or(default)
    }

    /// Reads a rate in hertz; the inner none means every step.
    #[expect(clippy::option_option, reason = "outer: readable; inner: limited")]
    pub(super) fn rate(&mut self, names: &[&str], default: f64) -> Option<Option<f64>> {
        let is_rate = |hz: f64| hz == 0.0 || (1e-6..=1e6).contains(&hz);
        let remedy = "write a rate in hertz from 0.000001 to 1000000, or 0 for every step";
        let hz = self.number(names, default, is_rate, remedy)?;
        Some((hz > 0.0).then_some(hz))
    }

    /// Returns an absolute topic: under `<robotNamespace>` unless it begins with a slash.
    pub(super) fn topic(&self, names: &[&str], default: &str) -> String {
        let topic = self.text(names).unwrap_or_else(|| default.to_owned());
        // ROS 2 has namespace and remappings in <ros>.
        if self.element(&["ros"]).is_some() {
            return ros2::topic(self.plugin, &topic, &[]);
        }
        if topic.starts_with('/') {
            return topic;
        }
        let namespace = self.text(&["robotNamespace", "node_namespace"]).unwrap_or_default();
        let namespace = namespace.trim_matches('/');
        if namespace.is_empty() { format!("/{topic}") } else { format!("/{namespace}/{topic}") }
    }

    /// Returns the name of the plugin.
    pub(super) fn name(&self) -> &'a str {
        let plugin: &'a Element = self.plugin;
        plugin.attribute("name").or(plugin.attribute("filename")).unwrap_or_default()
    }

    /// Returns the joint that an element names, or the default's. Without such a joint the plugin cannot be used.
    pub(super) fn joint(&mut self, names: &[&str], default: &str) -> Option<JointIndex> {
        self.joints(names, default)?.first().copied()
    }

    /// Returns the joints that all elements of these names name.
    pub(super) fn joints(&mut self, names: &[&str], default: &str) -> Option<Vec<JointIndex>> {
        let first = self.element(names);
        let plugin: &'a Element = self.plugin;
        let mut written: Vec<(String, &Element)> = plugin
            .elements()
            .filter(|element| names.contains(&element.name.as_str()))
            .map(|element| (element.text(), element))
            .collect();
        if first.is_none() {
            written = vec![(default.to_owned(), plugin)];
        }
        let mut joints = Vec::new();
        for (name, element) in written {
            // SDF prefixes the names of nested joints with their model.
            let found = self.model.joints.iter().position(|joint| joint.name == name);
            let Some(found) = found else {
                let joints = self.model.joints.iter().map(|joint| joint.name.as_str());
                let remedy = self.diagnostics.did_you_mean(&name, joints).unwrap_or_default();
                let what =
                    format!("the base '{}' drives the joint '{name}', which does not exist", self.name());
                self.unusable(element, what, &remedy);
                return None;
            };
            joints.push(found);
        }
        Some(joints)
    }

    /// Returns the left and right wheels. Their positions decide which is which, because Gazebo's plugins once swapped them.
    pub(super) fn wheels(
        &mut self,
        left: Vec<JointIndex>,
        right: Vec<JointIndex>,
        radius_m: Option<f64>,
        torque_n_m: f64,
    ) -> Option<Wheels> {
        for joint in left.iter().chain(&right) {
            let joint = &self.model.joints[*joint];
            if !matches!(joint.kind, JointKind::Continuous | JointKind::Revolute { .. }) {
                let what = format!(
                    "the base '{}' drives the joint '{}', which does not turn",
                    self.name(),
                    joint.name
                );
                self.unusable(self.plugin, what, "make it continuous");
                return None;
            }
        }
        Some(Wheels { left, right, radius_m, torque_n_m })
    }

    /// Returns the question "did you mean …?" for an unknown name, if there is a probable candidate.
    pub(super) fn did_you_mean<'n>(
        &self,
        name: &str,
        candidates: impl IntoIterator<Item = &'n str>,
    ) -> Option<String> {
        self.diagnostics.did_you_mean(name, candidates)
    }

    /// Reports that the plugin cannot be used: an error, or a warning where Gazebo continues without it, as gz-sim does.
    pub(super) fn unusable(&mut self, element: &Element, what: String, remedy: &str) {
        let file = self.plugin.attribute("filename").unwrap_or_default();
        if self.rules.gazebo_compat || super::plain_name(file).starts_with("gz-sim") {
            self.diagnostics.warning(
                &element.source,
                format!("{what}: it is left out, as in Gazebo"),
                remedy,
            );
        } else {
            self.diagnostics.error(&element.source, what, remedy);
        }
    }

    pub(super) fn warning(&mut self, what: &str, remedy: &str) {
        let what = format!("plugin '{}': {what}", self.name());
        self.diagnostics.warning(&self.plugin.source, what, remedy);
    }

    /// Returns the link that an element names, or the default's. If there is no such link it returns the root, with a warning if
    /// the name was given.
    pub(super) fn link(&mut self, names: &[&str], default: &str) -> LinkIndex {
        let element = self.element(names);
        let name = element.map_or_else(|| default.to_owned(), Element::text);
        let plain = name.rsplit('/').next().unwrap_or_default();
        let model = self.model;
        let ends = |link: &str| link.rsplit("::").next() == Some(plain);
        let found = model.link_named(plain).or_else(|| model.links.iter().position(|link| ends(&link.name)));
        if let (None, Some(element)) = (found, element) {
            let meant =
                self.diagnostics.did_you_mean(plain, model.links.iter().map(|link| link.name.as_str()));
            self.diagnostics.warning(
                &element.source,
                format!(
                    "<{}> of plugin '{}' is '{name}', and there is no such link: the root link is used",
                    element.name,
                    self.name()
                ),
                meant.unwrap_or_default(),
            );
        }
        found.unwrap_or_else(|| root(model))
    }

    /// Reads `xyzOffset` and `rpyOffset`.
    pub(super) fn offset(&mut self) -> Option<Pose> {
        let mut three = |names: &[&str]| {
            let Some(element) = self.element(names) else { return Some(DVec3::ZERO) };
            let what = format!("<{}> of plugin '{}'", element.name, self.name());
            numbers::<3>(&element.text(), &what, &element.source, self.diagnostics).map(DVec3::from_array)
        };
        let (xyz, rpy) = (
            three(&["xyzOffset", "xyzOffsets", "xyz_offset", "xyz_offsets"]),
            three(&["rpyOffset", "rpyOffsets", "rpy_offset", "rpy_offsets"]),
        );
        Some(Pose::from_xyz_rpy(xyz?, rpy?))
    }

    /// Reads the usual parameters of odometry.
    pub(super) fn odometry(
        &mut self,
        rate_hz: Option<f64>,
        origin: OdometryOrigin,
        pose_variance: [f64; 6],
    ) -> OdometryPlugin {
        let frames = ["robotBaseFrame", "robot_base_frame"];
        let link = self.link(&frames, "base_footprint");
        let of_link = || {
            let name = &self.model.links.get(link).map_or("base_footprint", |link| &*link.name);
            (*name).to_owned()
        };
        let child_frame = self.text(&frames).unwrap_or_else(of_link);
        OdometryPlugin {
            topic: self.topic(&["odometryTopic", "odometry_topic"], "odom"),
            frame: self.text(&["odometryFrame", "odometry_frame"]).unwrap_or_else(|| "odom".into()),
            child_frame,
            link,
            rate_hz,
            origin,
            is_transform: self.flag(
                &["publishOdomTF", "publishTf", "publish_odom_tf", "broadcastTF", "publishOdometryTf"],
                true,
            ),
            pose_variance,
        }
    }
}

/// Returns the uppermost link.
fn root(model: &Model) -> LinkIndex {
    model.first_root().unwrap_or(0)
}

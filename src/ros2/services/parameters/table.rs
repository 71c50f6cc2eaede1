//! [`Table`]: the parameters that there are now, with their values and limits.

use crate::description::suggestion::did_you_mean_or;
use belvedere_bridge::Text;
use belvedere_bridge::payload::SensorSettings;
use std::collections::BTreeSet;

/// The value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    /// None: the parameter does not exist, or is to be removed.
    NotSet,
    Bool(bool),
    Integer(i64),
    Double(f64),
    /// A value of a type that no parameter here has, with the name of that type.
    Other(&'static str),
}

/// The types of values, by their numbers in `rcl_interfaces/msg/ParameterType`.
const TYPES: [&str; 10] = [
    "nothing",
    "a bool",
    "an integer",
    "a double",
    "a string",
    "an array of bytes",
    "an array of bools",
    "an array of integers",
    "an array of doubles",
    "an array of strings",
];

impl Value {
    /// Returns the number of its type.
    pub(super) fn number(self) -> u8 {
        TYPES.iter().position(|known| *known == self.kind()).unwrap_or(0) as u8
    }

    /// Returns the name of its type, with an article.
    pub(super) fn kind(self) -> &'static str {
        match self {
            Self::NotSet => TYPES[0],
            Self::Bool(_) => TYPES[1],
            Self::Integer(_) => TYPES[2],
            Self::Double(_) => TYPES[3],
            Self::Other(kind) => kind,
        }
    }

    /// A value of the type with this number, which no parameter here has.
    pub(super) fn of_other_type(number: u8) -> Self {
        Self::Other(TYPES.get(usize::from(number)).copied().unwrap_or("a value of an unknown type"))
    }
}

/// A parameter of the node.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parameter {
    pub(super) name: String,
    pub(super) description: &'static str,
    pub(super) value: Value,
    /// The setting of a sensor that it is; `None` if it cannot be changed.
    pub(super) setting: Option<Setting>,
}

/// A setting of a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Setting {
    /// The sensor's name, or one of its topics.
    pub(super) sensor: Text<64>,
    pub(super) name: &'static str,
    pub(super) min: f64,
    pub(super) max: f64,
}

/// A change of a setting that is within its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    pub(super) setting: Setting,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// Parameters that came, changed and went, with the values that they have or had.
pub(super) type Changes<'a> = [Vec<(&'a str, Value)>; 3];

/// All parameters.
#[derive(Debug, Clone)]
pub(super) struct Table(Vec<Parameter>);

impl Table {
    /// The parameters of a node with these sensors.
    pub(super) fn new(sensors: &[SensorSettings]) -> Self {
        let mut parameters = vec![Parameter {
            name: "use_sim_time".to_owned(),
            description: "The messages of this node have simulated time, which it publishes on /clock",
            value: Value::Bool(true),
            setting: None,
        }];
        let mut prefixes = BTreeSet::new();
        for sensor in sensors {
            let topic = sensor.topics().next().unwrap_or_default();
            let mut prefix = sensor.name.as_str().replace('/', ".");
            // Two sensors of one name are distinguished by their topics.
            if !prefixes.insert(prefix.clone()) {
                prefix = topic.replace('/', ".");
                prefixes.insert(prefix.clone());
            }
            // A topic belongs to one sensor only.
            let of = Text::new(topic).ok().filter(|topic| !topic.is_empty()).unwrap_or(sensor.name);
            for (name, setting) in sensor.by_name() {
                if !setting.value.is_nan() {
                    parameters.push(Parameter {
                        name: format!("{prefix}.{name}"),
                        description: describe(name, !sensor.exposure.value.is_nan()),
                        value: Value::Double(setting.value),
                        setting: Some(Setting { sensor: of, name, min: setting.min, max: setting.max }),
                    });
                }
            }
        }
        Self(parameters)
    }

    /// Returns true if there is a sensor with settings.
    pub(super) fn has_sensors(&self) -> bool {
        self.0.iter().any(|known| known.setting.is_some())
    }

    pub(super) fn find(&self, name: &str) -> Option<&Parameter> {
        self.0.iter().find(|known| known.name == name)
    }

    /// Finds a parameter.
    ///
    /// # Errors
    /// That there is none, with a name that may be meant.
    pub(super) fn get(&self, name: &str) -> Result<&Parameter, String> {
        self.find(name).ok_or_else(|| {
            let names = self.0.iter().map(|known| known.name.as_str());
            let remedy = did_you_mean_or(name, names, "ros2 param list shows all");
            format!("there is no parameter '{name}'; {remedy}")
        })
    }

    /// Checks a new value; `None` if it is the one that a constant parameter has.
    ///
    /// # Errors
    /// Why it is refused.
    pub(super) fn check(&self, name: &str, value: Value) -> Result<Option<Change>, String> {
        let known = self.get(name)?;
        let (Some(setting), Value::Double(from)) = (known.setting, known.value) else {
            let same = known.value == value;
            return same.then_some(None).ok_or_else(|| format!("{name} cannot be changed"));
        };
        let must = format!("it must be a number from {} to {}", setting.min, setting.max);
        let to = match value {
            Value::Double(number) => number,
            // `ros2 param set` sends 15 as an integer.
            Value::Integer(number) => number as f64,
            Value::NotSet => return Err(format!("{name} cannot be removed; {must}")),
            other => return Err(format!("{name} is given as {}; {must}", other.kind())),
        };
        if !(setting.min..=setting.max).contains(&to) {
            return Err(format!("{name} is {to}; {must}"));
        }
        Ok(Some(Change { setting, from, to }))
    }

    /// Returns the names with one of these prefixes, or all names if there is no prefix, and the prefixes of the names
    /// that are found. Names are left out that have more than `depth` parts behind a prefix, if it is not 0.
    pub(super) fn list(&self, prefixes: &[&str], depth: u64) -> [Vec<&str>; 2] {
        let is_near = |rest: &str| depth == 0 || (rest.matches('.').count() as u64) < depth;
        let is_below = |name: &str, prefix: &str| {
            let rest = name.strip_prefix(prefix);
            rest.is_some_and(|rest| rest.is_empty() || rest.strip_prefix('.').is_some_and(is_near))
        };
        let is_wanted = |name: &str| match prefixes {
            [] => is_near(name),
            some => some.iter().any(|prefix| is_below(name, prefix)),
        };
        let names = self.0.iter().map(|known| known.name.as_str()).filter(|name| is_wanted(name));
        let names: Vec<&str> = names.collect();
        let mut found: Vec<&str> = names.iter().filter_map(|name| Some(name.rsplit_once('.')?.0)).collect();
        found.dedup();
        [names, found]
    }

    /// Returns how this table differs from an earlier one.
    pub(super) fn since<'a>(&'a self, before: &'a Self) -> Changes<'a> {
        let value = |of: &'a Parameter| (of.name.as_str(), of.value);
        let came = self.0.iter().filter(|now| before.find(&now.name).is_none());
        let changed =
            self.0.iter().filter(|now| before.find(&now.name).is_some_and(|old| old.value != now.value));
        let went = before.0.iter().filter(|old| self.find(&old.name).is_none());
        [came.map(value).collect(), changed.map(value).collect(), went.map(value).collect()]
    }
}

/// Returns the description of a setting of a camera or of another sensor.
fn describe(setting: &str, is_camera: bool) -> &'static str {
    match (setting, is_camera) {
        ("update_rate", _) => "Frames per second, in Hz of simulated time",
        ("noise_mean", true) => "Mean of the noise of colours, which are from 0 to 1",
        ("noise_mean", false) => "Mean of the noise of ranges, in metres",
        ("noise_stddev", true) => "Standard deviation of the noise of colours, which are from 0 to 1",
        ("noise_stddev", false) => "Standard deviation of the noise of ranges, in metres",
        ("exposure", _) => "Factor of the light; 1 is the exposure of the description",
        _ => "A setting of the sensor",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_bridge::payload::Setting as Limits;

    fn sensor(name: &str, topic: &str, rate: f64) -> SensorSettings {
        let mut topics = [Text::EMPTY; 6];
        topics[0] = Text::cut(topic);
        SensorSettings {
            name: Text::cut(name),
            topics,
            update_rate: Limits { value: rate, min: 0.01, max: 1000.0 },
            noise_mean: Limits { value: 0.0, min: -6.0, max: 6.0 },
            noise_stddev: Limits::NONE,
            exposure: Limits::NONE,
        }
    }

    #[test]
    fn sensors_of_one_name_are_distinguished_by_their_topics() {
        let sensors =
            [sensor("a/laser", "a/scan", 5.0), sensor("eye", "left", 1.0), sensor("eye", "right/x", 2.0)];
        let table = Table::new(&sensors);
        let [names, prefixes] = table.list(&[], 0);
        let wanted = ["a.laser", "eye", "right.x"];
        let settings = |prefix| [format!("{prefix}.update_rate"), format!("{prefix}.noise_mean")];
        let all: Vec<String> = wanted.iter().flat_map(settings).collect();
        assert_eq!(
            (names[0], &names[1..]),
            ("use_sim_time", &all.iter().map(String::as_str).collect::<Vec<_>>()[..])
        );
        assert_eq!(prefixes, wanted);
        let change = table.check("right.x.update_rate", Value::Integer(3)).unwrap().unwrap();
        assert_eq!((change.setting.sensor.as_str(), change.from, change.to), ("right/x", 2.0, 3.0));
    }

    #[test]
    fn prefixes_and_depth_choose_names() {
        let table = Table::new(&[sensor("a/laser", "a/scan", 5.0), sensor("eye", "left", 1.0)]);
        for (prefixes, depth, count) in [
            (&[][..], 0, 5),
            (&[], 1, 1),
            (&[], 2, 3),
            (&["eye"], 0, 2),
            (&["ey"], 0, 0),
            (&["a"], 1, 0),
            (&["a", "eye.update_rate"], 2, 3),
        ] {
            assert_eq!(table.list(prefixes, depth)[0].len(), count, "{prefixes:?} {depth}");
        }
    }

    #[test]
    fn changes_are_found() {
        let before = Table::new(&[sensor("laser", "scan", 5.0), sensor("eye", "left", 1.0)]);
        let after = Table::new(&[sensor("laser", "scan", 7.0), sensor("nose", "smell", 1.0)]);
        let [came, changed, went] = after.since(&before);
        let names =
            |of: Vec<(&str, Value)>| of.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>();
        assert_eq!(changed, [("laser.update_rate", Value::Double(7.0))]);
        assert_eq!(names(came), ["nose.update_rate", "nose.noise_mean"]);
        assert_eq!(names(went), ["eye.update_rate", "eye.noise_mean"]);
        assert_eq!(before.since(&before), [vec![], vec![], vec![]]);
    }
}

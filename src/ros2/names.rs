//! The names of topics in ROS 2.

use std::str::FromStr;

/// A topic with another name in ROS 2, written as `FROM:=TO`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remap {
    from: String,
    to: String,
}

impl FromStr for Remap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((from, to)) = text.split_once(":=") else {
            return Err("expected FROM:=TO, such as /scan:=/lidar/scan".to_owned());
        };
        let [from, to] = [from, to].map(|name| format!("/{}", name.trim_start_matches('/')));
        check(&to)?;
        Ok(Self { from, to })
    }
}

/// How streams are named.
#[derive(Debug, Clone, Default)]
pub struct Naming {
    /// A namespace before all topics except `/tf`, `/tf_static` and `/clock`, without slashes at its ends.
    pub namespace: String,
    /// Topics with other names.
    pub remaps: Vec<Remap>,
}

impl Naming {
    /// Returns the name of a topic in ROS 2. `topic` is its name in ROS, with a leading slash.
    ///
    /// # Errors
    /// Why ROS 2 forbids the name.
    pub(super) fn name(&self, topic: &str) -> Result<String, String> {
        let name = self.scoped(topic);
        if let Some(remap) = self.remaps.iter().find(|remap| remap.from == topic || remap.from == name) {
            return Ok(remap.to.clone());
        }
        check(&name)?;
        Ok(name)
    }

    /// Returns the topic in the namespace, before other names are given.
    fn scoped(&self, topic: &str) -> String {
        let is_common = ["/tf", "/tf_static", "/clock"].contains(&topic);
        if is_common || self.namespace.is_empty() {
            topic.to_owned()
        } else {
            format!("/{}{topic}", self.namespace)
        }
    }

    /// Returns the name of a topic `last` below another one, `topic`, whose name is `name`. It follows the other one unless
    /// it has another name of its own.
    pub(super) fn name_below(&self, topic: &str, name: &str, last: &str) -> String {
        let [plain, full] = [topic.to_owned(), self.scoped(topic)].map(|of| format!("{of}/{last}"));
        let remap = self.remaps.iter().find(|remap| remap.from == plain || remap.from == full);
        remap.map_or_else(|| format!("{name}/{last}"), |remap| remap.to.clone())
    }
}

/// Checks a namespace, with or without slashes at its ends, and returns it without them.
///
/// # Errors
/// Why ROS 2 forbids it.
pub fn namespace(text: &str) -> Result<String, String> {
    let namespace = text.trim_matches('/');
    if !namespace.is_empty() {
        check(&format!("/{namespace}"))?;
    }
    Ok(namespace.to_owned())
}

/// Checks an absolute name.
fn check(name: &str) -> Result<(), String> {
    let tokens = name.strip_prefix('/').unwrap_or(name).split('/');
    for token in tokens {
        if token.is_empty() {
            return Err(format!("ROS 2 forbids {name}: a part of the name is empty"));
        }
        if token.starts_with(|first: char| first.is_ascii_digit()) {
            return Err(format!("ROS 2 forbids {name}: \"{token}\" begins with a digit"));
        }
        if let Some(bad) = token.chars().find(|char| !char.is_ascii_alphanumeric() && *char != '_') {
            return Err(format!("ROS 2 forbids {name}: '{bad}' is not a letter, a digit or _"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn topics_get_the_namespace_and_other_names() {
        let remaps = vec!["scan:=/lidar/scan".parse().unwrap(), "/bot/odom:=/pose".parse().unwrap()];
        let naming = Naming { namespace: namespace("/bot/").unwrap(), remaps };
        for (topic, name) in [
            ("/scan", "/lidar/scan"),
            ("/odom", "/pose"),
            ("/imu", "/bot/imu"),
            ("/tf", "/tf"),
            ("/clock", "/clock"),
        ] {
            assert_eq!(naming.name(topic).as_deref(), Ok(name));
        }
        for (topic, name, below) in [
            ("/image_raw", "/bot/image_raw", "/bot/image_raw/compressed"),
            ("/scan", "/lidar/scan", "/lidar/scan/compressed"),
        ] {
            assert_eq!(naming.name_below(topic, name, "compressed"), below);
        }
        let remaps = vec!["/image_raw/compressed:=/jpeg".parse().unwrap()];
        let naming = Naming { remaps, ..Naming::default() };
        assert_eq!(naming.name_below("/image_raw", "/image_raw", "compressed"), "/jpeg");
    }

    #[test]
    fn forbidden_names_are_refused_with_the_reason() {
        let naming = Naming::default();
        for (topic, reason) in [
            ("/my-robot/scan", "ROS 2 forbids /my-robot/scan: '-' is not a letter, a digit or _"),
            ("/a/2d", "ROS 2 forbids /a/2d: \"2d\" begins with a digit"),
            ("/a//b", "ROS 2 forbids /a//b: a part of the name is empty"),
        ] {
            assert_eq!(naming.name(topic).unwrap_err(), reason);
        }
        assert!("scan".parse::<Remap>().is_err() && "scan:=a b".parse::<Remap>().is_err());
        assert!(namespace("a b").is_err());
        // A forbidden name can be given another one.
        let remaps = vec!["/my-robot/scan:=/scan".parse().unwrap()];
        let naming = Naming { remaps, ..Naming::default() };
        assert_eq!(naming.name("/my-robot/scan").as_deref(), Ok("/scan"));
    }
}

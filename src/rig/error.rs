//! Errors of starting the sensors.

use super::owner::Owner;
use crate::description::model::Sensor;
use crate::description::{Problem, Severity};
use belvedere_bridge::Error as BridgeError;

/// The reason why the sensors cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The bridge cannot open a stream.
    #[error(transparent)]
    Bridge(#[from] BridgeError),
    /// A sensor or a name in the robot's description cannot be used.
    #[error(transparent)]
    Description(#[from] Problem),
    /// A name is too long for the wire format.
    #[error("name '{name}': {reason}; rename it in the robot's description")]
    Name {
        /// The link, joint or frame.
        name: String,
        /// The reason why it cannot be used.
        reason: String,
    },
    /// The stream of sensor settings has no room for more sensors.
    #[error(
        "there are more than {most} sensors, which is the limit of this simulation; delete robots that are not needed, or start with all of them"
    )]
    TooManySensors {
        /// The highest number of sensors.
        most: usize,
    },
}

impl RigError {
    /// Returns true if shared memory has no room for a stream.
    #[cfg(feature = "server")]
    pub(crate) fn lacks_memory(&self) -> bool {
        matches!(self, Self::Bridge(BridgeError::SharedMemoryTooSmall { .. }))
    }

    pub(super) fn sensor(sensor: &Sensor, error: &dyn std::error::Error) -> Self {
        Self::Description(Problem {
            severity: Severity::Error,
            source: sensor.source.clone(),
            what: format!("sensor '{}': {error}", sensor.name),
            remedy: "correct the value in the sensor's description".into(),
        })
    }

    /// Returns the error about a second stream on the same topic.
    pub(super) fn topic_taken(topic: &str, first: &Owner, second: &Owner) -> Self {
        let remedy = if first.entity == second.entity {
            "give one of them another topic"
        } else {
            "give one of them another topic, or spawn its model in a namespace of its own"
        };
        Self::Description(Problem {
            severity: Severity::Error,
            source: second.source.clone(),
            what: format!(
                "two streams are called {topic}: that of {} and, before it, that of {} ({})",
                second.name, first.name, first.source
            ),
            remedy: format!(
                "{remedy}; with --gazebo-compat the second is published under another name, with a warning"
            ),
        })
    }

    pub(super) fn name(name: &str, reason: &dyn std::error::Error) -> Self {
        Self::Name { name: name.into(), reason: reason.to_string() }
    }
}

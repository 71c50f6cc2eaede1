//! Why the sensors cannot be started.

use crate::description::model::Sensor;
use crate::description::{Problem, Severity};
use belvedere_bridge::Error as BridgeError;

/// Why the sensors cannot be started.
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
        /// What is wrong with it.
        reason: String,
    },
    /// Two streams of one topic.
    #[error(
        "two streams of the simulation are called {topic}, the second of them in model '{model}'; give its sensor or plugin another topic, or its model a namespace"
    )]
    TopicTaken {
        /// In the model's namespace.
        topic: String,
        /// The model that has the second.
        model: String,
    },
    /// The stream of the settings of sensors has no room.
    #[error(
        "there are more than {most} sensors, which the simulation has no room for; delete robots that are not needed, or start with all of them"
    )]
    TooManySensors {
        /// How many there may be.
        most: usize,
    },
}

impl RigError {
    pub(super) fn sensor(sensor: &Sensor, error: &dyn std::error::Error) -> Self {
        Self::Description(Problem {
            severity: Severity::Error,
            source: sensor.source.clone(),
            what: format!("sensor '{}': {error}", sensor.name),
            remedy: "correct the value in the sensor's description".into(),
        })
    }

    pub(super) fn name(name: &str, reason: &dyn std::error::Error) -> Self {
        Self::Name { name: name.into(), reason: reason.to_string() }
    }
}

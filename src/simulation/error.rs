//! Errors of a simulation.

use crate::description::Problem;
use crate::rig::RigError;

/// The reason why a simulation cannot do something.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A problem in a file, with its line.
    #[error(transparent)]
    Description(#[from] Problem),
    /// A sensor or a stream that cannot be opened.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A name, a pose or a number that cannot be used: a message with a remedy.
    #[error("{0}")]
    Refused(String),
    /// The model was deleted.
    #[error("the model was deleted; spawn it again, and use the new one's identity")]
    Gone,
    /// The model does not drive.
    #[error("'{name}' has no base that drives; spawn a robot with one, or move it with `place`")]
    NoBase {
        /// Name of the model.
        name: String,
    },
    /// No sensor sends such a topic.
    #[error("no sensor sends {topic}; {near}there are: {there}")]
    NoTopic {
        /// The topic that was asked for.
        topic: String,
        /// A suggestion, if there is one.
        near: String,
        /// All topics.
        there: String,
    },
    /// A sensor's frame could not be rendered.
    #[error(
        "{topic} has no frame now: there is no event to report, or the position of its sensor or of an object is not finite"
    )]
    NoFrame {
        /// The topic that was asked for.
        topic: String,
    },
}

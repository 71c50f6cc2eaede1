//! Why a simulation does not do what is asked.

use crate::description::Problem;
use crate::rig::RigError;

/// Why a simulation does not do what is asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// Something in a file, with its line.
    #[error(transparent)]
    Description(#[from] Problem),
    /// A sensor or a stream that cannot be opened.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A name, a pose or a number that cannot be taken: what is wrong with it, and what would be right.
    #[error("{0}")]
    Refused(String),
    /// The model is not there any more.
    #[error("the model was deleted; spawn it again, and use the new one's identity")]
    Gone,
    /// The model does not drive.
    #[error("'{name}' has no base that drives; spawn a robot with one, or move it with `place`")]
    NoBase {
        /// Of the model.
        name: String,
    },
    /// No sensor sends such a topic.
    #[error("no sensor sends {topic}; {near}there are: {there}")]
    NoTopic {
        /// As asked for.
        topic: String,
        /// A suggestion, if there is one.
        near: String,
        /// All that there are.
        there: String,
    },
    /// A sensor's frame could not be taken.
    #[error(
        "{topic} has no frame now: nothing happens that it tells of, or its sensor or what it sees is at a place that is not finite"
    )]
    NoFrame {
        /// As asked for.
        topic: String,
    },
}

//! Errors of making a data set.

use crate::description::Problem;
use crate::simulation::SimulationError;
use std::io;
use std::path::PathBuf;

/// The reason why a data set cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Errors in the plan, or in a world or robot that it names, one line each.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Description(Vec<Problem>),
    /// A sample cannot be rendered.
    #[error("sample {sample}: {source}")]
    Sample {
        /// Its number.
        sample: u64,
        /// The reason.
        source: SimulationError,
    },
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Input {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(
        "cannot write {}: {source}; complete shards are kept; make room or choose another folder, and run the same command again",
        path.display()
    )]
    Output {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The folder contains shards of something else.
    #[error(
        "{} holds shards of another plan, or of another version of a world, a robot, one of their files or this program: {what}; choose another folder, or remove that one",
        folder.display()
    )]
    OtherPlan {
        /// The folder.
        folder: PathBuf,
        /// The difference.
        what: String,
    },
    /// A file of the data set is damaged.
    #[error("{}: {what}; remove it and run the same command again, which makes it again", path.display())]
    Damaged {
        /// Path of the file.
        path: PathBuf,
        /// The damage.
        what: String,
    },
    /// The plan has no such shards.
    #[error("the plan has {shards} shards, numbered from 0, not {first}..{end}; choose some of 0..{shards}")]
    NoSuchShards {
        /// The first requested shard.
        first: u64,
        /// One after the last requested shard.
        end: u64,
        /// The number of shards.
        shards: u64,
    },
    /// The plan lacks something that an export needs.
    #[error("{what}")]
    NoExport {
        /// The missing part, with a remedy.
        what: String,
    },
    /// The caller stopped it.
    #[error("stopped; complete shards are kept, and the same command continues from there")]
    Stopped,
}

impl From<Problem> for DatasetError {
    fn from(problem: Problem) -> Self {
        Self::Description(vec![problem])
    }
}

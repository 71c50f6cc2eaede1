//! Why a data set is not made.

use crate::description::Problem;
use crate::simulation::SimulationError;
use std::io;
use std::path::PathBuf;

/// Why a data set is not made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Mistakes in the plan, or in a world or robot that it names; one line each.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Description(Vec<Problem>),
    /// A sample cannot be taken.
    #[error("sample {sample}: {source}")]
    Sample {
        /// Its number.
        sample: u64,
        /// Why.
        source: SimulationError,
    },
    /// A file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Input {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(
        "cannot write {}: {source}; shards that are complete stay, make room or choose another folder, and run the same command again",
        path.display()
    )]
    Output {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The folder holds something else.
    #[error(
        "{} holds shards of another plan, or of another version of a world, a robot, what they are made of or this program: {what}; choose another folder, or remove that one",
        folder.display()
    )]
    OtherPlan {
        /// Which.
        folder: PathBuf,
        /// What differs.
        what: String,
    },
    /// A file of the data set is not what was written.
    #[error("{}: {what}; remove it and run the same command again, which makes it anew", path.display())]
    Damaged {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The plan has no such shards.
    #[error(
        "the plan has {shards} shards, numbered from 0, and not {first}..{end}; ask for some of 0..{shards}"
    )]
    NoSuchShards {
        /// The first that was asked for.
        first: u64,
        /// One after the last.
        end: u64,
        /// How many there are.
        shards: u64,
    },
    /// The plan has not what a layout needs.
    #[error("{what}")]
    NoExport {
        /// What it has not, and what to do.
        what: String,
    },
    /// It was told to stop.
    #[error("stopped; shards that are complete stay, and the same command goes on from there")]
    Stopped,
}

impl From<Problem> for DatasetError {
    fn from(problem: Problem) -> Self {
        Self::Description(vec![problem])
    }
}

//! What a command can end with, each in one line that says what to do.

use std::{io, path::PathBuf, time::Duration};

use belvedere_bridge::Domain;

use crate::description::Problem;
use crate::picture::PictureError;
use crate::recording::RecordingError;
use crate::rig::RigError;
use crate::simulation::SimulationError;

/// Why a command did not do what was asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// The bridge's own words.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
    /// What is wrong with a robot or a world, one line each.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Description(Vec<Problem>),
    /// The sensors cannot be started.
    #[error(transparent)]
    Rig(RigError),
    /// The simulation cannot be made.
    #[error(transparent)]
    Simulation(SimulationError),
    /// The data set is not made.
    #[error(transparent)]
    Dataset(#[from] crate::dataset::DatasetError),
    /// The system gives no thread.
    #[error("the system gives no thread that sends frames: {0}; end other programs, or raise `ulimit -u`")]
    NoThread(std::io::Error),
    /// The page cannot be served.
    #[error(transparent)]
    View(#[from] crate::view::ViewError),
    /// Streams cannot be carried to or from another machine.
    #[cfg(feature = "link")]
    #[error(transparent)]
    Link(#[from] crate::link::LinkError),
    /// Packets of a lidar cannot be sent.
    #[error("{0}")]
    Packets(String),
    /// Nobody publishes anything.
    #[error(
        "nothing is published in domain \"{0}\": start a simulator (belvedere run --domain {0}), or name its domain with --domain"
    )]
    NoSimulator(Domain),
    /// A simulator is there, the topic is not.
    #[error("no topic {topic} in domain \"{domain}\"; {remedy}")]
    UnknownTopic {
        /// As asked for, with a slash.
        topic: String,
        /// Name of the domain where it was looked for.
        domain: String,
        /// The one that was likely meant, and all of them.
        remedy: String,
    },
    /// The stream is there and silent.
    #[error("{topic} sent nothing for {:.1} s: is the simulator paused?", waited.as_secs_f64())]
    NoFrame {
        /// With a slash.
        topic: String,
        /// How long was waited.
        waited: Duration,
    },
    /// A simulator did not do what it was told.
    #[error("{operation} was refused: {reason}")]
    Refused {
        /// What it was told.
        operation: &'static str,
        /// Its words.
        reason: String,
    },
    /// No simulator, or none that takes commands.
    #[error(
        "no answer from a simulator in domain \"{domain}\" within {:.1} s: start one (belvedere run --domain {domain}), name its domain with --domain, or give it more time with --timeout",
        waited.as_secs_f64()
    )]
    NoAnswer {
        /// Where it was looked for.
        domain: Domain,
        /// How long was waited.
        waited: Duration,
    },
    /// Some of the files of a folder cannot be run.
    #[error(
        "{failed} of {files} files cannot be run; `belvedere check FILE` lists everything that is wrong with one"
    )]
    FilesFail {
        /// How many.
        failed: usize,
        /// Of how many.
        files: usize,
    },
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Input {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file that is no model's.
    #[error("cannot spawn {}, which is {what}; {remedy}", path.display())]
    NotSpawned {
        /// Which.
        path: PathBuf,
        /// What it is.
        what: String,
        /// What can be done.
        remedy: String,
    },
    /// A consumer that is waited for took too long.
    #[error("at {:.3} s of simulated time {error} (--wait-for, --patience)", *time_ns as f64 * 1e-9)]
    HeldUp {
        /// Who, where and how long.
        error: String,
        /// Simulated time in ns.
        time_ns: u64,
    },
    /// Consumers that are waited for have not come.
    #[error(
        "{names} did not come within {:.1} s; start it within that time, or raise --patience",
        waited.as_secs_f64()
    )]
    ConsumersMissing {
        /// Who.
        names: String,
        /// How long was waited.
        waited: Duration,
    },
    /// Consumers that are waited for have left and did not come back.
    #[error(
        "{names} left and did not come back within {:.1} s; no frame was lost; start it again sooner, raise --patience, or end the simulation with --duration",
        waited.as_secs_f64()
    )]
    ConsumersGone {
        /// Who.
        names: String,
        /// How long was waited.
        waited: Duration,
    },
    /// A frame that cannot be shown as a picture.
    #[error("{topic}: {source}")]
    Picture {
        /// With a slash.
        topic: String,
        /// Why.
        source: PictureError,
    },
    /// A file that cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Output {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file that is there, and was not to be replaced.
    #[error("cannot write {}: it is there; choose another name, or replace it with --force", path.display())]
    FileExists {
        /// Which.
        path: PathBuf,
    },
    /// A recording that cannot be written, read or played.
    #[error("cannot {action} {}: {}", path.display(), recording_words(source))]
    Recording {
        /// What was tried.
        action: &'static str,
        /// Which.
        path: PathBuf,
        /// Why.
        source: Box<RecordingError>,
    },
    /// A recording is not all that was sent.
    #[error(
        "frames were lost: {lost}; start the simulator with --wait-for recorder={streams}, use `belvedere run --record`, or allow it with --lossy"
    )]
    FramesLost {
        /// How many of which topics.
        lost: String,
        /// How many streams were followed.
        streams: usize,
    },
    /// A file name that does not say what is wanted.
    #[error("cannot write {}: its name must end in one of {formats}", path.display())]
    Format {
        /// As given.
        path: PathBuf,
        /// Endings that are known.
        formats: &'static str,
    },
    /// Standard output cannot be written; see [`CliError::is_closed_pipe`].
    #[error("cannot write to standard output: {0}")]
    Stdout(#[source] io::Error),
    /// No handler for Ctrl-C could be set.
    #[error("cannot listen for Ctrl-C: {0}")]
    Signal(#[from] ctrlc::Error),
}

/// Why a recording failed, and what to do.
fn recording_words(error: &RecordingError) -> String {
    let remedy = match error {
        RecordingError::Io(source) => match source.kind() {
            io::ErrorKind::AlreadyExists => {
                return "it is there; choose another name, or replace it with --force".into();
            }
            io::ErrorKind::StorageFull => "; what was written can be read; make room, or record elsewhere",
            _ => "",
        },
        RecordingError::Cut => "; what is whole can be replayed",
        RecordingError::NotMcap => "; a file of `belvedere record` is wanted",
        _ => "",
    };
    format!("{error}{remedy}")
}

impl From<RigError> for CliError {
    fn from(error: RigError) -> Self {
        match error {
            RigError::Bridge(error) => Self::Bridge(error),
            RigError::Description(problem) => Self::Description(vec![problem]),
            error => Self::Rig(error),
        }
    }
}

impl From<SimulationError> for CliError {
    fn from(error: SimulationError) -> Self {
        match error {
            SimulationError::Description(problem) => Self::Description(vec![problem]),
            SimulationError::Rig(error) => error.into(),
            error => Self::Simulation(error),
        }
    }
}

impl CliError {
    /// Whether the reader of the output has simply gone (`belvedere echo scan | head`): no error to speak of.
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

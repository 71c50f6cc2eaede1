//! The errors of the commands, each a message in one line with a remedy.

use std::{io, path::PathBuf, time::Duration};

use belvedere_bridge::Domain;

use crate::description::Problem;
use crate::picture::PictureError;
use crate::recording::RecordingError;
use crate::rig::RigError;
use crate::simulation::SimulationError;

/// The reason why a command failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CliError {
    /// An error of the bridge.
    #[error(transparent)]
    Bridge(#[from] belvedere_bridge::Error),
    /// Errors in the files of a robot or a world, one line each.
    #[error("{}", lines(.0))]
    Description(Vec<Problem>),
    /// Errors in the files that were checked, one line each, and the number of all problems.
    #[error("{}\n{counts}", lines(errors))]
    Checked {
        /// The errors.
        errors: Vec<Problem>,
        /// The numbers of errors, warnings and notes.
        counts: String,
    },
    /// The sensors cannot be started.
    #[error(transparent)]
    Rig(RigError),
    /// The simulation cannot be created.
    #[error(transparent)]
    Simulation(SimulationError),
    /// The data set cannot be made.
    #[error(transparent)]
    Dataset(#[from] crate::dataset::DatasetError),
    /// The system cannot start another thread.
    #[error("cannot start a thread: {0}; end other programs, or raise `ulimit -u`")]
    NoThread(std::io::Error),
    /// The page cannot be served.
    #[error(transparent)]
    View(#[from] crate::view::ViewError),
    /// ROS 2's network cannot be used.
    #[error(transparent)]
    Ros2(#[from] crate::ros2::Ros2Error),
    /// A variable of the environment has an unknown value.
    #[error("{name} is \"{value}\"; expected {expected}")]
    Variable {
        /// The variable.
        name: &'static str,
        /// Its value.
        value: String,
        /// Its possible values.
        expected: &'static str,
    },
    /// Streams cannot be sent to or received from another machine.
    #[cfg(feature = "link")]
    #[error(transparent)]
    Link(#[from] crate::link::LinkError),
    /// Packets of a lidar cannot be sent.
    #[error("{0}")]
    Packets(String),
    /// There are no publishers in the domain.
    #[error(
        "nothing is published in domain \"{0}\": start a simulator (belvedere run --domain {0}), or name its domain with --domain"
    )]
    NoSimulator(Domain),
    /// There is a simulator, but not this topic.
    #[error("no topic {topic} in domain \"{domain}\"; {remedy}")]
    UnknownTopic {
        /// The requested topic, with a slash.
        topic: String,
        /// Name of the domain that was searched.
        domain: String,
        /// The topic that was probably meant, or the list of all topics.
        remedy: String,
    },
    /// The stream exists, but sent no frame.
    #[error("{topic} sent nothing for {:.1} s: {}", waited.as_secs_f64(), if *is_published {
        "is the simulator paused?"
    } else {
        "no program publishes it"
    })]
    NoFrame {
        /// The topic, with a slash.
        topic: String,
        /// Whether there is a publisher.
        is_published: bool,
        /// Time waited.
        waited: Duration,
    },
    /// The simulator refused a command.
    #[error("{operation} was refused: {reason}")]
    Refused {
        /// Name of the command.
        operation: &'static str,
        /// The simulator's reason.
        reason: String,
    },
    /// There is no simulator that answers commands.
    #[error(
        "no answer from a simulator in domain \"{domain}\" within {:.1} s: start one (belvedere run --domain {domain}), name its domain with --domain, or give it more time with --timeout",
        waited.as_secs_f64()
    )]
    NoAnswer {
        /// The domain that was searched.
        domain: Domain,
        /// Time waited.
        waited: Duration,
    },
    /// Some of the files of a folder cannot be run.
    #[error(
        "{failed} of {files} files cannot be run; `belvedere check FILE` lists everything that is wrong with one"
    )]
    FilesFail {
        /// The number of files that cannot be run.
        failed: usize,
        /// The number of files checked.
        files: usize,
    },
    /// A file that cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Input {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// A consumer given with --wait-for held up a frame for too long.
    #[error("at {:.3} s of simulated time {error} (--wait-for, --patience)", *time_ns as f64 * 1e-9)]
    HeldUp {
        /// The consumer, the topic and the time waited.
        error: String,
        /// Simulated time in ns.
        time_ns: u64,
    },
    /// Consumers given with --wait-for did not connect.
    #[error(
        "{names} did not come within {:.1} s; start it within that time, or raise --patience",
        waited.as_secs_f64()
    )]
    ConsumersMissing {
        /// Names of the consumers.
        names: String,
        /// Time waited.
        waited: Duration,
    },
    /// Consumers given with --wait-for left and did not come back.
    #[error(
        "{names} left and did not come back within {:.1} s; no frame was lost; start it again sooner, raise --patience, or end the simulation with --duration",
        waited.as_secs_f64()
    )]
    ConsumersGone {
        /// Names of the consumers.
        names: String,
        /// Time waited.
        waited: Duration,
    },
    /// A frame that cannot be drawn as a picture.
    #[error("{topic}: {source}")]
    Picture {
        /// The topic, with a slash.
        topic: String,
        /// The reason.
        source: PictureError,
    },
    /// A file that cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Output {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The output file exists and --force was not given.
    #[error("cannot write {}: the file exists; choose another name, or replace it with --force", path.display())]
    FileExists {
        /// Path of the file.
        path: PathBuf,
    },
    /// A recording that cannot be written, read or played.
    #[error("cannot {action} {}: {}", path.display(), recording_words(source))]
    Recording {
        /// The action that failed, as a verb.
        action: &'static str,
        /// Path of the recording.
        path: PathBuf,
        /// The reason.
        source: Box<RecordingError>,
    },
    /// The recording lacks frames that were sent.
    #[error(
        "frames were lost: {lost}; start the simulator with --wait-for recorder={streams}, use `belvedere run --record`, or allow it with --lossy"
    )]
    FramesLost {
        /// The number of lost frames per topic.
        lost: String,
        /// The number of streams that were recorded.
        streams: usize,
    },
    /// A file name with an unknown extension.
    #[error("cannot write {}: its name must end in one of {formats}", path.display())]
    Format {
        /// The path that was given.
        path: PathBuf,
        /// The supported extensions.
        formats: &'static str,
    },
    /// Standard output cannot be written; see [`CliError::is_closed_pipe`].
    #[error("cannot write to standard output: {0}")]
    Stdout(#[source] io::Error),
    /// The handler for Ctrl-C could not be installed.
    #[error("cannot listen for Ctrl-C: {0}")]
    Signal(#[from] ctrlc::Error),
}

/// Returns the problems, one a line.
fn lines(problems: &[Problem]) -> String {
    problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// Returns the reason why a recording failed, with a remedy.
fn recording_words(error: &RecordingError) -> String {
    let remedy = match error {
        RecordingError::Io(source) => match source.kind() {
            io::ErrorKind::AlreadyExists => {
                return "the file exists; choose another name, or replace it with --force".into();
            }
            io::ErrorKind::StorageFull => "; what was written can be read; make room, or record elsewhere",
            _ => "",
        },
        RecordingError::Cut => "; the complete part can be replayed",
        RecordingError::Damaged { .. } => "; the rest was read, and can be replayed",
        RecordingError::NotMcap => "; choose a file written by `belvedere record` or `run --record`",
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
    /// Returns true if the reader of the output has closed it, as in `belvedere echo scan | head`. This is not reported
    /// as an error.
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Stdout(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

//! `belvedere record`: records the streams of a running simulation.

use super::error::CliError;
use super::follow::{DomainArgs, NAP, listen_for_stop, print_line, seconds, stop_wanted, with_slash};
use super::log::status_lines;
use crate::description::text::count;
use crate::recording::{Compression, Profile, Progress, Recorder, RecorderOptions, about};
use belvedere_bridge::Node;
use indicatif::{HumanBytes, ProgressBar, ProgressStyle};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Default name of the recorder's node.
pub(super) const RECORDER: &str = "recorder";
/// Interval at which new streams are looked for.
const LOOK: Duration = Duration::from_secs(1);

/// Record the streams of a running simulation into an MCAP file, until Ctrl-C.
///
/// Foxglove, Lichtblick, `PlotJuggler` and the mcap tools can open the file: it contains messages of ROS 1, or of ROS 2
/// with --profile ros2, which `ros2 bag play` also takes. `belvedere replay` plays it again, byte for byte. Until the recording is complete, `.active` is appended to the file's name;
/// even after a crash, such a file can be read up to its last second.
///
/// If the simulation was started with --wait-for recorder=STREAMS, no frame is lost. Otherwise frames are lost if this
/// process cannot keep up: they are reported, and the exit code is 1 unless --lossy was given.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere record -o run.mcap
  belvedere record /scan /odom /tf -o scans.mcap --duration 60
  belvedere record -o run.mcap --profile ros2          (for ros2 bag play)
  belvedere run --record run.mcap          (simulator and recorder in one, nothing is lost)
  belvedere info run.mcap
  belvedere replay run.mcap")]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub struct RecordArgs {
    /// Topics, with or without a leading slash [default: all, including those that appear later]. The clock is always
    /// recorded
    topics: Vec<String>,
    /// The file
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    domain: DomainArgs,
    /// The version of ROS whose messages the file contains
    #[arg(long, value_enum, default_value_t)]
    profile: Profile,
    /// Compression of the file
    #[arg(long, value_enum, default_value_t)]
    compression: Compression,
    /// Exit with code 0 even if frames were lost
    #[arg(long)]
    lossy: bool,
    /// Stop after this number of seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
    /// Stop when the simulator ends
    #[arg(long)]
    until_gone: bool,
    /// Name of this recorder, for the simulator's --wait-for
    #[arg(long, value_name = "NAME", default_value = RECORDER)]
    name: String,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Wait for the simulator if it is not running yet
    #[arg(long)]
    wait: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::NoSimulator`], [`CliError::UnknownTopic`]; [`CliError::Recording`] if the file cannot be written;
/// [`CliError::FramesLost`].
pub fn run(args: &RecordArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let node = Node::open(&args.domain.domain, &args.name)?;
    if !args.wait {
        super::follow::check_topics(&node, &args.domain.domain, &args.topics)?;
    }
    let options = RecorderOptions {
        topics: args.topics.clone(),
        profile: args.profile,
        compression: args.compression,
        replace: args.force,
        about: about(&args.domain.domain),
        attachments: Vec::new(),
    };
    let mut recorder = start(node, &args.output, &options)?;
    let started = Instant::now();
    let mut shown = Shown::new(&args.output);
    let mut next_look = started + LOOK;
    let mut seen = false;
    while !stop_wanted() && !recorder.has_failed() {
        let now = Instant::now();
        if args.duration.is_some_and(|duration| now - started >= duration) {
            break;
        }
        let progress = recorder.progress();
        seen |= progress.publishers > 0;
        if args.until_gone && seen && progress.publishers == 0 {
            break;
        }
        if now >= next_look {
            next_look = now + LOOK;
            if let Err(error) = recorder.look() {
                tracing::warn!(%error, "new streams are not recorded");
            }
        }
        shown.refresh(&progress);
        std::thread::sleep(NAP);
    }
    shown.end();
    finish(recorder, &args.output, args.lossy)
}

/// Starts a recorder.
pub(super) fn start(node: Node, path: &Path, options: &RecorderOptions) -> Result<Recorder, CliError> {
    Recorder::start(node, path, options).map_err(|source| CliError::Recording {
        action: "write",
        path: path.to_owned(),
        source: Box::new(source),
    })
}

/// Stops a recorder and prints what was recorded.
pub(super) fn finish(recorder: Recorder, path: &Path, lossy: bool) -> Result<(), CliError> {
    let (progress, missed, active) = (recorder.progress(), recorder.missed(), recorder.active().to_owned());
    let tallies = recorder.finish().map_err(|source| CliError::Recording {
        action: "write",
        path: active,
        source: Box::new(source),
    })?;
    let frames: u64 = tallies.iter().map(|tally| tally.frames).sum();
    print_line(&format!(
        "{}: {}, {}, {}",
        path.display(),
        count(tallies.len() as u64, "stream"),
        count(frames, "frame"),
        HumanBytes(std::fs::metadata(path).map_or(progress.bytes, |metadata| metadata.len())),
    ))?;
    if missed.is_empty() || lossy {
        return Ok(());
    }
    let lost: Vec<String> =
        missed.iter().map(|(topic, count)| format!("{count} of {}", with_slash(topic))).collect();
    Err(CliError::FramesLost { lost: lost.join(", "), streams: tallies.len() })
}

/// Shows progress on a terminal.
struct Shown {
    line: Option<ProgressBar>,
    path: String,
    next: Instant,
}

impl Shown {
    fn new(path: &Path) -> Self {
        let line = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{spinner} {elapsed} {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            status_lines().add(ProgressBar::new_spinner().with_style(style))
        });
        Self { line, path: path.display().to_string(), next: Instant::now() }
    }

    fn refresh(&mut self, progress: &Progress) {
        let Some(line) = &self.line else { return };
        if Instant::now() < self.next {
            return;
        }
        self.next += Duration::from_millis(200);
        let Progress { streams, frames, missed, bytes, .. } = *progress;
        let lost = if missed > 0 { format!(", {missed} lost") } else { String::new() };
        let path = &self.path;
        let [streams, frames] = [count(streams as u64, "stream"), count(frames, "frame")];
        line.set_message(format!("{path}: {streams}, {frames}, {}{lost}", HumanBytes(bytes)));
        line.tick();
    }

    fn end(&self) {
        if let Some(line) = &self.line {
            line.finish_and_clear();
        }
    }
}

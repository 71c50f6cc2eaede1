//! `belvedere replay`: plays a recording in place of a simulator.

use super::error::CliError;
use super::follow::{DomainArgs, listen_for_stop, print_line, seconds, stop_wanted};
use crate::description::text::count;
use crate::recording::{Ending, Pace, Player, PlayerOptions, RecordingError, RecordingReader, Skipping};
use crate::server::attendance::Awaited;
use belvedere_bridge::Node;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Play a recording: publish the same streams with the same frames, as the simulator did.
///
/// Consumers in any language cannot distinguish it from the simulator, except by a flag in the header. `belvedere
/// control pause`, `resume` and `step` work on it; a step goes from one message of the clock to the next.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere replay run.mcap
  belvedere replay run.mcap --rate 0.5 --start 10 --duration 5 --loop
  belvedere replay run.mcap --paused        (then: belvedere control step 10)
  belvedere replay run.mcap --rate max --wait-for recorder=12")]
pub struct ReplayArgs {
    /// The recording
    file: PathBuf,
    #[command(flatten)]
    domain: DomainArgs,
    /// Speed as a factor of real time, or max: as fast as possible
    #[arg(long, value_name = "RATE", value_parser = pace, default_value = "1", allow_negative_numbers = true)]
    rate: Pace,
    /// Skip this number of seconds at the beginning
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "0", allow_negative_numbers = true)]
    start: Duration,
    /// Play this number of recorded seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
    /// Start again at the end
    #[arg(long = "loop")]
    again: bool,
    /// Start paused, until `belvedere control resume` or `step`
    #[arg(long)]
    paused: bool,
    /// Lose no frame to this consumer (the name of its node), and start when it subscribes to a stream (or to the
    /// number of streams after =); may be repeated
    #[arg(long, value_name = "NAME[=STREAMS]")]
    wait_for: Vec<Awaited>,
    /// Longest wait for one of these consumers; after it, the replay names the consumer and exits with code 1 [default:
    /// 10; at the start, when other programs may have to be started first, 60]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "wait_for")]
    patience: Option<Duration>,
}

fn pace(text: &str) -> Result<Pace, String> {
    if text == "max" {
        return Ok(Pace::Max);
    }
    match text.parse() {
        Ok(rate) if rate > 1e-6 && rate < 1e6 => Ok(Pace::Rate(rate)),
        _ => Err("expected a number greater than 0, such as 0.5, or max".into()),
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Recording`] if the file cannot be played; failures of the bridge.
pub fn run(args: &ReplayArgs) -> Result<(), CliError> {
    let failed =
        |source| CliError::Recording { action: "play", path: args.file.clone(), source: Box::new(source) };
    let mut recording = open(&args.file, args.start)?;
    listen_for_stop()?;
    let node = Node::open(&args.domain.domain, "belvedere")?;
    let options = PlayerOptions {
        name: args.file.display().to_string(),
        pace: args.rate,
        start: args.start,
        duration: args.duration,
        paused: args.paused,
        wait_for: args.wait_for.clone(),
        patience: args.patience,
        gives_up: |_| stop_wanted(),
    };
    let mut player = Player::open(node, options).map_err(failed)?;
    tracing::info!(
        "{} in domain {}; a second terminal: belvedere list, belvedere hz TOPIC",
        args.file.display(),
        args.domain.domain
    );
    loop {
        let ending = match player.play(recording, |_| !stop_wanted()) {
            // Everything up to the cut was played.
            Err(error @ RecordingError::Cut) if player.frames() > 0 => {
                tracing::warn!("{}: {error}", args.file.display());
                Ending::Played
            }
            ending => ending.map_err(failed)?,
        };
        if ending == Ending::Stopped || !args.again || stop_wanted() {
            break;
        }
        recording = open(&args.file, args.start)?;
    }
    print_line(&format!("{}: {} played", args.file.display(), count(player.frames(), "frame")))
}

/// Opens a recording, to be read from `start` after its beginning.
pub(super) fn open(
    path: &Path,
    start: Duration,
) -> Result<RecordingReader<Skipping<BufReader<File>>>, CliError> {
    let file = File::open(path).map_err(|source| CliError::Input { path: path.to_owned(), source })?;
    RecordingReader::starting_at(BufReader::with_capacity(1 << 20, file), start).map_err(|source| {
        CliError::Recording { action: "read", path: path.to_owned(), source: Box::new(source) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_positive() {
        assert_eq!(pace("0.5"), Ok(Pace::Rate(0.5)));
        assert_eq!(pace("max"), Ok(Pace::Max));
        for bad in ["0", "-1", "nan", "inf", "fast", ""] {
            assert!(pace(bad).is_err(), "{bad}");
        }
    }
}

//! `belvedere echo`: prints the messages of a topic.

use std::time::{Duration, Instant};

use super::{
    error::CliError,
    follow::{DomainArgs, UntilArgs, each_frame, listen_for_stop, no_frame, print_line, subscribe},
    message::decode,
};

/// Print the messages of a topic.
///
/// The format is that of `rostopic echo`, with messages separated by `---`; long arrays are shortened unless --full is
/// given. With --json, prints one object per line, with all elements; NaN becomes null, infinities become "inf" and "-inf".
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  belvedere echo /odom\n  belvedere echo /scan --count 1 --full\n  belvedere echo /camera/rgb/camera_info --count 1 --json"
)]
pub struct EchoArgs {
    /// The topic, with or without a leading slash
    pub topic: String,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub domain: DomainArgs,
    /// Print one JSON object per line
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub until: UntilArgs,
    /// Print arrays in full, as --json always does
    #[arg(long)]
    pub full: bool,
    /// Wait for the topic if it does not exist yet
    #[arg(long)]
    pub wait: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::UnknownTopic`], [`CliError::NoSimulator`]; [`CliError::NoFrame`] if the time ran out before a frame
/// arrived; failures of the bridge and of standard output.
pub fn run(args: &EchoArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let started = Instant::now();
    let mut subscriber = subscribe(&args.domain.domain, &args.topic, args.wait)?;
    let mut count = 0_u64;
    each_frame(
        &mut subscriber,
        &args.until,
        |frame| {
            count += 1;
            let message = decode(&frame.view(), if args.full || args.json { usize::MAX } else { SHORTENED });
            if args.json {
                print_line(&message.to_json().to_string())
            } else {
                print_line(&format!("{message}---"))
            }
        },
        |_: Duration| Ok(()),
    )?;
    if count == 0 && args.until.duration.is_some() {
        return Err(no_frame(&subscriber, started.elapsed()));
    }
    Ok(())
}

/// Elements of an array that are shown without `--full` and `--json`.
const SHORTENED: usize = 12;

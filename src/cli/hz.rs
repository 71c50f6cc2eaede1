//! `belvedere hz`: measures the rate, jitter and latency of a topic.

use std::time::{Duration, Instant};

use super::{
    error::CliError,
    follow::{
        DomainArgs, UntilArgs, each_frame, listen_for_stop, no_frame, print_line, subscribe, with_slash,
    },
    statistics::StreamStatistics,
};

/// Measure the rate, jitter and latency of a topic.
///
/// Prints a line every second, and a summary at the end. The jitter is the standard deviation of the time between
/// messages. The latency is the time from publishing until the message can be read here. Gaps are messages that were
/// published but did not arrive.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "With --json, one object per line: topic, rate_hz, jitter_ms, latency_us_p50, latency_us_p99, frames, gaps.\n\
                  With --duration or --count in addition, only the summary is printed.\n\n\
                  Examples:\n  belvedere hz /camera/rgb/image_raw\n  belvedere hz scan --duration 5 --json"
)]
pub struct HzArgs {
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
    /// Wait for the topic if it does not exist yet
    #[arg(long)]
    pub wait: bool,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::UnknownTopic`], [`CliError::NoSimulator`]; [`CliError::NoFrame`] if the time ran out before a frame
/// arrived; failures of the bridge and of standard output.
pub fn run(args: &HzArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let started = Instant::now();
    let mut subscriber = subscribe(&args.domain.domain, &args.topic, args.wait)?;
    let topic = with_slash(&args.topic);
    let bounded = args.until.duration.is_some() || args.until.count.is_some();
    let mut whole = StreamStatistics::default();
    let second = std::cell::RefCell::new(StreamStatistics::default());
    let report_second = |_: Duration| {
        let mut second = second.borrow_mut();
        let summary = second.summary();
        second.start_anew();
        match (args.json, bounded) {
            (true, true) => Ok(()),
            (true, false) => print_line(&summary.json(&topic).to_string()),
            (false, _) => print_line(&summary.to_string()),
        }
    };
    each_frame(
        &mut subscriber,
        &args.until,
        |frame| {
            // The frame was sent before this measurement began.
            if frame.is_from_history() {
                return Ok(());
            }
            let (now, latency_ns) = (Instant::now(), frame.age_ns());
            whole.add(now, latency_ns, frame.missed());
            second.borrow_mut().add(now, latency_ns, frame.missed());
            Ok(())
        },
        report_second,
    )?;
    let summary = whole.summary();
    if args.json {
        if bounded {
            print_line(&summary.json(&topic).to_string())?;
        }
    } else {
        print_line(&format!("{topic}: {summary}"))?;
    }
    if summary.frames == 0 && bounded {
        return Err(no_frame(&subscriber, started.elapsed()));
    }
    Ok(())
}

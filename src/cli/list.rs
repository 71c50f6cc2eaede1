//! `belvedere list`: lists the topics of a simulation.

use std::time::{Duration, Instant};

use belvedere_bridge::payload::SensorSettings;
use belvedere_bridge::{Encoding, Kind, Node, StreamInfo, StreamSpec};
use serde_json::json;

use super::{
    error::CliError,
    follow::{DomainArgs, UntilArgs, first, listen_for_stop, print_line, stop_wanted, with_slash},
};

/// List the topics of a running simulation.
///
/// Prints one line per topic: kind, encoding, rate, size, number of publishers and subscribers, and frame. With --count
/// or --duration the list is repeated every second.
#[derive(Clone, Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  belvedere list\n  belvedere list --domain lab --json\n  belvedere list --duration 10"
)]
pub struct ListArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub domain: DomainArgs,
    /// Print one JSON object per topic, each on its own line
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub until: UntilArgs,
}

/// Runs the command.
///
/// # Errors
/// [`CliError::NoSimulator`] if nothing is published; failures of the bridge and of standard output.
pub fn run(args: &ListArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    let node = Node::open(&args.domain.domain, "belvedere list")?;
    let started = Instant::now();
    let repeats = match (args.until.count, args.until.duration) {
        (Some(count), _) => count,
        (None, Some(_)) => u64::MAX,
        (None, None) => 1,
    };
    for round in 0..repeats {
        if round > 0 {
            let next = started + Duration::from_secs(round);
            while Instant::now() < next && !stop_wanted() {
                std::thread::sleep(
                    Duration::from_millis(20).min(next.saturating_duration_since(Instant::now())),
                );
            }
        }
        if stop_wanted()
            || args.until.duration.is_some_and(|duration| round > 0 && started.elapsed() >= duration)
        {
            break;
        }
        let mut streams = node.streams()?;
        if streams.is_empty() && round == 0 {
            return Err(CliError::NoSimulator(args.domain.domain.clone()));
        }
        take_changed_rates(&node, &mut streams)?;
        print(&streams, args.json)?;
    }
    Ok(())
}

/// Longest time to wait for the simulator's sensor settings.
const PATIENCE: Duration = Duration::from_millis(500);

/// Replaces the rates in the streams' attributes, which come from the description, by the sensors' current rates.
fn take_changed_rates(node: &Node, streams: &mut [StreamInfo]) -> Result<(), CliError> {
    let are_published =
        |stream: &StreamInfo| stream.topic == StreamSpec::SENSOR_SETTINGS && stream.publishers > 0;
    if !streams.iter().any(are_published) {
        return Ok(());
    }
    let sensors: Vec<SensorSettings> =
        first(node, StreamSpec::SENSOR_SETTINGS, PATIENCE)?.unwrap_or_default();
    for stream in streams {
        if let Some(sensor) = sensors.iter().find(|sensor| sensor.topics().any(|topic| topic == stream.topic))
        {
            stream.rate_hz = Some(sensor.update_rate.value);
        }
    }
    Ok(())
}

fn print(streams: &[StreamInfo], json: bool) -> Result<(), CliError> {
    if json {
        for stream in streams {
            let object = json!({
                "topic": with_slash(&stream.topic),
                "kind": stream.kind.map(Kind::as_str),
                "encoding": stream.encoding.map(Encoding::as_str),
                "rate_hz": stream.rate_hz,
                "frame_id": stream.frame_id,
                "layers": stream.layers,
                "publishers": stream.publishers,
                "subscribers": stream.subscribers,
                "max_payload_bytes": stream.max_payload_len,
            });
            print_line(&object.to_string())?;
        }
        return Ok(());
    }
    let width = streams.iter().map(|stream| stream.topic.len() + 1).max().unwrap_or(0).max(5);
    print_line(&format!(
        "{:width$}  {:18} {:10} {:>8} {:>12} {:>5} {:>5}  FRAME",
        "TOPIC", "KIND", "ENCODING", "RATE", "BYTES", "PUBS", "SUBS"
    ))?;
    for stream in streams {
        let line = format!(
            "{:width$}  {:18} {:10} {:>8} {:>12} {:>5} {:>5}  {}",
            with_slash(&stream.topic),
            stream.kind.map_or("?", Kind::as_str),
            stream.encoding.map_or("?", Encoding::as_str),
            stream
                .rate_hz
                .map_or_else(|| "-".to_owned(), |rate| format!("{rate:.4} Hz").replace(".0000", "")),
            stream.max_payload_len,
            stream.publishers,
            stream.subscribers,
            if stream.frame_id.is_empty() { "-" } else { &stream.frame_id },
        );
        print_line(&line)?;
    }
    Ok(())
}

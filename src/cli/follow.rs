//! Code shared by the commands that read streams: options, finding a topic, stopping.

use std::{
    io::Write as _,
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use belvedere_bridge::{Domain, Error, Frame, Kind, Node, Subscriber, payload::Message};

use super::error::CliError;
use crate::description::suggestion::did_you_mean_or;

/// The domain of the simulation.
#[derive(Clone, Debug, clap::Args)]
pub struct DomainArgs {
    /// Name of the simulation, as given to `belvedere run --domain`
    #[arg(long, value_name = "NAME", env = "BELVEDERE_DOMAIN", default_value_t, global = true)]
    pub domain: Domain,
}

/// When to stop; without these options, at Ctrl-C.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct UntilArgs {
    /// Stop after this number of seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    pub duration: Option<Duration>,
    /// Stop after this number of messages
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub count: Option<u64>,
}

/// Parses seconds given as a decimal number.
///
/// # Errors
/// A message for the command line if the text is not a number, or is negative or too large.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "expected a number of seconds, such as 2.5".to_owned())?;
    Duration::try_from_secs_f64(seconds)
        .map_err(|_| "expected a number of seconds that is not negative, such as 2.5".to_owned())
}

/// Set by Ctrl-C and termination signals, so that the process can leave the domain cleanly.
static STOP: AtomicBool = AtomicBool::new(false);

/// Longest sleep between two checks of the stop flag.
pub(super) const NAP: Duration = Duration::from_millis(20);

/// Returns true if the user asked the process to stop.
pub(super) fn stop_wanted() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Installs a handler: from now on Ctrl-C, SIGTERM and SIGHUP only make [`stop_wanted`] true.
pub(super) fn listen_for_stop() -> Result<(), CliError> {
    static DONE: OnceLock<()> = OnceLock::new();
    if DONE.set(()).is_ok() {
        ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed))?;
    }
    Ok(())
}

/// Writes one line and flushes it. If the reader is gone, the error is [`CliError::is_closed_pipe`].
pub(super) fn print_line(text: &str) -> Result<(), CliError> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush()).map_err(CliError::Stdout)
}

/// Returns a topic with its leading slash, as ROS shows it.
pub(super) fn with_slash(topic: &str) -> String {
    format!("/{}", topic.trim_start_matches('/'))
}

/// Joins the domain and subscribes to a topic that exists or, with `wait`, may appear later.
pub(super) fn subscribe(domain: &Domain, topic: &str, wait: bool) -> Result<Subscriber, CliError> {
    let node = Node::open(domain, "belvedere")?;
    let subscriber = node.subscriber(topic)?;
    if !wait {
        check_topics(&node, domain, &[subscriber.topic().to_owned()])?;
    }
    Ok(subscriber)
}

/// Returns the error about a stream that sent nothing.
pub(super) fn no_frame(subscriber: &Subscriber, waited: Duration) -> CliError {
    let (topic, is_published) = (with_slash(subscriber.topic()), subscriber.publishers() > 0);
    CliError::NoFrame { topic, is_published, waited }
}

/// Checks that the domain has publishers and that these topics exist.
pub(super) fn check_topics(node: &Node, domain: &Domain, topics: &[String]) -> Result<(), CliError> {
    let streams = node.streams()?;
    // Streams that consumers wait for exist without a publisher.
    if streams.iter().all(|stream| stream.publishers == 0) {
        return Err(CliError::NoSimulator(domain.clone()));
    }
    let names: Vec<String> = streams.iter().map(|stream| with_slash(&stream.topic)).collect();
    match topics.iter().map(|topic| with_slash(topic)).find(|topic| !names.contains(topic)) {
        None => Ok(()),
        Some(topic) => Err(CliError::UnknownTopic {
            remedy: did_you_mean_or(
                &topic,
                names.iter().map(String::as_str),
                &format!("there are: {}", names.join(", ")),
            ),
            domain: domain.to_string(),
            topic,
        }),
    }
}

/// Returns the topic of the first stream of one of these kinds, which are tried in order.
pub(super) fn first_of_kinds(node: &Node, kinds: &[Kind]) -> Result<Option<String>, CliError> {
    let streams = node.streams()?;
    let of = |kind| streams.iter().find(|stream| stream.kind == Some(kind));
    Ok(kinds.iter().find_map(|kind| of(*kind)).map(|stream| with_slash(&stream.topic)))
}

/// Returns the structs of the first frame, if one arrives in time.
pub(super) fn first<T: Message>(
    node: &Node,
    topic: &str,
    patience: Duration,
) -> Result<Option<Vec<T>>, CliError> {
    let mut subscriber = node.subscriber(topic)?;
    if !subscriber.wait(patience)? {
        return Ok(None);
    }
    let Some(frame) = subscriber.take()? else { return Ok(None) };
    let structs = frame.view().structs().map(Iterator::collect);
    Ok(Some(structs.map_err(|error| Error::Frame { topic: topic.to_owned(), error })?))
}

/// Passes on frames until the user stops it, or the time or the count is reached; calls `on_second` about every second.
pub(super) fn each_frame(
    subscriber: &mut Subscriber,
    until: &UntilArgs,
    mut on_frame: impl FnMut(Frame) -> Result<(), CliError>,
    mut on_second: impl FnMut(Duration) -> Result<(), CliError>,
) -> Result<(), CliError> {
    let started = Instant::now();
    let mut next_second = started + Duration::from_secs(1);
    let mut count = 0;
    loop {
        let now = Instant::now();
        if stop_wanted() || until.duration.is_some_and(|duration| now - started >= duration) {
            return Ok(());
        }
        if now >= next_second {
            on_second(now - started)?;
            next_second += Duration::from_secs(1);
        }
        let end = until.duration.map_or(next_second, |duration| next_second.min(started + duration));
        let patience = end.saturating_duration_since(now).min(Duration::from_millis(200));
        if subscriber.wait(patience)? {
            while let Some(frame) = subscriber.take()? {
                on_frame(frame)?;
                count += 1;
                if until.count.is_some_and(|wanted| count >= wanted) {
                    return Ok(());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_not_negative() {
        assert_eq!(seconds("2.5"), Ok(Duration::from_millis(2500)));
        for bad in ["", "x", "-1", "nan", "inf", "1e300"] {
            assert!(seconds(bad).is_err(), "{bad}");
        }
    }
}

//! `belvedere link`: exchanges streams with other machines.

use super::error::CliError;
use super::follow::{DomainArgs, NAP, listen_for_stop, print_line, seconds, stop_wanted, with_slash};
use super::log::status_lines;
use crate::description::text::count;
use crate::link::{
    CarriedCommands, Endpoints, LinkError, LinkProgress, LinkReceiver, LinkSender, ReceiverOptions,
    SenderOptions,
};
use belvedere_bridge::{Domain, Node};
use indicatif::{HumanBytes, ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

/// Name of the node, as shown in listings.
const NAME: &str = "link";
/// Time between two status lines on a terminal.
const REFRESH: Duration = Duration::from_secs(1);
/// Time between two log lines without a terminal.
const REPORT: Duration = Duration::from_secs(10);

/// Exchange streams with another machine, over Zenoh.
///
/// On the simulator's machine `send` offers its streams. On the other machine `receive` publishes them in that
/// machine's shared memory, where consumers in any language cannot distinguish them from the simulator's. Commands are
/// sent in the other direction. A stream without subscribers on the other machine is neither sent nor rendered. Either
/// side can be started first, stopped and started again. An interrupted connection only loses frames, which are
/// counted.
///
/// There is no encryption and no authentication: anyone who can reach the port can read the streams and drive the
/// robots. Use it in a trusted network, in a VPN, or through ssh.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Examples:
  belvedere link send --listen tcp/10.0.0.1:7447          (10.0.0.1, where belvedere run runs)
  belvedere link receive --connect tcp/10.0.0.1:7447      (another machine; then: belvedere hz /scan)
  belvedere link send --listen tcp/127.0.0.1:7447         (through ssh: ssh -L 7447:127.0.0.1:7447 simulator)")]
pub struct LinkArgs {
    #[command(subcommand)]
    role: Role,
}

#[derive(Clone, Debug, clap::Subcommand)]
enum Role {
    /// Offer the streams of the simulator on this machine to other machines, and accept their commands
    Send {
        /// Topics, with or without a leading slash [default: all, including those that appear later]
        topics: Vec<String>,
        #[command(flatten)]
        domain: DomainArgs,
        #[command(flatten)]
        way: WayArgs,
        /// Commands that are accepted from other machines: none; those to robots; or also those to the simulation, such
        /// as pause and spawn
        #[arg(long, value_enum, default_value_t)]
        commands: CarriedCommands,
    },
    /// Publish the streams of a simulator on another machine here
    Receive {
        /// Topics, with or without a leading slash [default: all, including those that appear later]
        topics: Vec<String>,
        #[command(flatten)]
        domain: DomainArgs,
        /// The simulator's domain on the other machine, if it differs from the one here
        #[arg(long, value_name = "NAME")]
        from: Option<Domain>,
        /// Limit of the shared memory for all streams together, in MiB [default: half of what is free at the start]
        #[arg(long, value_name = "MIB", value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
        memory: Option<u64>,
        #[command(flatten)]
        way: WayArgs,
    },
}

/// The addresses of the connection.
#[derive(Clone, Debug, clap::Args)]
#[group(id = "way")]
struct WayArgs {
    /// Address at which to wait for the other machine; may be repeated. This or --connect is required
    #[arg(long, value_name = "tcp/HOST:PORT", value_parser = address, required_unless_present = "connect")]
    listen: Vec<String>,
    /// Address of the other machine, or of a Zenoh router; connection attempts are repeated; may be given several times
    #[arg(long, value_name = "tcp/HOST:PORT", value_parser = address)]
    connect: Vec<String>,
    /// Stop after this number of seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    duration: Option<Duration>,
}

fn address(text: &str) -> Result<String, String> {
    let host_and_port = text.strip_prefix("tcp/").and_then(|rest| rest.rsplit_once(':'));
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-._[]:%".contains(c);
    match host_and_port {
        Some((host, port))
            if !host.is_empty()
                && host.chars().all(is_name)
                && port.parse::<u16>().is_ok_and(|port| port > 0) =>
        {
            Ok(text.to_owned())
        }
        _ => Err("expected an address such as tcp/10.0.0.1:7447 or tcp/robot.local:7447".into()),
    }
}

/// Runs the command.
///
/// # Errors
/// [`CliError::Link`] if it is not possible to listen at an address; failures of the bridge, for example if the domain
/// already has a simulator.
pub fn run(args: &LinkArgs) -> Result<(), CliError> {
    listen_for_stop()?;
    match &args.role {
        Role::Send { topics, domain, way, commands } => {
            let node = Node::open(&domain.domain, NAME)?;
            let options =
                SenderOptions { endpoints: endpoints(way), topics: topics.clone(), commands: *commands };
            let mut link = LinkSender::open(node, options)?;
            let said = format!("domain {} is available to other machines", domain.domain);
            let attended = attend(way, &said, &mut link, LinkSender::tend, LinkSender::progress);
            let counts = link.by_topic();
            link.close();
            attended.and_then(|()| summary("sent", &counts))
        }
        Role::Receive { topics, domain, from, memory, way } => {
            let node = Node::open(&domain.domain, NAME)?;
            let from = from.clone().unwrap_or_else(|| domain.domain.clone());
            let said = format!("domain {} receives domain {from} of the other machine", domain.domain);
            let memory = memory.map(|mib| mib << 20);
            let options = ReceiverOptions { endpoints: endpoints(way), from, topics: topics.clone(), memory };
            let mut link = LinkReceiver::open(node, options)?;
            let attended = attend(way, &said, &mut link, LinkReceiver::tend, LinkReceiver::progress);
            let counts = link.by_topic();
            link.close();
            attended.and_then(|()| summary("received", &counts))
        }
    }
}

fn endpoints(way: &WayArgs) -> Endpoints {
    Endpoints { listen: way.listen.clone(), connect: way.connect.clone() }
}

/// Runs a link until the user or --duration stops it.
fn attend<L>(
    way: &WayArgs,
    said: &str,
    link: &mut L,
    tend: impl Fn(&mut L) -> Result<(), LinkError>,
    progress: impl Fn(&L) -> LinkProgress,
) -> Result<(), CliError> {
    tracing::info!("{said}; press Ctrl-C to stop");
    let started = Instant::now();
    let mut shown = Shown::new();
    let mut complaint = String::new();
    while !stop_wanted() && way.duration.is_none_or(|duration| started.elapsed() < duration) {
        match tend(link) {
            Ok(()) => {}
            Err(error @ LinkError::Bridge(belvedere_bridge::Error::DomainInUse { .. })) => {
                shown.end();
                return Err(error.into());
            }
            // The link tries again; the same error is not logged twice.
            Err(error) if error.to_string() == complaint => {}
            Err(error) => {
                tracing::warn!(%error, "trying again");
                complaint = error.to_string();
            }
        }
        shown.refresh(|| progress(link));
        std::thread::sleep(NAP);
    }
    shown.end();
    Ok(())
}

/// Prints the number of frames sent or received, and lost, per topic.
fn summary(verb: &str, counts: &BTreeMap<String, (u64, u64)>) -> Result<(), CliError> {
    let width = counts.keys().map(String::len).max().unwrap_or(0) + 1;
    for (topic, (frames, lost)) in counts {
        print_line(&format!("{:width$} {}, {lost} lost", with_slash(topic), count(*frames, "frame")))?;
    }
    let (frames, lost) = counts.values().fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    print_line(&format!("{} {verb}, {lost} lost", count(frames, "frame")))
}

/// Shows progress: a live line on a terminal, else a log line from time to time.
struct Shown {
    line: Option<ProgressBar>,
    next: Instant,
    before: (Instant, LinkProgress),
}

impl Shown {
    fn new() -> Self {
        let line = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{spinner} {elapsed} {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_spinner());
            status_lines().add(ProgressBar::new_spinner().with_style(style))
        });
        let now = Instant::now();
        let period = if line.is_some() { REFRESH } else { REPORT };
        Self { line, next: now + period, before: (now, LinkProgress::default()) }
    }

    fn refresh(&mut self, progress: impl FnOnce() -> LinkProgress) {
        let now = Instant::now();
        if now < self.next {
            return;
        }
        let progress = progress();
        let (then, before) = std::mem::replace(&mut self.before, (now, progress));
        let text = words(&before, &progress, (now - then).as_secs_f64());
        if let Some(line) = &self.line {
            self.next = now + REFRESH;
            line.set_message(text);
            line.tick();
        } else {
            self.next = now + REPORT;
            tracing::info!("{text}");
        }
    }

    fn end(&self) {
        if let Some(line) = &self.line {
            line.finish_and_clear();
        }
    }
}

fn words(before: &LinkProgress, now: &LinkProgress, seconds: f64) -> String {
    let a_second = |before: u64, now: u64| now.saturating_sub(before) as f64 / seconds.max(1e-9);
    let LinkProgress { peers, streams, carried, commands, lost, refused, .. } = *now;
    let refused = if refused > 0 { format!(", {refused} refused") } else { String::new() };
    format!(
        "{peers} connected, {carried} of {} active, {:.0} frames/s, {}/s, {}, {lost} lost{refused}",
        count(streams as u64, "stream"),
        a_second(before.frames, now.frames),
        HumanBytes(a_second(before.bytes, now.bytes) as u64),
        count(commands, "command"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_hosts_and_ports() {
        for good in ["tcp/10.0.0.1:7447", "tcp/[::1]:7447", "tcp/robot.local:1", "tcp/[fe80::1%eth0]:7447"] {
            assert_eq!(address(good).as_deref(), Ok(good));
        }
        for bad in [
            "",
            "10.0.0.1:7447",
            "udp/10.0.0.1:7447",
            "tcp/:7447",
            "tcp/10.0.0.1",
            "tcp/a:0",
            "tcp/a:65536",
            "tcp/a b:7447",
            "tcp/a:7447#iface=eth0",
            "tcp/a:7447?rel=0",
        ] {
            assert!(address(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn rates_are_counted_since_the_previous_line() {
        let before = LinkProgress { frames: 100, bytes: 1000, ..LinkProgress::default() };
        let now = LinkProgress {
            peers: 1,
            streams: 9,
            carried: 3,
            frames: 130,
            bytes: 1000 + (2 << 20),
            lost: 4,
            ..before
        };
        let said = "1 connected, 3 of 9 streams active, 15 frames/s, 1.00 MiB/s, 0 commands, 4 lost";
        assert_eq!(words(&before, &now, 2.0), said);
    }
}

//! [`LinkSender`]: the sending side, on the simulator's machine.

use super::LinkError;
use super::tally::{LinkProgress, Tallies, Tally};
use super::transport::{Endpoints, Inlet, Outlet, Transport, Urgency};
use super::wire::{self, Announcement, Described};
use belvedere_bridge::{Encoding, Kind, Node, Publisher, StreamSpec, Subscriber};
use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which new streams are looked for. Each search was measured to take 40 ms of CPU time.
const LOOK: Duration = Duration::from_secs(1);
/// Interval at which the streams are announced, and latched messages are sent again.
const ANNOUNCE: Duration = Duration::from_secs(1);
/// Interval at which the thread of a stream without subscribers checks for new ones.
const NAP: Duration = Duration::from_millis(20);
/// Interval at which a thread that waits for frames checks that there are still subscribers.
const WAIT: Duration = Duration::from_millis(100);

/// The commands that are accepted from the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum CarriedCommands {
    /// None: other machines can only receive.
    None,
    /// Commands to robots: velocities, and those of a Kobuki.
    #[default]
    Robots,
    /// Also commands to the simulation: pause, step, reset, move, configure; and spawn, whose text may name files of
    /// this machine.
    All,
}

/// Options of a sender.
#[derive(Debug, Clone, Default)]
pub struct SenderOptions {
    /// Addresses of the connection to other machines.
    pub endpoints: Endpoints,
    /// Topics, with or without a leading slash; all if the list is empty.
    pub topics: Vec<String>,
    /// Commands that are accepted from there.
    pub commands: CarriedCommands,
}

/// Sends the streams of a domain to other machines, each for as long as it has subscribers there, and passes their
/// commands on to the domain.
///
/// It is an ordinary consumer with a thread for each stream. A slow network loses frames, but does not slow down the
/// simulator.
pub struct LinkSender {
    node: Node,
    options: SenderOptions,
    wanted: BTreeSet<String>,
    transport: Transport,
    announcements: Outlet,
    carriers: BTreeMap<String, Carrier>,
    /// Threads of streams that have ended, which may still be waiting for the network.
    ending: Vec<JoinHandle<()>>,
    tallies: Tallies,
    next_look: Instant,
    next_announcement: Instant,
}

/// An announced stream.
struct Carrier {
    described: Described,
    way: Way,
}

enum Way {
    /// A stream from the robot.
    Out { stop: Arc<AtomicBool>, thread: JoinHandle<()> },
    /// Commands to the robot.
    In { _inlet: Inlet, end: Arc<Mutex<CommandEnd>> },
}

impl LinkSender {
    /// Opens the connection to other machines.
    ///
    /// # Errors
    /// If it is not possible to listen at an address.
    pub fn open(node: Node, options: SenderOptions) -> Result<Self, LinkError> {
        let transport = Transport::open(&options.endpoints)?;
        let key = wire::announcement_key(node.domain().as_str());
        let announcements = transport.outlet(key, Urgency::Message)?;
        let wanted = options.topics.iter().map(|topic| topic.trim_start_matches('/').to_owned()).collect();
        let now = Instant::now();
        Ok(Self {
            node,
            options,
            wanted,
            transport,
            announcements,
            carriers: BTreeMap::new(),
            ending: Vec::new(),
            tallies: Tallies::default(),
            next_look: now,
            next_announcement: now,
        })
    }

    /// Handles streams that come and go. To be called about fifty times a second.
    ///
    /// # Errors
    /// If streams cannot be listed or opened; the other streams continue.
    pub fn tend(&mut self) -> Result<(), LinkError> {
        let now = Instant::now();
        let looked = if now >= self.next_look {
            self.next_look = now + LOOK;
            self.look()
        } else {
            Ok(())
        };
        if now >= self.next_announcement {
            self.next_announcement = now + ANNOUNCE;
            let streams = self.carriers.values().map(|carrier| carrier.described.clone()).collect();
            self.announcements.put(Announcement::new(streams).to_bytes())?;
        }
        looked
    }

    fn look(&mut self) -> Result<(), LinkError> {
        let infos = self.node.streams()?;
        let described = infos.iter().filter_map(Described::new);
        let here: BTreeMap<String, (Described, StreamSpec)> = described
            .filter_map(|described| {
                let spec = described.spec()?;
                self.is_carried(&spec).then(|| (described.topic.clone(), (described, spec)))
            })
            .collect();
        let is_same = |topic: &str, carrier: &Carrier| {
            here.get(topic).is_some_and(|(described, _)| *described == carrier.described)
        };
        let gone = self.carriers.iter().filter(|(topic, carrier)| !is_same(topic, carrier));
        for topic in gone.map(|(topic, _)| topic.clone()).collect::<Vec<_>>() {
            if let Some(carrier) = self.carriers.remove(&topic) {
                self.end(carrier);
            }
        }
        self.ending.retain(|thread| !thread.is_finished());
        let mut done = Ok(());
        for (topic, (described, spec)) in here {
            if !self.carriers.contains_key(&topic) {
                match self.carrier(described, spec) {
                    Ok(carrier) => {
                        self.carriers.insert(topic, carrier);
                        self.next_announcement = Instant::now();
                    }
                    // The next search tries again; the other streams do not wait for this one.
                    Err(error) => done = Err(error),
                }
            }
        }
        done
    }

    fn is_carried(&self, spec: &StreamSpec) -> bool {
        let commands = self.options.commands;
        let is_allowed = match spec.kind {
            Kind::SimulationCommand | Kind::SimulationResult => commands == CarriedCommands::All,
            kind if wire::is_command(kind) => commands != CarriedCommands::None,
            _ => true,
        };
        is_allowed && (self.wanted.is_empty() || self.wanted.contains(&spec.topic))
    }

    fn carrier(&self, described: Described, spec: StreamSpec) -> Result<Carrier, LinkError> {
        let domain = self.node.domain().as_str();
        let is_command = wire::is_command(spec.kind);
        let tally = self.tallies.of(&spec.topic, is_command);
        let way = if is_command {
            let key = wire::command_key(domain, &spec.topic);
            tally.is_carried.store(true, Ordering::Relaxed);
            let end = CommandEnd { node: self.node.clone(), spec, publisher: None, tally };
            let end = Arc::new(Mutex::new(end));
            let taker = end.clone();
            let inlet = self.transport.inlet(key.clone(), move |said, message| {
                let mut end = taker.lock().unwrap_or_else(PoisonError::into_inner);
                let is_right = wire::is_at(said, &key).map_err(Into::into);
                let taken = is_right.and_then(|()| end.take(message.reader(), message.len()));
                if let Err(error) = taken {
                    end.tally.refuse(&end.spec.topic, &error);
                }
            })?;
            Way::In { _inlet: inlet, end }
        } else {
            let urgency = if spec.encoding == Encoding::Struct { Urgency::Message } else { Urgency::Bulk };
            let outlet = self.transport.outlet(wire::frame_key(domain, &spec.topic), urgency)?;
            let stop = Arc::new(AtomicBool::new(false));
            let (node, stopped) = (self.node.clone(), stop.clone());
            let thread = std::thread::Builder::new()
                .name("link stream".into())
                .spawn(move || carry(&node, &spec, &outlet, &stopped, &tally))?;
            Way::Out { stop, thread }
        };
        Ok(Carrier { described, way })
    }

    fn end(&mut self, carrier: Carrier) {
        match carrier.way {
            Way::Out { stop, thread } => {
                stop.store(true, Ordering::Relaxed);
                self.ending.push(thread);
            }
            // A message that is being received may still hold `end`.
            Way::In { end, .. } => {
                let mut end = end.lock().unwrap_or_else(PoisonError::into_inner);
                end.publisher = None;
                end.tally.is_carried.store(false, Ordering::Relaxed);
            }
        }
    }

    /// Returns the progress.
    pub fn progress(&self) -> LinkProgress {
        let streams = self.carriers.len();
        LinkProgress { peers: self.transport.peers(), streams, ..self.tallies.sum() }
    }

    /// Returns the numbers of carried and lost frames per topic.
    pub fn by_topic(&self) -> BTreeMap<String, (u64, u64)> {
        self.tallies.by_topic()
    }

    /// Announces to the other machines that there are no more streams, and ends the link.
    pub fn close(mut self) {
        for (_, carrier) in std::mem::take(&mut self.carriers) {
            self.end(carrier);
        }
        if self.announcements.is_wanted()
            && let Err(error) = self.announcements.put(Announcement::new(Vec::new()).to_bytes())
        {
            tracing::debug!(%error, "the end could not be announced to the other side");
        }
        self.transport.close();
        for thread in self.ending {
            // A panic of the thread has already been reported.
            let _ = thread.join();
        }
    }
}

/// Sends a stream while it has subscribers on other machines.
fn carry(node: &Node, spec: &StreamSpec, outlet: &Outlet, stop: &AtomicBool, tally: &Tally) {
    let mut subscriber: Option<Subscriber> = None;
    let mut kept = Kept::default();
    while !stop.load(Ordering::Relaxed) {
        let is_wanted = outlet.is_wanted();
        tally.is_carried.store(is_wanted, Ordering::Relaxed);
        if !is_wanted {
            // Without a subscription the stream is not rendered.
            subscriber = None;
            std::thread::sleep(NAP);
            continue;
        }
        let carried = match &mut subscriber {
            Some(subscriber) => carry_next(subscriber, spec, outlet, tally, &mut kept),
            None => node.subscriber(&spec.topic).map(|new| subscriber = Some(new)).map_err(LinkError::from),
        };
        if let Err(error) = carried {
            tracing::warn!(topic = spec.topic, %error, "a frame was not sent");
            std::thread::sleep(NAP);
        }
    }
    tally.is_carried.store(false, Ordering::Relaxed);
}

/// The last message of a latched stream, which is sent again for new receivers.
#[derive(Default)]
struct Kept {
    message: Option<Vec<u8>>,
    sent: Option<Instant>,
}

fn carry_next(
    subscriber: &mut Subscriber,
    spec: &StreamSpec,
    outlet: &Outlet,
    tally: &Tally,
    kept: &mut Kept,
) -> Result<(), LinkError> {
    if !subscriber.wait(WAIT)? {
        if let Some(message) = &kept.message
            && kept.sent.is_none_or(|sent| sent.elapsed() >= ANNOUNCE)
        {
            kept.sent = Some(Instant::now());
            outlet.put(message.clone())?;
        }
        return Ok(());
    }
    // Only the newest image is sent, but every message, such as transforms.
    let frame = match spec.encoding {
        Encoding::Struct => subscriber.take()?,
        _ => subscriber.take_newest()?,
    };
    let Some(frame) = frame else { return Ok(()) };
    tally.lose(frame.missed());
    let message = wire::frame(frame.header(), frame.payload());
    let bytes = frame.payload().len();
    // Released before waiting for the network, so that the stream's memory is free again.
    drop(frame);
    if matches!(spec.kind, Kind::StaticTransforms | Kind::SensorSettings) {
        *kept = Kept { message: Some(message.clone()), sent: Some(Instant::now()) };
    }
    if outlet.put(message)? {
        tally.carry(bytes);
    } else {
        tally.lose(1);
    }
    Ok(())
}

/// Publishes received commands in this machine's domain.
struct CommandEnd {
    node: Node,
    spec: StreamSpec,
    /// Opened at the first command, so that a machine that only receives takes no publisher's place; opened again for
    /// longer commands.
    publisher: Option<Publisher>,
    tally: Arc<Tally>,
}

impl CommandEnd {
    fn take(
        &mut self,
        mut message: impl std::io::Read,
        len: usize,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let header = wire::header(&mut message, len, &self.spec)?;
        let len = header.payload_len as usize;
        let publisher = match self.publisher.take() {
            Some(publisher) if publisher.max_payload_len() >= len => publisher,
            smaller => {
                // Closed first, because a stream has few places for publishers.
                drop(smaller);
                let max_payload_len = self.spec.max_payload_len.max(len);
                self.node.publisher(&StreamSpec { max_payload_len, ..self.spec.clone() })?
            }
        };
        let publisher = self.publisher.insert(publisher);
        let mut frame = publisher.loan(len)?;
        message.read_exact(frame.payload_mut())?;
        *frame.header_mut() = header;
        frame.send()?;
        self.tally.carry(len);
        Ok(())
    }
}

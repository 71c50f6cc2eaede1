//! [`Mirror`]: publishes a stream of the simulator's machine in this machine's shared memory.

use super::LinkError;
use super::tally::Tally;
use super::transport::{Inlet, Outlet, Transport, Urgency};
use super::wire::{self, Described};
use belvedere_bridge::{Domain, Kind, Node, Publisher, StreamSpec, Subscriber};
use std::error::Error;
use std::io::Read;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Longest sleep of a command stream's thread between two checks of the stop flag.
const NAP: Duration = Duration::from_millis(50);

/// A stream of the other machine.
pub(super) struct Mirror {
    described: Described,
    pool_bytes: u64,
    way: Way,
}

enum Way {
    /// A stream from the robot.
    In {
        key: String,
        /// `None` while the stream has no subscribers here. It is then neither sent over the network nor rendered.
        inlet: Option<Inlet>,
        end: Arc<Mutex<FrameEnd>>,
    },
    /// Commands to the robot.
    Out { stop: Arc<AtomicBool>, thread: JoinHandle<()> },
}

impl Mirror {
    pub(super) fn open(
        node: &Node,
        transport: &Transport,
        from: &Domain,
        described: &Described,
        spec: StreamSpec,
        tally: Arc<Tally>,
    ) -> Result<Self, LinkError> {
        let pool_bytes = wire::pool_bytes(&spec);
        let way = if wire::is_command(spec.kind) {
            let commands = node.command_subscriber(&spec)?;
            let key = wire::command_key(from.as_str(), &spec.topic);
            let outlet = transport.outlet(key, Urgency::Command)?;
            let stop = Arc::new(AtomicBool::new(false));
            let stopped = stop.clone();
            let thread = std::thread::Builder::new()
                .name("link commands".into())
                .spawn(move || hand_back(commands, spec.kind, &outlet, &stopped, &tally))?;
            Way::Out { stop, thread }
        } else {
            let key = wire::frame_key(from.as_str(), &spec.topic);
            let publisher = Some(node.publisher(&spec)?);
            let end = FrameEnd { spec, publisher, last: None, tally };
            Way::In { key, inlet: None, end: Arc::new(Mutex::new(end)) }
        };
        Ok(Self { described: described.clone(), pool_bytes, way })
    }

    /// Returns true if the stream still matches the other side's announcement.
    pub(super) fn is_of(&self, described: &Described) -> bool {
        self.described == *described
    }

    /// Returns the bytes of shared memory that its frames may take.
    pub(super) fn pool_bytes(&self) -> u64 {
        self.pool_bytes
    }

    /// Receives the stream from the network while it has subscribers here. With `update`, sends latched frames to new
    /// subscribers.
    pub(super) fn tend(&mut self, transport: &Transport, update: bool) -> Result<(), LinkError> {
        let Way::In { key, inlet, end } = &mut self.way else { return Ok(()) };
        let is_wanted = {
            let mut end = end.lock().unwrap_or_else(PoisonError::into_inner);
            let Some(publisher) = &end.publisher else { return Ok(()) };
            if update {
                publisher.update()?;
            }
            // The last message of a latched stream must be here for new subscribers, and results must be received
            // before a command is sent.
            let is_always = end.spec.history > 0 || end.spec.kind == Kind::SimulationResult;
            let is_wanted = is_always || publisher.subscribers() > 0;
            if is_wanted != inlet.is_some() {
                // Frames that are sent while there are no subscribers do not count as lost.
                end.last = None;
                end.tally.is_carried.store(is_wanted, Ordering::Relaxed);
            }
            is_wanted
        };
        // Done without the lock, because the inlet's thread takes it.
        if !is_wanted {
            *inlet = None;
        } else if inlet.is_none() {
            let (taker, key) = (end.clone(), key.clone());
            *inlet = Some(transport.inlet(key.clone(), move |said, message| {
                let mut end = taker.lock().unwrap_or_else(PoisonError::into_inner);
                let is_right = wire::is_at(said, &key).map_err(Into::into);
                let taken = is_right.and_then(|()| end.take(message.reader(), message.len()));
                if let Err(error) = taken {
                    end.tally.refuse(&end.spec.topic, &error);
                }
            })?);
        }
        Ok(())
    }

    /// Ends the mirror. Returns its thread, if any, which may still be waiting for the network.
    pub(super) fn end(self) -> Option<JoinHandle<()>> {
        match self.way {
            Way::In { inlet, end, .. } => {
                drop(inlet);
                // A message that is being received may still hold `end`, but the publisher's place must be free at
                // once.
                let mut end = end.lock().unwrap_or_else(PoisonError::into_inner);
                end.publisher = None;
                end.tally.is_carried.store(false, Ordering::Relaxed);
                None
            }
            Way::Out { stop, thread } => {
                stop.store(true, Ordering::Relaxed);
                Some(thread)
            }
        }
    }
}

/// Publishes frames from the network.
struct FrameEnd {
    spec: StreamSpec,
    publisher: Option<Publisher>,
    /// Session and number of the previous frame.
    last: Option<(u64, u64)>,
    tally: Arc<Tally>,
}

impl FrameEnd {
    fn take(&mut self, mut message: impl Read, len: usize) -> Result<(), Box<dyn Error>> {
        let Some(publisher) = &self.publisher else { return Ok(()) };
        let header = wire::header(&mut message, len, &self.spec)?;
        let lost = match self.last {
            // Latched messages are sent again and again.
            Some(last) if last == (header.session, header.seq) => return Ok(()),
            Some((session, seq)) if session == header.session => {
                header.seq.saturating_sub(seq).saturating_sub(1)
            }
            _ => 0,
        };
        let mut frame = publisher.loan(header.payload_len as usize)?;
        message.read_exact(frame.payload_mut())?;
        *frame.header_mut() = header;
        frame.relay(header.session, header.seq)?;
        self.last = Some((header.session, header.seq));
        self.tally.lose(lost);
        self.tally.carry(header.payload_len as usize);
        Ok(())
    }
}

/// Sends commands from this machine's consumers to the simulator's machine.
fn hand_back(mut commands: Subscriber, kind: Kind, outlet: &Outlet, stop: &AtomicBool, tally: &Tally) {
    let mut is_reported = false;
    while !stop.load(Ordering::Relaxed) {
        let is_wanted = outlet.is_wanted();
        tally.is_carried.store(is_wanted, Ordering::Relaxed);
        is_reported &= !is_wanted;
        let taken = match commands.wait(NAP) {
            Ok(false) => Ok(None),
            // Every command to the simulation needs an answer. Of the others only the newest counts.
            Ok(true) if kind == Kind::SimulationCommand => commands.take(),
            Ok(true) => commands.take_newest(),
            Err(error) => Err(error),
        };
        match taken {
            Ok(None) => {}
            Ok(Some(_)) if !is_wanted => {
                tally.lose(1);
                if !is_reported {
                    is_reported = true;
                    tracing::warn!(
                        topic = commands.topic(),
                        "a command is lost: it has no subscriber on the other machine"
                    );
                }
            }
            Ok(Some(frame)) => {
                let (message, bytes) = (wire::frame(frame.header(), frame.payload()), frame.payload().len());
                drop(frame);
                match outlet.put(message) {
                    Ok(true) => tally.carry(bytes),
                    Ok(false) => tally.lose(1),
                    Err(error) => {
                        tally.lose(1);
                        tracing::warn!(topic = commands.topic(), %error, "a command is lost");
                    }
                }
            }
            Err(error) => {
                tracing::warn!(topic = commands.topic(), %error, "commands cannot be read");
                std::thread::sleep(NAP);
            }
        }
    }
    tally.is_carried.store(false, Ordering::Relaxed);
}

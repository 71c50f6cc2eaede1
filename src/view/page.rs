//! The protocol of the page. It requests each frame, so that a slow page gets fewer, and streams that no panel shows
//! are not rendered.
//!
//! | message of the page | meaning |
//! |---|---|
//! | `{"op":"next","topic":T,"frames":N}` | send the next frame of T, or the next two; if frames already wait, the newest |
//! | `{"op":"stop","topic":T}` | unsubscribe from T |
//! | `{"op":"control","id":N,"operation":O,…}` | do what `belvedere control` does; the answer is a `result` with the same id |
//! | `{"op":"seek","position":S}` | continue at S seconds after the beginning of the recording |
//! | `{"op":"rate","rate":R}` | play the recording at R times real time |
//! | `{"op":"drive","topic":T,"linear":[x,y,z],"angular":[x,y,z]}` | a velocity command |
//!
//! The server sends the page's name (`page`), so that it can open a faster connection for frames ([`super::pipe`]), the
//! streams (`streams`), the scene's edition (`scene`), the position in a recording (`timeline`), results of commands,
//! and problems (`status`).

use super::Shared;
use super::commander::{Commander, Order};
use super::drivers::Drivers;
use super::listing;
use super::payload;
use super::pipe::Pipe;
use super::socket::{Said, Socket};
use super::waiting::wait;
use crate::recording::{Playhead, Timeline};
use belvedere_bridge::{Operation, Subscriber};
use serde::Deserialize;
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use tungstenite::{Error, Message};

/// Longest sleep without any event.
const NAP: Duration = Duration::from_millis(50);
/// Longest sleep while an answer of the simulator is awaited.
const SHORT_NAP: Duration = Duration::from_millis(4);
/// Time after which a page that requests no more frames of a stream, for example a hidden page, is unsubscribed from
/// it.
const FORGOTTEN: Duration = Duration::from_secs(3);
/// Shortest time between two messages about the position in a recording.
const PLAYHEAD_INTERVAL: Duration = Duration::from_millis(100);
/// Most frames of a stream that a page may have requested. With only one, the next frame would wait for its request,
/// which on a busy machine takes as long as a frame.
const MAX_AHEAD: u8 = 2;
/// Most streams that a page may subscribe to at a time.
const MAX_FOLLOWED: usize = 64;

/// The operations that a page may request.
const OPERATIONS: [Operation; 7] = [
    Operation::Pause,
    Operation::Resume,
    Operation::Step,
    Operation::ResetWorld,
    Operation::ResetSimulation,
    Operation::SetModelState,
    Operation::Configure,
];

#[derive(Debug, Deserialize)]
#[serde(tag = "op", rename_all = "snake_case")]
enum Request {
    Next {
        topic: String,
        #[serde(default = "one")]
        frames: u8,
    },
    Stop {
        topic: String,
    },
    Control(Order),
    Seek {
        position: f64,
    },
    Rate {
        rate: f64,
    },
    Drive {
        topic: String,
        #[serde(default)]
        linear: [f64; 3],
        #[serde(default)]
        angular: [f64; 3],
    },
}

fn one() -> u8 {
    1
}

/// A stream that a page subscribes to.
struct Followed {
    subscriber: Subscriber,
    /// Number of frames that the page has requested and not received.
    wanted: u8,
    asked: Instant,
}

/// A connected page.
pub(super) struct Page<'a> {
    shared: &'a Shared,
    /// Its name.
    name: String,
    socket: Socket,
    /// The connection for frames. Without it, frames are sent through the socket.
    pipe: Option<Pipe>,
    followed: Vec<Followed>,
    commander: Option<Commander>,
    /// Number of commands without an answer yet.
    awaited: usize,
    drivers: Drivers,
    streams: Option<u64>,
    scene: Option<u64>,
    playhead: Option<Playhead>,
    next_playhead: Instant,
}

impl<'a> Page<'a> {
    pub(super) fn new(shared: &'a Shared, name: String, socket: Socket) -> Self {
        Self {
            shared,
            name,
            socket,
            pipe: None,
            followed: Vec::new(),
            commander: None,
            awaited: 0,
            drivers: Drivers::default(),
            streams: None,
            scene: None,
            playhead: None,
            next_playhead: Instant::now(),
        }
    }

    /// Serves the page until it disconnects.
    ///
    /// # Errors
    /// The reason why the connection ended.
    pub(super) fn serve(mut self) -> Result<(), Error> {
        self.shared.pipes.expect(&self.name);
        self.say(&json!({ "op": "page", "name": self.name }))?;
        while !self.shared.is_stopping() {
            self.socket.keep_alive(Instant::now())?;
            if !self.socket.has_unsent() {
                self.send_changes()?;
            }
            self.wait();
            self.socket.flush()?;
            if let Some(pipe) = self.shared.pipes.take(&self.name) {
                self.pipe = Some(pipe);
            }
            if self.pipe.as_mut().is_some_and(|pipe| pipe.flush().is_err()) {
                self.pipe = None;
            }
            while let Some(said) = self.socket.read()? {
                self.take(&said)?;
            }
            self.send_frames()?;
            self.send_answers()?;
        }
        Ok(())
    }

    /// Sleeps until the page sends a message, or there is a frame for it.
    fn wait(&mut self) {
        let wanted = self.followed.iter_mut().filter(|followed| followed.wanted > 0);
        let nap = if self.awaited > 0 { SHORT_NAP } else { NAP };
        wait(&self.socket, self.pipe.as_ref(), wanted.map(|followed| &mut followed.subscriber), nap);
    }

    fn take(&mut self, said: &Said) -> Result<(), Error> {
        let request = match said {
            Said::Text(text) => serde_json::from_str(text).map_err(|error| error.to_string()),
            Said::Binary(_) => Err("it is binary".to_owned()),
        };
        let done = match request {
            Ok(Request::Next { topic, frames }) => self.want(&topic, frames),
            Ok(Request::Stop { topic }) => {
                self.followed.retain(|followed| followed.subscriber.topic() != topic);
                Ok(())
            }
            Ok(Request::Control(order)) => self.control(order),
            Ok(Request::Seek { position }) => self.seek(position),
            Ok(Request::Rate { rate }) => self.timeline().and_then(|timeline| timeline.set_rate(rate)),
            Ok(Request::Drive { topic, linear, angular }) => {
                let (_, streams) = self.shared.listing.now();
                self.drivers.drive(&self.shared.node, &streams, &topic, linear, angular)
            }
            Err(error) => Err(format!("the page's message is not understood: {error}")),
        };
        done.or_else(|reason| self.complain(&reason))
    }

    fn want(&mut self, topic: &str, frames: u8) -> Result<(), String> {
        let now = Instant::now();
        if let Some(known) = self.followed.iter_mut().find(|followed| followed.subscriber.topic() == topic) {
            (known.wanted, known.asked) = (known.wanted.saturating_add(frames).min(MAX_AHEAD), now);
            return Ok(());
        }
        if self.followed.len() >= MAX_FOLLOWED {
            return Err(format!("a page may subscribe to {MAX_FOLLOWED} streams; close some panels"));
        }
        let subscriber = self.shared.node.subscriber(topic).map_err(|error| error.to_string())?;
        self.followed.push(Followed { subscriber, wanted: frames.min(MAX_AHEAD), asked: now });
        if let Some(timeline) = self.shared.timeline.get() {
            timeline.refresh();
        }
        Ok(())
    }

    fn timeline(&self) -> Result<&Timeline, String> {
        let timeline = self.shared.timeline.get();
        timeline
            .map(|timeline| &**timeline)
            .ok_or_else(|| "this is not a recording: it has no time line".to_owned())
    }

    fn seek(&self, position: f64) -> Result<(), String> {
        let sought = Duration::try_from_secs_f64(position.max(0.0));
        let sought = sought.map_err(|_| format!("{position} is not a position in a recording"))?;
        self.timeline()?.seek(sought);
        Ok(())
    }

    fn control(&mut self, order: Order) -> Result<(), String> {
        if !OPERATIONS.iter().any(|known| known.as_str() == order.operation) {
            return Err(format!("a page may not request '{}'", order.operation));
        }
        if self.commander.is_none() {
            self.commander = Some(Commander::start(&self.shared.node).map_err(|error| error.to_string())?);
        }
        let Some(commander) = &self.commander else { return Ok(()) };
        commander.send(order)?;
        self.awaited += 1;
        Ok(())
    }

    fn send_answers(&mut self) -> Result<(), Error> {
        while !self.socket.has_unsent()
            && let Some(answer) = self.commander.as_ref().and_then(Commander::answer)
        {
            self.awaited = self.awaited.saturating_sub(1);
            self.say(&answer)?;
        }
        Ok(())
    }

    fn send_frames(&mut self) -> Result<(), Error> {
        let now = Instant::now();
        self.followed.retain(|followed| followed.wanted > 0 || now - followed.asked < FORGOTTEN);
        let mut failed = None;
        for followed in &mut self.followed {
            let is_full = self.pipe.as_ref().is_some_and(Pipe::has_unsent) || self.socket.has_unsent();
            if followed.wanted == 0 || is_full {
                continue;
            }
            match followed.subscriber.take_newest() {
                Ok(Some(frame)) => {
                    let message =
                        payload::encode(followed.subscriber.topic(), &frame.view(), frame.restarted());
                    drop(frame);
                    followed.wanted -= 1;
                    followed.asked = now;
                    // A page that has closed the connection opens it again.
                    if self.pipe.as_mut().is_some_and(|pipe| pipe.send(&message).is_err()) {
                        self.pipe = None;
                    } else if self.pipe.is_none() {
                        self.socket.send(Message::binary(message))?;
                    }
                }
                Ok(None) => {}
                Err(error) => {
                    followed.wanted = 0;
                    failed = Some(error.to_string());
                }
            }
        }
        failed.map_or(Ok(()), |reason| self.complain(&reason))
    }

    /// Sends the streams, the scene's edition and the position in a recording, if they have changed.
    fn send_changes(&mut self) -> Result<(), Error> {
        let (edition, streams) = self.shared.listing.now();
        if self.streams != Some(edition) {
            self.streams = Some(edition);
            self.say(&json!({ "op": "streams", "streams": listing::to_json(&streams) }))?;
        }
        let edition = self.shared.scene.edition();
        if self.scene != Some(edition) {
            self.scene = Some(edition);
            self.say(&json!({ "op": "scene", "edition": edition }))?;
        }
        let now = Instant::now();
        if let Some(timeline) = self.shared.timeline.get()
            && now >= self.next_playhead
            && self.playhead != Some(timeline.now())
        {
            let playhead = timeline.now();
            (self.playhead, self.next_playhead) = (Some(playhead), now + PLAYHEAD_INTERVAL);
            self.say(&json!({
                "op": "timeline",
                "duration": timeline.duration().as_secs_f64(),
                "position": playhead.position.as_secs_f64(),
                "rate": playhead.rate,
                "paused": playhead.is_paused,
            }))?;
        }
        Ok(())
    }

    fn complain(&mut self, reason: &str) -> Result<(), Error> {
        self.say(&json!({ "op": "status", "level": "warning", "text": reason }))
    }

    fn say(&mut self, message: &Value) -> Result<(), Error> {
        self.socket.send(Message::text(message.to_string()))
    }
}

impl Drop for Page<'_> {
    fn drop(&mut self) {
        self.shared.pipes.forget(&self.name);
    }
}

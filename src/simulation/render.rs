//! What sensors see, rendered when it is asked for into memory of the caller.

use super::{Simulation, SimulationError};
use crate::description::suggestion::did_you_mean_or;
use crate::rig::sink::{Frame, FrameBuf, Port, Sink};
use crate::rig::{Rig, RigOptions, Stage};
use crate::world::scene::WorldScene;
use belvedere_bridge::{Error, FrameHeader, StreamSpec};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

impl Simulation {
    /// All topics that can be rendered: those of sensors and of what robots tell of themselves, with the truth beside them.
    /// What is told once, or when something happens, has no frame of the moment and is not among them.
    ///
    /// # Errors
    /// When a sensor's description cannot be used.
    pub fn topics(&mut self) -> Result<Vec<String>, SimulationError> {
        Ok(self.open_studio()?.topics())
    }

    /// Opens the streams that a server of this simulation publishes as it opens them, with those of the truth if `truth` is
    /// set, but ending nowhere. What is decided for the user while they are opened is among the [notes](Self::notes).
    ///
    /// # Errors
    /// As of a server: when two streams have one topic, or a sensor's description cannot be used.
    pub fn streams(&mut self, truth: bool) -> Result<Rig, SimulationError> {
        let options = RigOptions { truth, ..self.options };
        let mut rig = Rig::open(&Slot::default(), self.stage().0, options)?;
        self.note(rig.take_notes());
        Ok(rig)
    }

    /// Renders the frame of a topic as it is now into `frame`, whose memory is used again. Of a sensor with several
    /// streams only what this one needs is worked out.
    ///
    /// Each call takes the next frame of that sensor: its noise is another one.
    ///
    /// # Errors
    /// When no sensor sends such a topic, or a sensor's description cannot be used.
    pub fn render(&mut self, topic: &str, frame: &mut FrameBuf) -> Result<(), SimulationError> {
        match self.render_all(&[topic], std::slice::from_mut(frame))?[..] {
            [true] => Ok(()),
            _ => Err(SimulationError::NoFrame { topic: with_slash(topic) }),
        }
    }

    /// The same of several topics at once: those of one sensor, as its picture and its truth, are then of one frame.
    ///
    /// Says of each topic whether it has a frame: flow has none the first time it is asked for, as it leads from the frame
    /// for which it was asked before.
    ///
    /// # Errors
    /// As of [`render`](Self::render).
    pub fn render_all(
        &mut self,
        topics: &[&str],
        frames: &mut [FrameBuf],
    ) -> Result<Vec<bool>, SimulationError> {
        self.in_studio(topics, frames, Rig::take)
    }

    /// Renders the frame of this number of one sensor into `frames`, a topic each, all of which are of that sensor: its own
    /// and those of its truth are then of one frame. The number chooses the noise. The frame depends on none before, and the
    /// exposure of a camera is that of the start; so frames are the same in whatever order they are asked for. With `goes_on`
    /// it follows the one that was rendered last, from which flow comes.
    ///
    /// Says of each topic whether it has a frame: flow has none without a frame before.
    ///
    /// # Errors
    /// When no sensor sends one of the topics, or a sensor's description cannot be used.
    pub fn render_numbered(
        &mut self,
        topics: &[&str],
        number: u64,
        goes_on: bool,
        frames: &mut [FrameBuf],
    ) -> Result<Vec<bool>, SimulationError> {
        self.in_studio(topics, frames, |rig, topics, stage, scene| {
            if let Some(topic) = topics.first() {
                rig.take_numbered((topic, number), goes_on, stage, scene);
            }
        })
    }

    /// Has frames of these topics taken.
    fn in_studio(
        &mut self,
        topics: &[&str],
        frames: &mut [FrameBuf],
        take: impl FnOnce(&mut Rig, &[String], Stage<'_>, &mut WorldScene),
    ) -> Result<Vec<bool>, SimulationError> {
        let topics: Vec<String> = topics.iter().map(|topic| with_slash(topic)).collect();
        self.open_studio()?;
        let Some(mut studio) = self.studio.take() else { return Err(SimulationError::Gone) };
        let (stage, scene) = self.stage();
        let rendered = studio.fill(&topics, frames, |rig| take(rig, &topics, stage, scene));
        self.studio = Some(studio);
        rendered
    }

    /// Opens it for those who are there now.
    fn open_studio(&mut self) -> Result<&Studio, SimulationError> {
        if self.studio.is_none() {
            let slot = Slot::default();
            let options = RigOptions { truth: true, ..self.options };
            let mut rig = Rig::open(&slot, self.stage().0, options)?;
            self.note(rig.take_notes());
            self.remember(rig.window_ns());
            self.studio = Some(Studio { rig, slot });
        }
        self.studio.as_ref().ok_or(SimulationError::Gone)
    }
}

/// A topic as its stream has it.
fn with_slash(topic: &str) -> String {
    format!("/{}", topic.trim_start_matches('/'))
}

/// Everybody's channels, and where the frame goes that is asked for.
pub(super) struct Studio {
    rig: Rig,
    slot: Slot,
}

impl Studio {
    fn topics(&self) -> Vec<String> {
        let outlets = self.rig.outlets().into_iter().filter(|outlet| outlet.rate_hz().is_some());
        outlets.map(|outlet| outlet.topic().to_owned()).collect()
    }

    /// Lets frames of these topics be taken into the caller's memory; says of which there are any.
    fn fill(
        &mut self,
        topics: &[String],
        frames: &mut [FrameBuf],
        take: impl FnOnce(&mut Rig),
    ) -> Result<Vec<bool>, SimulationError> {
        if let Some(topic) = topics.iter().find(|topic| !self.rig.has(topic)) {
            return Err(self.no_topic(topic));
        }
        for (topic, frame) in topics.iter().zip(&mut *frames) {
            self.slot.lock().begin(topic, frame);
        }
        take(&mut self.rig);
        // The last that was begun ends first.
        let mut filled: Vec<bool> =
            frames.iter_mut().take(topics.len()).rev().map(|frame| self.slot.lock().end(frame)).collect();
        filled.reverse();
        Ok(filled)
    }

    fn no_topic(&self, topic: &str) -> SimulationError {
        let topics = self.topics();
        let near = did_you_mean_or(topic, topics.iter().map(String::as_str), "");
        SimulationError::NoTopic { topic: topic.into(), near, there: topics.join(", ") }
    }
}

/// Where frames are put: those of the topics that are wanted.
#[derive(Clone, Default)]
struct Slot(Arc<Mutex<Vec<Place>>>);

/// The frame of one topic.
struct Place {
    topic: String,
    /// None while it is on loan.
    frame: Option<Box<FrameBuf>>,
    is_filled: bool,
}

impl Slot {
    fn lock(&self) -> Places<'_> {
        Places(self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The places of the frames that are wanted.
struct Places<'a>(MutexGuard<'a, Vec<Place>>);

impl Places<'_> {
    /// Takes the caller's memory for one more topic.
    fn begin(&mut self, topic: &str, frame: &mut FrameBuf) {
        let frame = Some(Box::new(std::mem::take(frame)));
        self.0.push(Place { topic: topic.to_owned(), frame, is_filled: false });
    }

    /// Gives that of the topic that was begun last back; says whether a frame was put into it.
    fn end(&mut self, frame: &mut FrameBuf) -> bool {
        let Some(place) = self.0.pop() else { return false };
        *frame = place.frame.map(|frame| *frame).unwrap_or_default();
        place.is_filled
    }

    fn of(&mut self, topic: &str) -> Option<&mut Place> {
        self.0.iter_mut().find(|place| place.topic == topic)
    }
}

impl Sink for Slot {
    fn open(&self, spec: &StreamSpec) -> Result<Box<dyn Port>, Error> {
        let topic = format!("/{}", spec.name()?);
        Ok(Box::new(Ending { slot: self.clone(), topic, template: spec.header()? }))
    }
}

/// A stream that ends in its place while it is wanted.
struct Ending {
    slot: Slot,
    topic: String,
    template: FrameHeader,
}

impl Port for Ending {
    fn is_wanted(&self) -> bool {
        self.slot.lock().of(&self.topic).is_some()
    }

    fn keeps_messages(&self) -> bool {
        false
    }

    fn loan(&self, len: usize) -> Result<Frame, Error> {
        let mut frame =
            self.slot.lock().of(&self.topic).and_then(|place| place.frame.take()).unwrap_or_default();
        frame.reset(&self.template, len);
        Ok(Frame::Owned(frame))
    }

    fn send(&self, frame: Frame) -> Result<(), Error> {
        match frame {
            Frame::Owned(frame) => {
                if let Some(place) = self.slot.lock().of(&self.topic) {
                    (place.frame, place.is_filled) = (Some(frame), true);
                }
            }
            // Loaned elsewhere.
            #[cfg(feature = "server")]
            Frame::Shared(_) => {}
        }
        Ok(())
    }
}

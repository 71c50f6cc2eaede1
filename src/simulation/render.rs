//! Renders sensors on demand into the caller's memory.

use super::{Simulation, SimulationError};
use crate::description::suggestion::did_you_mean_or;
use crate::rig::sink::{Frame, FrameBuf, Port, Sink};
use crate::rig::{Rig, RigOptions, Stage};
use crate::world::scene::WorldScene;
use belvedere_bridge::{Error, FrameHeader, StreamSpec};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

impl Simulation {
    /// Returns all topics that can be rendered: those of sensors and of robots' states, including ground truth. Topics
    /// that are sent once, or at events, have no current frame and are not included.
    ///
    /// # Errors
    /// If a sensor's description cannot be used.
    pub fn topics(&mut self) -> Result<Vec<String>, SimulationError> {
        Ok(self.open_studio()?.topics())
    }

    /// Opens the streams that a server of this simulation publishes, including those of ground truth if `truth` is set,
    /// without sending them anywhere. Decisions made for the user are added to the [notes](Self::notes).
    ///
    /// # Errors
    /// As for a server: if two streams have the same topic, or a sensor's description cannot be used.
    pub fn streams(&mut self, truth: bool) -> Result<Rig, SimulationError> {
        let options = RigOptions { truth, ..self.options };
        let mut rig = Rig::open(&Slot::default(), self.stage().0, options)?;
        self.notes.add(rig.take_notes());
        Ok(rig)
    }

    /// Renders the current frame of a topic into `frame`, whose memory is used again. If the sensor has several
    /// streams, only what this one needs is computed.
    ///
    /// Each call renders the next frame of that sensor, with new noise.
    ///
    /// # Errors
    /// If no sensor sends such a topic, or a sensor's description cannot be used.
    pub fn render(&mut self, topic: &str, frame: &mut FrameBuf) -> Result<(), SimulationError> {
        match self.render_all(&[topic], std::slice::from_mut(frame))?[..] {
            [true] => Ok(()),
            _ => Err(SimulationError::NoFrame { topic: with_slash(topic) }),
        }
    }

    /// Renders several topics at once. Topics of one sensor, such as its image and its ground truth, then show the same
    /// frame.
    ///
    /// Returns for each topic whether it has a frame. Optical flow has none at the first call, because it starts from
    /// the frame of the previous call.
    ///
    /// # Errors
    /// The errors of [`render`](Self::render).
    pub fn render_all(
        &mut self,
        topics: &[&str],
        frames: &mut [FrameBuf],
    ) -> Result<Vec<bool>, SimulationError> {
        self.in_studio(topics, frames, Rig::take)
    }

    /// Renders the frame with this number of one sensor into `frames`, one for each topic. All topics must belong to
    /// that sensor; they show the same frame. The number selects the noise. The frame does not depend on earlier
    /// frames, and a camera's exposure is that at the start, so frames are the same in any order. With `goes_on`, the
    /// frame follows the one that was rendered last, from which optical flow starts.
    ///
    /// Returns for each topic whether it has a frame. Optical flow has none without a previous frame.
    ///
    /// # Errors
    /// If no sensor sends one of the topics, or a sensor's description cannot be used.
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

    /// Renders frames of these topics with `take`.
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

    /// Opens the studio for the current models.
    fn open_studio(&mut self) -> Result<&Studio, SimulationError> {
        if self.studio.is_none() {
            let slot = Slot::default();
            let options = RigOptions { truth: true, ..self.options };
            let mut rig = Rig::open(&slot, self.stage().0, options)?;
            self.notes.add(rig.take_notes());
            self.remember(rig.window_ns());
            self.studio = Some(Studio { rig, slot });
        }
        self.studio.as_ref().ok_or(SimulationError::Gone)
    }
}

/// Returns a topic with its leading slash.
fn with_slash(topic: &str) -> String {
    format!("/{}", topic.trim_start_matches('/'))
}

/// The channels of all models, and the place of requested frames.
pub(super) struct Studio {
    rig: Rig,
    slot: Slot,
}

impl Studio {
    fn topics(&self) -> Vec<String> {
        let outlets = self.rig.outlets().into_iter().filter(|outlet| outlet.rate_hz().is_some());
        outlets.map(|outlet| outlet.topic().to_owned()).collect()
    }

    /// Renders frames of these topics into the caller's memory. Returns for each whether there is one.
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
        // The last place that was added is taken back first.
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

/// A sink that stores frames of the requested topics.
#[derive(Clone, Default)]
struct Slot(Arc<Mutex<Vec<Place>>>);

/// The frame of one topic.
struct Place {
    topic: String,
    /// `None` while it is on loan.
    frame: Option<Box<FrameBuf>>,
    is_filled: bool,
}

impl Slot {
    fn lock(&self) -> Places<'_> {
        Places(self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The places of the requested frames.
struct Places<'a>(MutexGuard<'a, Vec<Place>>);

impl Places<'_> {
    /// Adds a topic with the caller's memory.
    fn begin(&mut self, topic: &str, frame: &mut FrameBuf) {
        let frame = Some(Box::new(std::mem::take(frame)));
        self.0.push(Place { topic: topic.to_owned(), frame, is_filled: false });
    }

    /// Returns the memory of the topic that was added last, and whether a frame was written to it.
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

/// A stream whose frames are stored while its topic is requested.
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
            // `loan` returns only owned frames.
            #[cfg(feature = "server")]
            Frame::Shared(_) => {}
        }
        Ok(())
    }
}

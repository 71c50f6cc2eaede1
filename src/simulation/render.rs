//! What sensors see, rendered when it is asked for into memory of the caller.

use super::{Simulation, SimulationError};
use crate::description::values::nearest;
use crate::rig::sink::{Frame, FrameBuf, Port, Sink};
use crate::rig::{Rig, RigOptions};
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

    /// Renders the frame of a topic as it is now into `frame`, whose memory is used again. Of a sensor with several
    /// streams only what this one needs is worked out.
    ///
    /// Each call takes the next frame of that sensor: its noise is another one.
    ///
    /// # Errors
    /// When no sensor sends such a topic, or a sensor's description cannot be used.
    pub fn render(&mut self, topic: &str, frame: &mut FrameBuf) -> Result<(), SimulationError> {
        let topic = format!("/{}", topic.trim_start_matches('/'));
        self.open_studio()?;
        let Some(mut studio) = self.studio.take() else { return Err(SimulationError::Gone) };
        let rendered = studio.render(self, &topic, frame);
        self.studio = Some(studio);
        rendered
    }

    /// Opens it for those who are there now.
    fn open_studio(&mut self) -> Result<&Studio, SimulationError> {
        if self.studio.is_none() {
            let slot = Slot::default();
            let options = RigOptions { truth: true, ..self.options };
            let rig = Rig::open(&slot, self.stage().0, options)?;
            self.remember(rig.window_ns());
            self.studio = Some(Studio { rig, slot });
        }
        self.studio.as_ref().ok_or(SimulationError::Gone)
    }
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

    fn render(
        &mut self,
        simulation: &mut Simulation,
        topic: &str,
        frame: &mut FrameBuf,
    ) -> Result<(), SimulationError> {
        self.slot.lock().begin(topic, frame);
        let (stage, scene) = simulation.stage();
        let is_there = self.rig.take(topic, stage, scene);
        let is_filled = self.slot.lock().end(frame);
        if !is_there {
            let topics = self.topics();
            let near = nearest(topic, topics.iter().map(String::as_str));
            let near = near.map(|near| format!("did you mean {near}? ")).unwrap_or_default();
            return Err(SimulationError::NoTopic { topic: topic.into(), near, there: topics.join(", ") });
        }
        if is_filled { Ok(()) } else { Err(SimulationError::NoFrame { topic: topic.into() }) }
    }
}

/// Where one frame is put: that of the topic which is wanted.
#[derive(Clone, Default)]
struct Slot(Arc<Mutex<Inside>>);

#[derive(Default)]
struct Inside {
    wanted: String,
    /// None while it is on loan.
    frame: Option<Box<FrameBuf>>,
    is_filled: bool,
}

impl Slot {
    fn lock(&self) -> MutexGuard<'_, Inside> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inside {
    /// Takes the caller's memory.
    fn begin(&mut self, topic: &str, frame: &mut FrameBuf) {
        self.wanted.clear();
        self.wanted.push_str(topic);
        self.is_filled = false;
        std::mem::swap(&mut **self.frame.get_or_insert_default(), frame);
    }

    /// Gives it back; says whether a frame was put into it.
    fn end(&mut self, frame: &mut FrameBuf) -> bool {
        self.wanted.clear();
        std::mem::swap(&mut **self.frame.get_or_insert_default(), frame);
        self.is_filled
    }
}

impl Sink for Slot {
    fn open(&self, spec: &StreamSpec) -> Result<Box<dyn Port>, Error> {
        let topic = format!("/{}", spec.name()?);
        Ok(Box::new(Ending { slot: self.clone(), topic, template: spec.header()? }))
    }
}

/// A stream that ends in the slot while it is wanted.
struct Ending {
    slot: Slot,
    topic: String,
    template: FrameHeader,
}

impl Port for Ending {
    fn is_wanted(&self) -> bool {
        self.slot.lock().wanted == self.topic
    }

    fn keeps_messages(&self) -> bool {
        false
    }

    fn loan(&self, len: usize) -> Result<Frame, Error> {
        let mut frame = self.slot.lock().frame.take().unwrap_or_default();
        frame.reset(&self.template, len);
        Ok(Frame::Owned(frame))
    }

    fn send(&self, frame: Frame) -> Result<(), Error> {
        match frame {
            Frame::Owned(frame) => {
                let mut inside = self.slot.lock();
                (inside.frame, inside.is_filled) = (Some(frame), true);
            }
            // Loaned elsewhere.
            #[cfg(feature = "server")]
            Frame::Shared(_) => {}
        }
        Ok(())
    }
}

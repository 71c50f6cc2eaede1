//! Playing a recording along a [`Timeline`], on which other threads seek.

use super::RecordingError;
use super::player::{Ending, NAP, Player};
use super::reader::RecordingReader;
use super::timeline::Timeline;
use std::io::{Read, Seek};
use std::sync::Arc;
use std::time::Duration;

impl Player {
    /// Plays a recording along a time line until `go_on` ends it. At its end it stands, and resumed there it begins again.
    /// Wherever it goes on, the last frame of each stream until then is sent first, so that all is seen as it was then.
    /// `open` gives the file, anew after each seek.
    ///
    /// # Errors
    /// As [`Player::play`], and those of `open`.
    pub fn play_along<R: Read + Seek>(
        &mut self,
        timeline: &Arc<Timeline>,
        mut open: impl FnMut() -> std::io::Result<R>,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), RecordingError> {
        self.timeline = Some(timeline.clone());
        loop {
            let sought = timeline.take_sought();
            // What is at the very time that was sought is seen, too.
            let start = sought.map_or(Duration::ZERO, |sought| sought + Duration::from_nanos(1));
            self.options.start = start;
            self.before.clear();
            self.tell(sought.unwrap_or(Duration::ZERO));
            let recording = RecordingReader::resuming_at(open()?, start)?;
            match self.play(recording, |_| go_on()) {
                Ok(Ending::Stopped) if self.is_sought() => continue,
                Ok(Ending::Stopped) => return Ok(()),
                // All that is whole was played.
                Ok(Ending::Played) | Err(RecordingError::Cut | RecordingError::TooShort { .. }) => {}
                Err(error) => return Err(error),
            }
            self.send_before()?;
            self.paused = true;
            self.tell(timeline.duration());
            while !self.is_sought() {
                if !go_on() {
                    return Ok(());
                }
                self.look_after(NAP)?;
                self.refuse_steps("the recording is at its end");
                if !self.paused {
                    timeline.seek(Duration::ZERO);
                }
            }
        }
    }
}

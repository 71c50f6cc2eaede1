//! Plays a recording along a [`Timeline`], on which other threads seek.

use super::RecordingError;
use super::player::{Ending, NAP, Player};
use super::reader::RecordingReader;
use super::timeline::Timeline;
use std::io::{Read, Seek};
use std::sync::Arc;
use std::time::Duration;

impl Player {
    /// Plays a recording along a timeline until `go_on` stops it. At its end it pauses, and if it is resumed there, it
    /// starts again. Wherever it continues, the last frame of each stream before that position is sent first, so that
    /// consumers see the state at that time. `open` opens the file again after each seek.
    ///
    /// # Errors
    /// The errors of [`Player::play`], and those of `open`.
    pub fn play_along<R: Read + Seek>(
        &mut self,
        timeline: &Arc<Timeline>,
        mut open: impl FnMut() -> std::io::Result<R>,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<(), RecordingError> {
        self.timeline = Some(timeline.clone());
        loop {
            let sought = timeline.take_sought();
            // Frames at exactly the sought time are sent as well.
            let start = sought.map_or(Duration::ZERO, |sought| sought + Duration::from_nanos(1));
            self.options.start = start;
            self.before.clear();
            self.show_position(sought.unwrap_or(Duration::ZERO));
            let recording = RecordingReader::resuming_at(open()?, start)?;
            match self.play(recording, |_| go_on()) {
                Ok(Ending::Stopped) if self.is_sought() => continue,
                Ok(Ending::Stopped) => return Ok(()),
                // Everything up to the cut was played.
                Ok(Ending::Played) | Err(RecordingError::Cut | RecordingError::TooShort { .. }) => {}
                Err(error) => return Err(error),
            }
            self.send_before()?;
            self.paused = true;
            self.show_position(timeline.duration());
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

//! Notes on decisions made for the user, each kept once.

use crate::description::Problem;
use std::collections::HashSet;

/// The notes of a simulation, in the order in which they came.
#[derive(Debug, Default)]
pub(super) struct Notes {
    all: Vec<Problem>,
    /// The same notes, to find repetitions.
    known: HashSet<Problem>,
}

impl Notes {
    /// Adds notes. One that is known already is left out: the same model may be spawned often.
    pub(super) fn add(&mut self, notes: impl IntoIterator<Item = Problem>) {
        for note in notes {
            if self.known.insert(note.clone()) {
                self.all.push(note);
            }
        }
    }

    /// Returns all notes.
    pub(super) fn all(&self) -> &[Problem] {
        &self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::{Severity, Source};
    use std::time::Instant;

    fn note(line: u32) -> Problem {
        let (what, remedy) = ("what".to_owned(), "remedy".to_owned());
        Problem { severity: Severity::Note, source: Source::new("f", line), what, remedy }
    }

    #[test]
    fn a_note_is_kept_once_and_in_its_place() {
        let mut notes = Notes::default();
        notes.add([note(2), note(1), note(2)]);
        notes.add([note(1), note(3)]);
        let lines: Vec<u32> = notes.all().iter().map(|note| note.source.line).collect();
        assert_eq!(lines, [2, 1, 3]);
    }

    /// If each note were compared with all others, eight times as many would take 64 times as long.
    #[test]
    fn the_time_for_a_note_does_not_depend_on_their_number() {
        let time = |count: u32| {
            let (start, mut notes) = (Instant::now(), Notes::default());
            (0..count).for_each(|line| notes.add([note(line)]));
            assert_eq!(notes.all().len(), count as usize);
            start.elapsed()
        };
        assert!((0..5).any(|_| time(16_000) < 24 * time(2_000)));
    }
}

//! Names that may come again, as Gazebo takes them: the later ones get numbers.

use std::collections::{HashMap, HashSet};

/// The names of things of one kind in one place.
#[derive(Default)]
pub(super) struct Names {
    /// All that are written, which no number may make again.
    written: HashSet<String>,
    taken: HashMap<String, Taken>,
}

struct Taken {
    /// Who has it.
    first: usize,
    /// The number that is tried next: the smaller ones are taken, and looking at them again would cost squares.
    next: usize,
}

/// A name that somebody has.
pub(super) struct Again {
    /// Who has it.
    pub(super) first: usize,
    /// The same with a number, which is taken now.
    pub(super) unique: String,
}

impl Names {
    /// None is taken yet of those that are `written`.
    pub(super) fn of(written: impl IntoIterator<Item = String>) -> Self {
        Self { written: written.into_iter().collect(), taken: HashMap::new() }
    }

    /// Takes a name for the thing of this index.
    pub(super) fn take(&mut self, name: &str, index: usize) -> Result<(), Again> {
        let Some(&Taken { first, mut next }) = self.taken.get(name) else {
            self.taken.insert(name.to_owned(), Taken { first: index, next: 0 });
            return Ok(());
        };
        let unique = loop {
            let numbered = format!("{name}_{next}");
            next += 1;
            if !self.written.contains(&numbered) && !self.taken.contains_key(&numbered) {
                break numbered;
            }
        };
        self.taken.insert(name.to_owned(), Taken { first, next });
        self.taken.insert(unique.clone(), Taken { first: index, next: 0 });
        Err(Again { first, unique })
    }
}

//! Repeated names: as in Gazebo, the later ones get a number.

use std::collections::{HashMap, HashSet};

/// The names of one kind of element in one model or world.
#[derive(Default)]
pub(super) struct Names {
    /// All names in the file; no number may produce one of them.
    written: HashSet<String>,
    taken: HashMap<String, Taken>,
}

struct Taken {
    /// The index of the thing that has it.
    first: usize,
    /// The next number to try: smaller ones are taken, and trying them again would take quadratic time.
    next: usize,
}

/// The result of taking a name that is already taken.
pub(super) struct Again {
    /// The index of the thing that has it.
    pub(super) first: usize,
    /// The same name with a number, which is now taken.
    pub(super) unique: String,
}

impl Names {
    /// Creates the names; those in `written` are not taken yet.
    pub(super) fn of(written: impl IntoIterator<Item = String>) -> Self {
        Self { written: written.into_iter().collect(), taken: HashMap::new() }
    }

    /// Takes a name for the thing with this index.
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

//! Repeated names: as in Gazebo, the later ones get a number.

use super::{Loader, name_of};
use crate::diagnostics::Source;
use crate::xml::Element;
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

impl Loader<'_> {
    /// Returns the name of a link or joint. If an earlier one of the model, at `first(index)`, has the same name, that is an
    /// error and the result is `None`; with `--gazebo-compat` the name gets a number.
    pub(super) fn own_name<'s>(
        &mut self,
        element: &Element,
        names: &mut Names,
        index: usize,
        first: impl Fn(usize) -> &'s Source,
    ) -> Option<String> {
        let (kind, name) = (&element.name, name_of(element));
        if name.is_empty() {
            let what = format!("<{kind}> has no name");
            self.diagnostics.error(&element.source, what, format!("write <{kind} name=\"…\">"));
            return None;
        }
        let Err(Again { first: earlier, unique }) = names.take(&name, index) else { return Some(name) };
        let earlier = first(earlier);
        let what = format!("two {kind}s of this model are called '{name}' (the first at {earlier})");
        if !self.rules.gazebo_compat {
            self.diagnostics.error(&element.source, what, "rename one");
            return None;
        }
        // Files saved by Gazebo have such names. Joints and frames refer to the first.
        self.diagnostics.warning(
            &element.source,
            format!("{what}: this one becomes '{unique}'"),
            "rename one",
        );
        Some(unique)
    }
}

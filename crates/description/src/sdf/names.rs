//! Names that may come again, as Gazebo takes them: the later ones get numbers.

use super::{Loader, name_of};
use crate::diagnostics::Source;
use crate::xml::Element;
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

impl Loader<'_> {
    /// The name of a link or joint, or the number that it gets with `--gazebo-compat` if an earlier one of the model has
    /// the name, whose place is `first(index)`. None if that is an error.
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
        // Files that Gazebo saved have such names. Joints and frames mean the first.
        self.diagnostics.warning(
            &element.source,
            format!("{what}: this one becomes '{unique}'"),
            "rename one",
        );
        Some(unique)
    }
}

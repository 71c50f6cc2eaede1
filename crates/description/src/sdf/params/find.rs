//! How the elements that `<experimental:params>` alters are found by their names.

use super::MOST_COMPARED;
use crate::sdf::{A_FILE, Loader, name_of};
use crate::xml::{Element, Node};
use std::path::Path;

/// A way down from an element: the number of a child, of its child, and so on.
pub(super) type Way = Vec<usize>;

/// What an alteration looks for.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub(super) id: &'a str,
    /// None: any kind.
    pub(super) kind: Option<&'a str>,
}

/// What was found.
pub(super) enum Found {
    Element(Way),
    /// An `<include>`, and what is left of the id inside of it.
    Include(Way, String),
}

impl Loader<'_> {
    /// The element that an id leads to by names from the outside to the inside.
    pub(super) fn find(&mut self, element: &Element, target: Target<'_>, folder: &Path) -> Option<Found> {
        let Target { id, kind } = target;
        let mut inside = None;
        for (place, child) in element.children.iter().enumerate() {
            let Node::Element(child) = child else { continue };
            let is_include = child.name == "include";
            let name = if is_include { self.include_name(child, folder) } else { name_of(child) };
            let rest = id.strip_prefix(name.as_str()).filter(|_| !name.is_empty());
            match rest {
                Some("") if is_include && kind.is_none_or(|kind| kind == "model") => {
                    return Some(Found::Include(vec![place], String::new()));
                }
                Some("") if !is_include && kind.is_none_or(|kind| kind == child.name) => {
                    return Some(Found::Element(vec![place]));
                }
                Some(rest) if inside.is_none() => {
                    let Some(rest) = rest.strip_prefix("::") else { continue };
                    inside = if is_include {
                        Some(Found::Include(vec![place], rest.to_owned()))
                    } else {
                        let found = self.find(child, Target { id: rest, kind }, folder);
                        found.map(|found| found.below(place))
                    };
                }
                _ => {}
            }
        }
        inside
    }

    /// The name of the model of an `<include>`: its `<name>`, or that in the file.
    fn include_name(&mut self, include: &Element, folder: &Path) -> String {
        if let Some(name) = include.child("name") {
            return name.text();
        }
        let read = |loader: &mut Self| -> Option<String> {
            let uri = include.child("uri")?.text();
            let path = loader.included_file(include, &uri, folder)?;
            let spent = loader.budget.take(A_FILE, 0);
            loader.afford(spent, &include.source)?;
            let root = Element::parse_file(&path).ok()?;
            root.child("model").map(name_of)
        };
        read(self).unwrap_or_default()
    }
}

impl Found {
    fn below(mut self, place: usize) -> Self {
        let (Self::Element(way) | Self::Include(way, _)) = &mut self;
        way.insert(0, place);
        self
    }
}

/// The element that a way leads to. A way that was found in an element holds until that is altered.
pub(super) fn at<'e>(element: &'e mut Element, way: &[usize]) -> Option<&'e mut Element> {
    let Some((first, rest)) = way.split_first() else { return Some(element) };
    match element.children.get_mut(*first)? {
        Node::Element(child) => at(child, rest),
        Node::Text(_) | Node::Cdata(_) => None,
    }
}

/// Adds the ids of the elements of a kind, as many as an unknown one is compared with.
pub(super) fn collect_names(element: &Element, before: &str, kind: Option<&str>, names: &mut Vec<String>) {
    for child in element.elements() {
        let name = name_of(child);
        if name.is_empty() || names.len() >= MOST_COMPARED {
            continue;
        }
        let id = format!("{before}{name}");
        collect_names(child, &format!("{id}::"), kind, names);
        if kind.is_none_or(|kind| kind == child.name) {
            names.push(id);
        }
    }
}

//! `<experimental:params>` of an `<include>`: adds, modifies, removes and replaces elements of the included model.
//!
//! | in `<experimental:params>` | effect |
//! |---|---|
//! | `<sensor element_id="LINK::SENSOR" action="modify">` | the element's attributes and children get these values |
//! | `action="remove"` | the element is removed, or only those of its children that are listed inside |
//! | `action="replace"` | this element takes its place |
//! | `<sensor name="NEW" element_id="LINK" action="add">` | this element is added to the link; to the model if the id is empty |
//! | no `action` | each element inside has its own action |

mod find;

use super::{Loader, name_of};
use crate::elements;
use crate::xml::{Element, Node};
use find::{Found, Target, Way, at, collect_names};
use std::path::Path;

const PARAMS: &str = "experimental:params";
/// Stands in an `<include>` for alterations of the included model itself, which have no id. No file can contain this name.
const OF_MODEL: &str = "experimental:params of the model";
/// Attributes of the alteration itself, which are not attributes of the altered element.
const ELEMENT_ID: &str = "element_id";
const ACTION: &str = "action";
/// The most names that are compared with an unknown one for a suggestion.
const MOST_COMPARED: usize = 1000;

#[derive(Clone, Copy, PartialEq)]
enum Action {
    Add,
    Modify,
    Remove,
    Replace,
}

impl Loader<'_> {
    /// Applies the `<experimental:params>` of an `<include>` to the model, actor or light of the included file.
    pub(super) fn alter(&mut self, include: &Element, root: &mut Element, folder: &Path) -> Option<()> {
        let is_included = |child: &&mut Element| matches!(child.name.as_str(), "model" | "actor" | "light");
        let Some(included) = elements_mut(root).find(is_included) else { return Some(()) };
        for params in include.elements().filter(|child| matches!(child.name.as_str(), PARAMS | OF_MODEL)) {
            let weight = params.weight();
            let spent = self.budget.take(weight.elements, weight.bytes);
            self.afford(spent, &params.source)?;
            for alteration in params.elements() {
                if params.name == PARAMS {
                    self.alter_one(alteration, included, folder);
                } else {
                    self.alter_model(alteration, included);
                }
            }
        }
        Some(())
    }

    /// Applies one child of `<experimental:params>`.
    fn alter_one(&mut self, by: &Element, model: &mut Element, folder: &Path) -> Option<()> {
        let Some(id) = by.attribute(ELEMENT_ID) else {
            return self.refuse(by, "has no element_id", "name the element, as LINK::SENSOR");
        };
        if id.ends_with("::") {
            return self.refuse(by, &format!("has the element_id '{id}'"), "write a name behind the last ::");
        }
        let action = match by.attribute(ACTION) {
            Some(text) => Some(self.action(by, text)?),
            None => None,
        };
        let mut target = Target { id, kind: Some(&by.name) };
        if action == Some(Action::Add) {
            let name = name_of(by);
            if name.is_empty() {
                return self.refuse(by, "is to be added and has no name", "write its name=\"…\"");
            }
            let whole = if id.is_empty() { name } else { format!("{id}::{name}") };
            let same = Target { id: &whole, kind: Some(&by.name) };
            if by.name != "plugin" && matches!(self.find(model, same, folder), Some(Found::Element(_))) {
                let what = format!("is to be added to '{id}', where there is one of that name");
                return self.refuse(by, &what, "give it another name, or write action=\"replace\"");
            }
            target.kind = None;
        }
        let found = match (action, id) {
            (Some(Action::Add), "") => Some(Found::Element(Way::new())),
            _ => self.find(model, target, folder),
        };
        match found {
            Some(Found::Element(way)) => self.apply(action, by, model, &way),
            Some(Found::Include(way, rest)) if rest.is_empty() && action != Some(Action::Add) => {
                self.alter_include(action, by, model, &way)
            }
            Some(Found::Include(way, rest)) => {
                let mut by = by.clone();
                for (name, value) in &mut by.attributes {
                    if name == ELEMENT_ID {
                        rest.clone_into(value);
                    }
                }
                pass_on(PARAMS, by, at(model, &way)?);
                Some(())
            }
            None => {
                let mut names = Vec::new();
                collect_names(model, "", target.kind, &mut names);
                let meant = self.diagnostics.did_you_mean(id, names.iter().map(String::as_str));
                let remedy =
                    meant.unwrap_or_else(|| "write the names that lead to it, with :: between them".into());
                self.refuse(
                    by,
                    &format!("has the element_id '{id}', which the included file does not have"),
                    &remedy,
                )
            }
        }
    }

    fn action(&mut self, by: &Element, text: &str) -> Option<Action> {
        Some(match text {
            "add" => Action::Add,
            "modify" => Action::Modify,
            "remove" => Action::Remove,
            "replace" => Action::Replace,
            _ => {
                let remedy = "write add, modify, remove or replace";
                return self.refuse(by, &format!("has the action '{text}'"), remedy);
            }
        })
    }

    fn refuse<T>(&mut self, by: &Element, what: &str, remedy: &str) -> Option<T> {
        self.diagnostics.error(&by.source, format!("<{}> of <{PARAMS}> {what}", by.name), remedy);
        None
    }

    /// Alters a model that the included file includes itself: its `<include>` where that has the word, or else the model.
    fn alter_include(
        &mut self,
        action: Option<Action>,
        by: &Element,
        model: &mut Element,
        way: &[usize],
    ) -> Option<()> {
        let is_whole = by.elements().next().is_none();
        if action == Some(Action::Replace) || action == Some(Action::Remove) && is_whole {
            return self.apply(action, by, model, way);
        }
        let include = at(model, way)?;
        let mut of_model = by.clone();
        if action == Some(Action::Modify) {
            // These of an <include> take precedence over those of the model.
            let name = by.attribute("name").map(|name| {
                let (source, children) = (by.source.clone(), vec![Node::Text(name.to_owned())]);
                Element { name: "name".into(), attributes: Vec::new(), children, source }
            });
            of_model.attributes.retain(|(attribute, _)| attribute != "name");
            for new in name.into_iter().chain(by.elements().filter(|child| is_of_include(child)).cloned()) {
                include.children.retain(|child| !matches!(child, Node::Element(old) if old.name == new.name));
                include.children.push(Node::Element(new));
            }
            of_model.children.retain(|child| !matches!(child, Node::Element(child) if is_of_include(child)));
        }
        if of_model.elements().next().is_some() || of_model.attributes.iter().any(|(name, _)| !is_own(name)) {
            pass_on(OF_MODEL, of_model, include);
        }
        Some(())
    }

    /// Applies an alteration to the included model itself.
    fn alter_model(&mut self, by: &Element, model: &mut Element) -> Option<()> {
        let action = match by.attribute(ACTION) {
            Some(text) => Some(self.action(by, text)?),
            None => None,
        };
        if action == Some(Action::Remove) {
            self.remove_inside(by, model);
            return Some(());
        }
        self.apply(action, by, model, &[])
    }

    fn apply(
        &mut self,
        action: Option<Action>,
        by: &Element,
        model: &mut Element,
        way: &[usize],
    ) -> Option<()> {
        match action {
            Some(Action::Add) => {
                self.add(by, at(model, way)?);
                Some(())
            }
            Some(Action::Modify) => self.modify(by, at(model, way)?),
            Some(Action::Remove | Action::Replace) => {
                let (last, above) = way.split_last()?;
                self.remove_or_replace(action, by, at(model, above)?, *last)
            }
            None => {
                let element = at(model, way)?;
                for child in by.elements() {
                    self.alter_child(child, element);
                }
                Some(())
            }
        }
    }

    /// Applies an element inside an alteration that has no action itself.
    fn alter_child(&mut self, by: &Element, parent: &mut Element) -> Option<()> {
        let Some(text) = by.attribute(ACTION) else {
            let remedy = "write one, or one for the element around it";
            return self.refuse(by, "has no action, as the element around it has none", remedy);
        };
        let action = self.action(by, text)?;
        if action == Action::Add {
            self.add(by, parent);
            return Some(());
        }
        let place = self.child_like(by, parent, action == Action::Modify)?;
        match action {
            Action::Modify => self.modify(by, at(parent, &[place])?),
            _ => self.remove_or_replace(Some(action), by, parent, place),
        }
    }

    fn remove_or_replace(
        &mut self,
        action: Option<Action>,
        by: &Element,
        parent: &mut Element,
        place: usize,
    ) -> Option<()> {
        if action == Some(Action::Replace) {
            let old = at(parent, &[place])?;
            if old.attribute("name").is_some() && by.attribute("name").is_none() {
                return self.refuse(
                    by,
                    "replaces an element with a name and has none",
                    "write its name=\"…\"",
                );
            }
            let new = bare(by);
            self.look_at(parent, &new);
            parent.children[place] = Node::Element(new);
            return Some(());
        }
        if by.elements().next().is_none() {
            parent.children.remove(place);
            return Some(());
        }
        self.remove_inside(by, at(parent, &[place])?);
        Some(())
    }

    /// Removes the elements of an element that an alteration lists.
    fn remove_inside(&mut self, by: &Element, element: &mut Element) {
        for child in by.elements() {
            if let Some(place) = self.child_like(child, element, false) {
                element.children.remove(place);
            }
        }
    }

    fn add(&mut self, by: &Element, parent: &mut Element) {
        let new = bare(by);
        self.look_at(parent, &new);
        parent.children.push(Node::Element(new));
    }

    /// Compares a new element with the table of what is known.
    fn look_at(&mut self, parent: &Element, new: &Element) {
        if elements::has_context(&parent.name) {
            let children = vec![Node::Element(new.clone())];
            let (name, source) = (parent.name.clone(), parent.source.clone());
            let shell = Element { name, attributes: Vec::new(), children, source };
            elements::report([(&shell, parent.name.as_str())], self.diagnostics);
        }
    }

    /// Gives an element the attributes, and the text or the elements of another one.
    fn modify(&mut self, by: &Element, element: &mut Element) -> Option<()> {
        for (name, value) in by.attributes.iter().filter(|(name, _)| !is_own(name)) {
            match element.attributes.iter_mut().find(|(known, _)| known == name) {
                Some((_, known)) => known.clone_from(value),
                None => element.attributes.push((name.clone(), value.clone())),
            }
        }
        let text = by.text();
        if !text.is_empty() {
            element.children.retain(|child| matches!(child, Node::Element(_)));
            element.children.push(Node::Text(text));
            element.source = by.source.clone();
            return Some(());
        }
        for child in by.elements() {
            let Some(place) = self.child_like(child, element, true) else { continue };
            if !child.children.is_empty() || !child.attributes.is_empty() {
                self.modify(child, at(element, &[place])?);
            } else if at(element, &[place])?.elements().next().is_none() {
                // Without a value, the default holds.
                element.children.remove(place);
            } else {
                let what = format!("<{}> of <{PARAMS}> is empty and changes nothing", child.name);
                self.diagnostics.warning(&child.source, what, "write what is to be changed in it");
            }
        }
        Some(())
    }

    /// The place of the child that an element of an alteration means: that of its name, or else the first of its kind.
    fn child_like(&mut self, by: &Element, parent: &Element, is_modified: bool) -> Option<usize> {
        let name = by.attribute("name");
        let of_kind = |child: &&Element| child.name == by.name;
        let places = || {
            let numbered = parent.children.iter().enumerate();
            numbered.filter_map(|(place, child)| match child {
                Node::Element(child) if child.name == by.name => Some((place, child)),
                _ => None,
            })
        };
        let exact = places().find(|(_, child)| name.is_none() || child.attribute("name") == name);
        // What is modified may get another name.
        let found = exact.or_else(|| places().next().filter(|_| is_modified));
        let Some((place, child)) = found else {
            let called = name.map_or_else(String::new, |name| format!(" of the name '{name}'"));
            let names: Vec<String> =
                parent.elements().filter(of_kind).map(name_of).take(MOST_COMPARED).collect();
            let meant =
                self.diagnostics.did_you_mean(name.unwrap_or_default(), names.iter().map(String::as_str));
            let what = format!(
                "names an element{called} that <{}> '{}' does not have",
                parent.name,
                name_of(parent)
            );
            let remedy =
                meant.unwrap_or_else(|| "write action=\"add\" for the element, or take it out".into());
            return self.refuse(by, &what, &remedy);
        };
        if let (None, Some(first)) = (name, child.attribute("name")) {
            let what = format!("<{}> of <{PARAMS}> has no name: '{first}' is meant, the first one", by.name);
            self.diagnostics.warning(&by.source, what, "write its name=\"…\"");
        }
        Some(place)
    }
}

/// Adds an alteration to an `<include>`, after that one's own.
fn pass_on(name: &str, by: Element, include: &mut Element) {
    let source = by.source.clone();
    let params =
        Element { name: name.into(), attributes: Vec::new(), children: vec![Node::Element(by)], source };
    include.children.push(Node::Element(params));
}

/// Returns true if an `<include>` gives its model such an element.
fn is_of_include(element: &Element) -> bool {
    matches!(element.name.as_str(), "pose" | "static")
}

fn is_own(attribute: &str) -> bool {
    attribute == ELEMENT_ID || attribute == ACTION
}

/// The element of an alteration as it stands in the model.
fn bare(by: &Element) -> Element {
    let mut element = by.clone();
    element.attributes.retain(|(name, _)| !is_own(name));
    element
}

fn elements_mut(element: &mut Element) -> impl Iterator<Item = &mut Element> {
    element.children.iter_mut().filter_map(|child| match child {
        Node::Element(element) => Some(element),
        _ => None,
    })
}

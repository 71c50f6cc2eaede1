//! Calls of macros: finding the macro, and binding its parameters.

use super::super::fault::Fault;
use super::super::macros::{Macro, Parameter};
use super::super::scope::{Block, Property, Scope};
use super::super::value::Value;
use super::{Expander, Output};
use crate::diagnostics::Problem;
use crate::suggestion::{did_you_mean, did_you_mean_or};
use crate::xml::{Element, Node, Weight};
use std::collections::BTreeSet;
use std::rc::Rc;

impl Expander<'_> {
    /// Returns the macro with this name, and the namespace in which it was defined.
    pub(super) fn find_macro(&self, name: &str) -> Option<(Rc<Macro>, Option<Rc<Scope>>)> {
        for scope in self.scopes.iter().rev() {
            if let Some(definition) = scope.macros.get(name) {
                return Some((definition.clone(), None));
            }
            let mut space = scope;
            let mut home = None;
            let mut rest = name;
            while let Some((first, deeper)) = rest.split_once('.') {
                let Some(inner) = space.namespaces.get(first) else { break };
                (space, home, rest) = (inner, Some(inner.clone()), deeper);
            }
            if let (Some(home), Some(definition)) = (home, space.macros.get(rest)) {
                return Some((definition.clone(), Some(home)));
            }
        }
        None
    }

    pub(super) fn unknown_macro(&self, name: &str) -> Fault {
        let known: BTreeSet<&str> =
            self.scopes.iter().flat_map(|scope| scope.macros.keys()).map(String::as_str).collect();
        Fault::new(
            format!("unknown macro '{name}'"),
            did_you_mean_or(name, known, &format!("include the file that defines '{name}'")),
        )
    }

    pub(super) fn call(
        &mut self,
        element: &Element,
        definition: &Rc<Macro>,
        home: Option<Rc<Scope>>,
        at_top: bool,
        output: &mut Output,
    ) -> Result<(), Problem> {
        self.calls.push((definition.name.clone(), element.source.clone()));
        let scope = self.bind(element, definition)?;
        let below = self.scopes.len();
        self.scopes.extend(home.map(|home| Scope::clone(&home)));
        self.scopes.push(scope);
        let result = self.nodes(&definition.body, &definition.source, at_top, output);
        self.scopes.truncate(below);
        self.calls.pop();
        result
    }

    /// Creates the scope of a call, with attributes, blocks and defaults bound to the macro's parameters.
    fn bind(&mut self, element: &Element, definition: &Macro) -> Result<Scope, Problem> {
        let source = &element.source;
        let mut scope = Scope::default();
        for (name, text) in &element.attributes {
            if !definition.takes(name) {
                let known = definition.parameters.iter().filter_map(|parameter| match parameter {
                    Parameter::Value { name, .. } => Some(name.as_str()),
                    Parameter::Block(_) => None,
                });
                let fault = Fault::new(
                    format!("macro '{}' ({}) has no parameter '{name}'", definition.name, definition.source),
                    did_you_mean(name, known).unwrap_or_else(|| "leave it out".into()),
                );
                return Err(self.problem(fault, source));
            }
            let value = self.value(text, source).map_err(|fault| self.problem(fault, source))?;
            scope.properties.insert(name.clone(), Property::Known(value.into_literal()));
        }
        // Blocks are expanded in the scope of the caller.
        let mut blocks = Output::default();
        self.nodes(&element.children, source, false, &mut blocks)?;
        let mut blocks = blocks.children.into_iter().filter_map(|node| match node {
            Node::Element(element) => Some(element),
            Node::Text(_) | Node::Cdata(_) => None,
        });
        for parameter in &definition.parameters {
            match parameter {
                Parameter::Block(name) => {
                    let Some(block) = blocks.next() else {
                        let fault = Fault::new(
                            format!("macro '{}' needs a child element for '{name}'", definition.name),
                            format!("write it inside <{}>", element.name),
                        );
                        return Err(self.problem(fault, source));
                    };
                    let nodes =
                        if name.starts_with("**") { block.children } else { vec![Node::Element(block)] };
                    let weight = Weight::of(&nodes);
                    scope.blocks.insert(name.clone(), Block { nodes: nodes.into(), weight, expanded: true });
                }
                Parameter::Value { name, .. } if scope.properties.contains_key(name) => {}
                Parameter::Value { name, forward, default } => {
                    let value = self
                        .default(name, *forward, default.as_deref(), definition)
                        .map_err(|fault| self.problem(fault, source))?;
                    scope.properties.insert(name.clone(), Property::Known(value));
                }
            }
        }
        if let Some(block) = blocks.next() {
            let fault = Fault::new(
                format!("macro '{}' takes no child element <{}>", definition.name, block.name),
                "leave it out",
            );
            return Err(self.problem(fault, source));
        }
        Ok(scope)
    }

    fn default(
        &mut self,
        name: &str,
        forward: bool,
        default: Option<&str>,
        definition: &Macro,
    ) -> Result<Value, Fault> {
        if forward && let Some(value) = self.property(name, self.scopes.len() - 1)? {
            return Ok(value);
        }
        match default {
            Some(default) => Ok(self.value(default, &definition.source)?.into_literal()),
            None => Err(Fault::new(
                format!("macro '{}' is called without its parameter '{name}'", definition.name),
                format!("add {name}=\"…\""),
            )),
        }
    }
}

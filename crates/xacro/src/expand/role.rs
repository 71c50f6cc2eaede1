//! The role of an element: a directive of xacro, a call of a macro, or an element of the result.

use super::Expander;
use crate::fault::Fault;
use crate::macros::{Macro, Parameter};
use crate::names::{FOREIGN, TOP_LEVEL, is_own};
use crate::scope::Scope;
use crate::suggestion::did_you_mean_or;
use crate::xml::Element;
use std::collections::BTreeSet;
use std::rc::Rc;

/// The role of an element.
pub(super) enum Role {
    Directive(&'static str),
    Call(Rc<Macro>, Option<Rc<Scope>>),
    Plain,
}

/// The directives. Without the prefix, an element is a directive only if it has the given attribute.
const DIRECTIVES: [(&str, Option<&str>); 10] = [
    ("arg", Some("default")),
    ("attribute", None),
    ("call", None),
    ("element", None),
    ("if", Some("value")),
    ("include", Some("filename")),
    ("insert_block", Some("name")),
    ("macro", Some("name")),
    ("property", Some("name")),
    ("unless", Some("value")),
];

impl Expander<'_> {
    pub(super) fn role(&self, element: &Element, at_top: bool) -> Result<Role, Fault> {
        let prefixed = element.name.strip_prefix("xacro:");
        let name = prefixed.unwrap_or(&element.name);
        for (directive, mark) in DIRECTIVES {
            let meant = prefixed.is_some() || mark.is_some_and(|mark| element.attribute(mark).is_some());
            if name == directive && meant {
                return Ok(Role::Directive(directive));
            }
        }
        let found = if prefixed.is_some() || !is_own(name, at_top) { self.find_macro(name) } else { None };
        match found {
            Some((definition, home)) if prefixed.is_some() || self.is_call(element, &definition, at_top) => {
                Ok(Role::Call(definition, home))
            }
            None if prefixed.is_some() => Err(self.unknown_macro(name)),
            _ => Ok(Role::Plain),
        }
    }

    /// Returns true if an element without a prefix is a call of the macro with its name. At the top, where robots have
    /// few elements of their own, it is a call even if parameters are missing, unless it is inside the macro itself.
    fn is_call(&self, element: &Element, definition: &Macro, at_top: bool) -> bool {
        let is_inside = self.calls.iter().any(|(name, _)| *name == definition.name);
        self.fits(element, definition) || (at_top && !is_inside)
    }

    /// Warns about an element at the top of a file that is neither an element of URDF nor a macro. As in xacro, it is
    /// kept, because other programs have their own elements there.
    pub(super) fn check_top(&mut self, element: &Element) {
        let name = element.name.as_str();
        if !self.strict || TOP_LEVEL.contains(&name) || FOREIGN.contains(&name) || name.contains(':') {
            return;
        }
        let known: BTreeSet<&str> =
            self.scopes.iter().flat_map(|scope| scope.macros.keys()).map(String::as_str).collect();
        let otherwise = "write <xacro:… before the name of a macro";
        let remedy = did_you_mean_or(name, known, otherwise);
        let what = format!("<{name}> is neither an element of URDF nor a macro; it is passed on as it is");
        self.diagnostics.warning(&element.source, what, remedy);
    }

    /// Returns true if an element without the prefix `xacro:` can be a call of a macro: it has all required parameters
    /// and nothing else. An element that only shares the macro's name, such as `<sonar>` in a macro `sonar`, is an
    /// element of the robot.
    fn fits(&self, element: &Element, definition: &Macro) -> bool {
        let is_conditional = |child: &Element| matches!(child.name.as_str(), "xacro:if" | "xacro:unless");
        let is_given = |parameter: &Parameter| match parameter {
            Parameter::Value { name, forward, default } => {
                *forward || default.is_some() || element.attribute(name).is_some()
            }
            Parameter::Block(_) => true,
        };
        let blocks =
            definition.parameters.iter().filter(|parameter| matches!(parameter, Parameter::Block(_))).count();
        let is_being_expanded = self.calls.iter().any(|(name, _)| *name == definition.name);
        element.attributes.iter().all(|(name, _)| definition.takes(name))
            && definition.parameters.iter().all(is_given)
            && (element.elements().count() == blocks || element.elements().any(is_conditional))
            && element.text().is_empty()
            && !(is_being_expanded && element.attributes.is_empty())
    }
}

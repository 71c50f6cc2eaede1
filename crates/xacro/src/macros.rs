//! `<xacro:macro>`: parameters with defaults, and block parameters.

use super::fault::Fault;
use crate::diagnostics::Source;
use crate::xml::{Element, Node};
use std::rc::Rc;

/// The definition of a macro.
#[derive(Debug)]
pub(super) struct Macro {
    pub(super) name: String,
    pub(super) parameters: Vec<Parameter>,
    pub(super) body: Rc<[Node]>,
    pub(super) source: Source,
}

/// A parameter of a macro.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Parameter {
    /// A value from an attribute.
    Value {
        name: String,
        /// `^`: the value is that of the property with the same name in the caller's scope.
        forward: bool,
        /// The text that is evaluated if the attribute is missing.
        default: Option<String>,
    },
    /// A child element: `*name` is the element itself, `**name` is its content. The name includes the stars.
    Block(String),
}

impl Macro {
    /// Reads `<macro name="…" params="…">`.
    pub(super) fn parse(element: &Element) -> Result<Self, Fault> {
        let name = element.attribute("name").unwrap_or_default();
        let name = name.strip_prefix("xacro:").unwrap_or(name);
        if name.is_empty() {
            return Err(Fault::new("a macro without a name", "add the attribute 'name'"));
        }
        if name == "call" || name.contains('.') {
            return Err(Fault::new(
                format!("a macro cannot be named '{name}'"),
                "choose a name without dots",
            ));
        }
        let parameters = parameters(element.attribute("params").unwrap_or_default()).map_err(|what| {
            Fault::new(format!("params of macro '{name}': {what}"), "write 'a b:=1 *block'")
        })?;
        Ok(Self {
            name: name.to_owned(),
            parameters,
            body: element.children.clone().into(),
            source: element.source.clone(),
        })
    }

    /// Returns true if the macro has a parameter for an attribute with this name.
    pub(super) fn takes(&self, attribute: &str) -> bool {
        self.parameters.iter().any(|p| matches!(p, Parameter::Value { name, .. } if name == attribute))
    }
}

/// Parses `a b:=1 c:='x y' d:=${1 + 2} e:=^ f:=^|3 *block **content`; a single `=` is the older form of `:=`.
fn parameters(text: &str) -> Result<Vec<Parameter>, String> {
    let mut parameters = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let length = rest.find(|c: char| c.is_whitespace() || c == '=' || c == ':').unwrap_or(rest.len());
        let name = &rest[..length];
        if name.is_empty() {
            return Err(format!("'{rest}' has no name"));
        }
        rest = &rest[length..];
        // White space is allowed around the sign.
        let behind = rest.trim_start();
        let default = behind.strip_prefix(":=").or_else(|| behind.strip_prefix('='));
        if let Some(default) = default {
            rest = default.trim_start();
            let forward = rest.starts_with('^');
            if forward {
                rest = &rest[1..];
                rest = rest.strip_prefix('|').unwrap_or(rest);
            }
            let length = default_length(rest);
            let default = (length > 0 || !forward).then(|| rest[..length].to_owned());
            rest = rest[length..].trim_start();
            if name.starts_with('*') {
                return Err(format!("the block '{name}' cannot have a default"));
            }
            parameters.push(Parameter::Value { name: name.to_owned(), forward, default });
        } else {
            rest = behind;
            parameters.push(if name.starts_with('*') {
                Parameter::Block(name.to_owned())
            } else {
                Parameter::Value { name: name.to_owned(), forward: false, default: None }
            });
        }
    }
    Ok(parameters)
}

/// The length of a default value: up to white space outside quotes, `${…}` and `$(…)`.
fn default_length(text: &str) -> usize {
    let mut closers: Vec<char> = Vec::new();
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        match closers.last() {
            Some(close) if c == *close => {
                closers.pop();
            }
            Some('\'' | '"') => {}
            _ => match c {
                '\'' | '"' => closers.push(c),
                '{' if before == '$' || !closers.is_empty() => closers.push('}'),
                '(' if before == '$' || !closers.is_empty() => closers.push(')'),
                _ if c.is_whitespace() && closers.is_empty() => return at,
                _ => {}
            },
        }
        before = c;
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_with_defaults() {
        let value = |name: &str, forward, default: Option<&str>| Parameter::Value {
            name: name.into(),
            forward,
            default: default.map(Into::into),
        };
        assert_eq!(
            parameters(" parent b:=1 c:='x y' d=${1 + 2}\n e:=^ f:=^|3 g := 4 *origin **content h:=$(arg z)")
                .unwrap(),
            [
                value("parent", false, None),
                value("b", false, Some("1")),
                value("c", false, Some("'x y'")),
                value("d", false, Some("${1 + 2}")),
                value("e", true, None),
                value("f", true, Some("3")),
                value("g", false, Some("4")),
                Parameter::Block("*origin".into()),
                Parameter::Block("**content".into()),
                value("h", false, Some("$(arg z)")),
            ]
        );
        assert!(parameters("a := 1 := 2").is_err());
        assert!(parameters("*b:=1").is_err());
    }
}

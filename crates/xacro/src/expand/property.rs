//! Definitions of properties: a value, a default, or a block of elements.

use super::super::expression::is_keyword;
use super::super::fault::Fault;
use super::super::scope::{Block, Property};
use super::super::value::Value;
use super::Expander;
use crate::xml::{Element, Weight};

impl Expander<'_> {
    pub(super) fn define_property(&mut self, element: &Element) -> Result<(), Fault> {
        let source = &element.source;
        let name = self.string(element.attribute("name").unwrap_or_default(), source)?;
        let is_identifier = name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_alphanumeric() || c == '_');
        if !is_identifier || is_keyword(&name) || name.starts_with("__") {
            return Err(Fault::new(
                format!("a property cannot be named '{name}'"),
                "use letters, digits and underscores, beginning with a letter, and none of Python's keywords",
            ));
        }
        if element.attribute("remove").is_some() && self.condition(element, "remove")? {
            for scope in &mut self.scopes {
                scope.properties.remove(&name);
            }
            return Ok(());
        }
        let text = match (element.attribute("value"), element.attribute("default")) {
            (Some(text), _) => text,
            (None, Some(default)) => {
                if self.scopes.iter().any(|scope| scope.properties.contains_key(&name)) {
                    return Ok(());
                }
                default
            }
            (None, None) => {
                self.copied(element)?;
                let block = Block {
                    weight: Weight::of(&element.children),
                    nodes: element.children.clone().into(),
                    expanded: false,
                };
                self.top().blocks.insert(format!("**{name}"), block);
                return Ok(());
            }
        };
        let top = self.scopes.len() - 1;
        let target = match element.attribute("scope") {
            Some("global") => 0,
            Some("parent") => top.saturating_sub(1),
            // Files also contain `local`. As in xacro, any other word means the current scope.
            _ => top,
        };
        let lazy = !matches!(element.attribute("scope"), Some("global" | "parent"))
            && (element.attribute("lazy_eval").is_none() || self.condition(element, "lazy_eval")?);
        // A text in single quotes loses them here, and is parsed once more when it is used: xacro converts value="'3'"
        // to a number too.
        let property =
            match if lazy { Value::literal(text) } else { self.value(text, source)?.into_literal() } {
                Value::Text(text) if lazy && text.contains('$') => {
                    Property::Lazy { text, source: source.clone() }
                }
                Value::Text(text) if lazy => Property::Known(Value::literal(&text)),
                value => Property::Known(value),
            };
        self.scopes[target].properties.insert(name, property);
        Ok(())
    }
}

//! [`Filters`]: which entities a request is about.

use super::client::Client;
use super::refusal::Refusal;
use crate::ros2::cdr::Cdr;
use belvedere_bridge::payload::ModelState;
use regex_automata::meta::{Config, Regex};
use regex_automata::util::syntax;

/// Longest regular expression, in bytes, and the memory that it may take when it is compiled.
const MOST_PATTERN_BYTES: usize = 4096;
const MOST_REGEX_BYTES: usize = 1 << 20;
/// Most elements of the lists in a filter.
const MOST_ELEMENTS: usize = 4096;

/// A `simulation_interfaces/msg/EntityFilters`.
pub(super) struct Filters {
    /// `None` matches every name.
    name: Option<Regex>,
    /// Empty for all categories.
    categories: Vec<u8>,
}

impl Filters {
    /// Reads the filters of a request.
    ///
    /// # Errors
    /// A refusal if the expression is wrong, or a filter is not supported.
    pub(super) fn read(fields: &mut Cdr<'_>) -> Result<Self, Refusal> {
        let name = expression(fields.text()?)?;
        let categories = fields.list(MOST_ELEMENTS, Cdr::u8)?;
        let tags = fields.list(MOST_ELEMENTS, |fields| fields.text().map(drop))?;
        fields.u8()?;
        if !tags.is_empty() {
            return Err(Refusal::unsupported("entities have no tags, so they cannot be filtered by them"));
        }
        if fields.u8()? != 0 {
            return Err(Refusal::unsupported(
                "entities cannot be filtered by bounds; leave the type of the bounds at 0 (empty)",
            ));
        }
        Ok(Self { name, categories })
    }

    /// Returns those of the models that match.
    pub(super) fn select(&self, models: Vec<ModelState>, client: &mut Client<'_>) -> Vec<ModelState> {
        let mut selected = Vec::new();
        for model in models {
            let name = model.name.as_str();
            if self.name.as_ref().is_some_and(|name_filter| !name_filter.is_match(name)) {
                continue;
            }
            // The simulator is asked only if it matters. A model that was deleted meanwhile matches nothing.
            let matches = self.categories.is_empty()
                || client.describe(name).is_ok_and(|known| self.categories.contains(&known.category()));
            if matches {
                selected.push(model);
            }
        }
        selected
    }
}

/// Compiles a regular expression; `None` for an empty one, which matches every name.
fn expression(pattern: &str) -> Result<Option<Regex>, Refusal> {
    if pattern.is_empty() {
        return Ok(None);
    }
    if pattern.len() > MOST_PATTERN_BYTES {
        return Err(Refusal::failed(format!(
            "the filter has {} bytes, and at most {MOST_PATTERN_BYTES} are accepted",
            pattern.len()
        )));
    }
    let config = Config::new().nfa_size_limit(Some(MOST_REGEX_BYTES));
    let built = Regex::builder().configure(config).syntax(syntax::Config::new()).build(pattern);
    built.map(Some).map_err(|error| {
        let reason = match (error.syntax_error(), error.size_limit()) {
            // The last line of a long report with the pattern and a mark says what is wrong.
            (Some(error), _) => error.to_string().lines().last().unwrap_or_default().replace("error: ", ""),
            (None, Some(_)) => "it needs too much memory".to_owned(),
            (None, None) => error.to_string(),
        };
        Refusal::failed(format!("the filter '{pattern}' is not a regular expression: {reason}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_searched_for_extended_expressions() {
        for (pattern, name, matches) in [
            ("box", "wooden_box_2", true),
            ("^box", "wooden_box_2", false),
            ("^(wooden|steel)_box_[[:digit:]]+$", "wooden_box_2", true),
            ("^[^_]+_box_[0-9]{1,2}$", "wooden_box_234", false),
        ] {
            assert_eq!(expression(pattern).unwrap().unwrap().is_match(name), matches, "{pattern}");
        }
        assert!(expression("").unwrap().is_none());
        let refused = |pattern: &str| expression(pattern).unwrap_err().message;
        assert_eq!(refused("("), "the filter '(' is not a regular expression: unclosed group");
        assert!(
            refused("((((a{99}){99}){99}){99})").contains("too much memory"),
            "{}",
            refused("((((a{99}){99}){99}){99})")
        );
        assert!(refused(&"a".repeat(5000)).contains("5000 bytes"));
    }
}

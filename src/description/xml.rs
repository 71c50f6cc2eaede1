//! XML elements that remember the file and line they came from.
//!
//! xacro moves elements from one file into another, so a parsed document's own positions are not enough:
//! every [`Element`] carries its [`Source`] for life.

mod write;

use super::diagnostics::{Problem, Severity, Source};
use std::path::Path;
use std::sync::Arc;

/// Deepest nesting of elements: far beyond any robot's or world's.
const MAX_DEPTH: u32 = 200;

/// An element with its attributes in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Name as written, with its prefix if it has one (`xacro:macro`).
    pub name: String,
    /// Attributes as (name, value), in the order of the file.
    pub attributes: Vec<(String, String)>,
    /// Child elements and text, in the order of the file. Comments are left out.
    pub children: Vec<Node>,
    /// Where it stands.
    pub source: Source,
}

/// A child of an [`Element`].
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// A nested element.
    Element(Element),
    /// A run of text, entities resolved.
    Text(String),
}

impl Element {
    /// Reads and parses a file.
    ///
    /// # Errors
    /// A file that cannot be read or is not XML; the problem names the line and what the parser found.
    pub fn parse_file(path: &Path) -> Result<Self, Problem> {
        let fail = |line, what: String, remedy: &str| Problem {
            severity: Severity::Error,
            source: Source::new(path, line),
            what,
            remedy: remedy.into(),
        };
        let text = std::fs::read_to_string(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::NotFound => fail(0, "no such file".into(), "check the path"),
            std::io::ErrorKind::InvalidData => fail(0, "not UTF-8 text".into(), "save it as UTF-8"),
            _ => fail(0, format!("cannot be read: {error}"), "check the file's permissions"),
        })?;
        Self::parse(&text, path)
    }

    /// Parses a text that came from `path`.
    ///
    /// # Errors
    /// A text that is not XML; the problem names the line and what the parser found.
    pub fn parse(text: &str, path: &Path) -> Result<Self, Problem> {
        let file: Arc<Path> = path.into();
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| Problem {
            severity: Severity::Error,
            source: Source { file: file.clone(), line: error.pos().row },
            what: format!("broken XML: {error}"),
            remedy: "close or correct the element there".into(),
        })?;
        // What follows goes down the tree by recursion.
        let mut depths: Vec<u32> = Vec::new();
        for node in document.descendants() {
            let above = node.parent().and_then(|parent| depths.get(parent.id().get_usize()));
            let depth = above.map_or(0, |above| above + 1);
            if node.is_element() && depth > MAX_DEPTH {
                return Err(Problem {
                    severity: Severity::Error,
                    source: Source { file: file.clone(), line: document.text_pos_at(node.range().start).row },
                    what: format!("elements are nested more than {MAX_DEPTH} deep"),
                    remedy: "close those that are left open, or flatten them".into(),
                });
            }
            depths.push(depth);
        }
        Ok(convert(document.root_element(), &file, text))
    }

    /// The value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// Child elements, in order.
    pub fn elements(&self) -> impl Iterator<Item = &Element> {
        self.children.iter().filter_map(|child| match child {
            Node::Element(element) => Some(element),
            Node::Text(_) => None,
        })
    }

    /// Child elements of one name, in order.
    pub fn elements_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.elements().filter(move |element| element.name == name)
    }

    /// The first child element of that name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.elements().find(|element| element.name == name)
    }

    /// All text directly inside, trimmed.
    pub fn text(&self) -> String {
        let text: String = self
            .children
            .iter()
            .filter_map(|child| match child {
                Node::Text(text) => Some(text.as_str()),
                Node::Element(_) => None,
            })
            .collect();
        text.trim().to_owned()
    }
}

fn convert(node: roxmltree::Node<'_, '_>, file: &Arc<Path>, text: &str) -> Element {
    let document = node.document();
    // roxmltree resolves prefixes; the written name is what xacro and error messages go by.
    let written = |range: std::ops::Range<usize>| text[range].to_owned();
    let name_start = node.range().start + 1;
    let name_len = text[name_start..]
        .find(|c: char| c.is_whitespace() || c == '>' || c == '/')
        .unwrap_or(text.len() - name_start);
    let source = Source { file: file.clone(), line: document.text_pos_at(node.range().start).row };
    Element {
        name: written(name_start..name_start + name_len),
        attributes: node.attributes().map(|a| (written(a.range_qname()), a.value().to_owned())).collect(),
        children: node
            .children()
            .filter_map(|child| {
                if child.is_element() {
                    Some(Node::Element(convert(child, file, text)))
                } else if child.is_text() {
                    child.text().map(|text| Node::Text(text.to_owned()))
                } else {
                    None
                }
            })
            .collect(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_prefixes_and_lines() {
        let text = "<robot xmlns:xacro='http://x'>\n<!-- c -->\n<xacro:macro name='m' a='&lt;1'>t</xacro:macro></robot>";
        let robot = Element::parse(text, Path::new("r.xacro")).unwrap();
        let element = robot.child("xacro:macro").unwrap();
        assert_eq!(element.attribute("a"), Some("<1"));
        assert_eq!(element.text(), "t");
        assert_eq!(element.source.to_string(), "r.xacro:3");
    }

    #[test]
    fn bottomless_nesting_is_refused() {
        let nested = |depth| format!("{}\n{}", "<a>".repeat(depth), "</a>".repeat(depth));
        assert!(Element::parse(&nested(200), Path::new("x")).is_ok());
        for depth in [201, 100_000] {
            let problem = Element::parse(&nested(depth), Path::new("x")).unwrap_err().to_string();
            assert!(problem.contains("more than 200 deep"), "{problem}");
        }
    }

    #[test]
    fn broken_xml_names_its_line() {
        let problem = Element::parse("<a>\n<b>\n</a>", Path::new("x.urdf")).unwrap_err();
        assert!(problem.to_string().starts_with("x.urdf:3: error: broken XML"), "{problem}");
    }
}

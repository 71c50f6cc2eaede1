//! XML elements that keep the file and line they came from.
//!
//! xacro moves elements from one file to another, so positions in a single document are not enough: every [`Element`]
//! has its own [`Source`].

mod parse;
mod write;

use super::diagnostics::{Problem, Severity, Source};
use super::encoding::{NotRead, utf_8_or_latin_1};
use std::path::Path;

/// An element with its attributes in order.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Name as written, with its prefix if it has one (`xacro:macro`).
    pub name: String,
    /// Attributes as (name, value), in the order of the file.
    pub attributes: Vec<(String, String)>,
    /// Child elements and text, in the order of the file. Comments are left out.
    pub children: Vec<Node>,
    /// The place at which it was written.
    pub source: Source,
}

/// A child of an [`Element`].
#[derive(Debug, Clone, PartialEq)]
pub enum Node {
    /// A nested element.
    Element(Element),
    /// Text with resolved entities.
    Text(String),
    /// The text of a CDATA section, in which xacro expands nothing.
    Cdata(String),
}

/// Reads the text of a file, in UTF-8 or ISO 8859-1.
///
/// # Errors
/// If the file cannot be read, or is no text.
pub fn read_text(path: &Path) -> Result<String, Problem> {
    let fail = |what: String, remedy: &str| Problem {
        severity: Severity::Error,
        source: Source::new(path, 0),
        what,
        remedy: remedy.into(),
    };
    let bytes = crate::file::read(path).map_err(|error| {
        let what = match error.kind() {
            std::io::ErrorKind::NotFound => match crate::file::obstacle(path) {
                Some(why) => format!("cannot be read: {why}"),
                None => "no such file".into(),
            },
            std::io::ErrorKind::IsADirectory => "this is a folder".into(),
            _ => format!("cannot be read: {error}"),
        };
        fail(what, crate::file::remedy(&error))
    })?;
    utf_8_or_latin_1(bytes, path).map_err(|NotRead { what, remedy }| fail(what, &remedy))
}

/// The size of a tree of elements, as it counts against a [`Budget`](crate::budget::Budget).
#[derive(Debug, Clone, Copy, Default)]
pub struct Weight {
    /// The number of elements.
    pub elements: usize,
    /// The bytes of names, attributes and texts.
    pub bytes: usize,
    /// The number of levels.
    pub depth: usize,
}

impl Weight {
    /// Adds up the weights of adjacent nodes.
    pub fn of(nodes: &[Node]) -> Self {
        nodes.iter().fold(Self::default(), |sum, node| {
            let node = match node {
                Node::Element(element) => element.weight(),
                Node::Text(text) | Node::Cdata(text) => Self { bytes: text.len(), ..Self::default() },
            };
            Self {
                elements: sum.elements + node.elements,
                bytes: sum.bytes + node.bytes,
                depth: sum.depth.max(node.depth),
            }
        })
    }
}

impl Element {
    /// Reads and parses a file.
    ///
    /// # Errors
    /// If the file cannot be read or is not XML; the problem names the line and what the parser found.
    pub fn parse_file(path: &Path) -> Result<Self, Problem> {
        Self::parse(&read_text(path)?, path)
    }

    /// Parses a text that came from `path`.
    ///
    /// # Errors
    /// If the text is not XML; the problem names the line and what the parser found.
    pub fn parse(text: &str, path: &Path) -> Result<Self, Problem> {
        parse::document(text, &path.into())
    }

    /// Measures this element and its content.
    pub fn weight(&self) -> Weight {
        let attributes: usize = self.attributes.iter().map(|(name, value)| name.len() + value.len()).sum();
        let mut weight = Weight::of(&self.children);
        weight.elements += 1;
        weight.bytes += self.name.len() + attributes;
        weight.depth += 1;
        weight
    }

    /// Returns the value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// Returns the child elements, in order.
    pub fn elements(&self) -> impl Iterator<Item = &Element> {
        self.children.iter().filter_map(|child| match child {
            Node::Element(element) => Some(element),
            Node::Text(_) | Node::Cdata(_) => None,
        })
    }

    /// Returns the child elements with one name, in order.
    pub fn elements_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.elements().filter(move |element| element.name == name)
    }

    /// Returns the first child element with this name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.elements().find(|element| element.name == name)
    }

    /// Returns all text directly inside, trimmed.
    pub fn text(&self) -> String {
        let text: String = self
            .children
            .iter()
            .filter_map(|child| match child {
                Node::Text(text) | Node::Cdata(text) => Some(text.as_str()),
                Node::Element(_) => None,
            })
            .collect();
        text.trim().to_owned()
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
    fn xml_that_gazebo_accepts_is_accepted() {
        let text = "\n<?xml version='1.0'?>\n<!-- a -- b ---><sdf><gz:pose a=\"1 < 2 && x > 0\" gz:b='&#65;&#x42;&nbsp;'>\r\n\
            R&D &lt;<![CDATA[<&]]></gz:pose>\n<b/></sdf>\n<!-- end -->";
        let root = Element::parse(text, Path::new("w.sdf")).unwrap();
        let pose = root.child("gz:pose").unwrap();
        assert_eq!(pose.attribute("a"), Some("1 < 2 && x > 0"));
        assert_eq!(pose.attribute("gz:b"), Some("AB&nbsp;"));
        assert_eq!(pose.text(), "R&D <<&");
        assert_eq!(root.child("b").unwrap().source.line, 5);
    }

    #[test]
    fn lines_are_found_in_linear_time() {
        // One element per line; 4 MB take four times as long as 1 MB, not sixteen times.
        let text = |lines: usize| format!("<a>\n{}</a>", "<link name='wheel' mass='1.0'/>\n".repeat(lines));
        let seconds = |text: &str| {
            let took = |_| {
                let start = std::time::Instant::now();
                let root = Element::parse(text, Path::new("x")).unwrap();
                let took = start.elapsed();
                assert_eq!(root.elements().last().unwrap().source.line as usize, text.lines().count() - 1);
                took.as_secs_f64()
            };
            (0..3).map(took).fold(f64::INFINITY, f64::min)
        };
        let (short, long) = (text(33_000), text(132_000));
        assert!(short.len() > 1_000_000 && long.len() > 4_000_000);
        // On a machine with other load, some ratios are too large.
        let mut ratios = (0..8).map(|_| seconds(&long) / seconds(&short));
        assert!(ratios.any(|ratio| ratio < 8.0), "sixteen times as long, or so");
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
        for (text, line) in [
            ("<a>\n<b>\n</a>", 3),
            ("<a>\n<b>\n", 3),
            ("<a>\n<b c='1/>\n</a>", 2),
            ("<a>\n<b c=1/></a>", 2),
            ("<a/>\n<b/>", 2),
            ("<a/>\nend", 2),
            ("a { b }", 1),
            ("<a>\n< b/></a>", 2),
            ("<a b='1' b='2'/>", 1),
        ] {
            let problem = Element::parse(text, Path::new("x.urdf")).unwrap_err().to_string();
            assert!(problem.starts_with(&format!("x.urdf:{line}: error: broken XML")), "{text}: {problem}");
        }
    }
}

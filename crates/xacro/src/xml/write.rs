//! Writes elements as XML, for programs that only read plain URDF.

use super::{Element, Node};
use std::collections::BTreeSet;
use std::fmt;

/// The number of columns by which each level is indented.
const INDENT: usize = 2;

/// Writes a whole XML document with this element as the outermost.
///
/// Attributes and text keep their content. White space between elements is replaced. Prefixes of names
/// (`sensor:camera`) are kept and declared at the outermost element; their original meaning is not known here, and
/// readers of URDF ignore it.
impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "<?xml version=\"1.0\"?>")?;
        let mut prefixes = BTreeSet::new();
        collect_prefixes(self, &mut prefixes);
        element(f, self, 0, &prefixes)
    }
}

fn element(
    f: &mut fmt::Formatter<'_>,
    written: &Element,
    depth: usize,
    declared: &BTreeSet<&str>,
) -> fmt::Result {
    let indent = depth * INDENT;
    write!(f, "{:indent$}<{}", "", written.name)?;
    for prefix in declared {
        write!(f, " xmlns:{prefix}=\"{prefix}\"")?;
    }
    for (name, value) in &written.attributes {
        write!(f, " {name}=\"{}\"", Escaped { text: value, in_attribute: true })?;
    }
    if written.elements().next().is_none() {
        let text = written.text();
        return if text.is_empty() {
            writeln!(f, "/>")
        } else {
            writeln!(f, ">{}</{}>", Escaped { text: &text, in_attribute: false }, written.name)
        };
    }
    writeln!(f, ">")?;
    for child in &written.children {
        match child {
            Node::Element(child) => element(f, child, depth + 1, &BTreeSet::new())?,
            Node::Text(text) | Node::Cdata(text) if text.trim().is_empty() => {}
            Node::Text(text) | Node::Cdata(text) => {
                writeln!(f, "{}", Escaped { text: text.trim(), in_attribute: false })?;
            }
        }
    }
    writeln!(f, "{:indent$}</{}>", "", written.name)
}

fn collect_prefixes<'e>(element: &'e Element, prefixes: &mut BTreeSet<&'e str>) {
    let names = element.attributes.iter().map(|(name, _)| name).chain([&element.name]);
    // `xml:` needs no declaration.
    prefixes.extend(names.filter_map(|name| Some(name.split_once(':')?.0)).filter(|prefix| *prefix != "xml"));
    for child in element.elements() {
        collect_prefixes(child, prefixes);
    }
}

/// A text with entities in place of special characters.
struct Escaped<'t> {
    text: &'t str,
    in_attribute: bool,
}

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rest = self.text;
        while let Some(at) = rest.find(|c| self.entity(c).is_some()) {
            let (plain, special) = rest.split_at(at);
            f.write_str(plain)?;
            let mut characters = special.chars();
            f.write_str(characters.next().and_then(|c| self.entity(c)).unwrap_or_default())?;
            rest = characters.as_str();
        }
        f.write_str(rest)
    }
}

impl Escaped<'_> {
    fn entity(&self, c: char) -> Option<&'static str> {
        Some(match c {
            '&' => "&amp;",
            '<' => "&lt;",
            '>' => "&gt;",
            '\r' => "&#13;",
            '"' if self.in_attribute => "&quot;",
            // Readers make spaces of these in attributes.
            '\t' if self.in_attribute => "&#9;",
            '\n' if self.in_attribute => "&#10;",
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn parse(text: &str) -> Element {
        Element::parse(text, Path::new("r.urdf")).unwrap()
    }

    #[test]
    fn documents_are_indented_by_level() {
        let robot = parse("<robot name='r'><link name='a'>\n\n<x/></link><!-- c --><t> 1 2\n</t></robot>");
        let expected = "<?xml version=\"1.0\"?>
<robot name=\"r\">
  <link name=\"a\">
    <x/>
  </link>
  <t>1 2</t>
</robot>
";
        assert_eq!(robot.to_string(), expected);
    }

    #[test]
    fn special_characters_survive_a_round_trip() {
        let robot = parse(
            "<r a='&lt;&amp;&quot;&#9;&#10;&#13;>' xmlns:s='http://s' s:b='1'><s:c>a &lt; b ]]&gt; &amp;amp;</s:c>t<d/></r>",
        );
        let again = parse(&robot.to_string());
        assert_eq!(again.attributes, robot.attributes);
        assert_eq!(again.text(), "t");
        assert_eq!(again.child("s:c").unwrap().text(), robot.child("s:c").unwrap().text());
    }
}

//! A single-pass XML parser with line numbers, as tolerant as the one of Gazebo (tinyxml).
//!
//! It accepts some input that the standard forbids: `--` inside comments, undeclared prefixes (`gz:pose`), `<` in
//! attributes, an `&` that does not begin an entity, and text that is not UTF-8.

use super::{Element, Node};
use crate::diagnostics::{Problem, Severity, Source};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// The greatest nesting of elements, far more than in any robot or world.
const MAX_DEPTH: usize = 200;

/// Returns the outermost element of a text that came from `file`.
pub(super) fn document(text: &str, file: &Arc<Path>) -> Result<Element, Problem> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = Lines { text: text.as_bytes(), counted: 0, line: 1 };
    let problem = |line: u32, what: String, remedy: &str| Problem {
        severity: Severity::Error,
        source: Source { file: file.clone(), line },
        what,
        remedy: remedy.into(),
    };
    let broken = |line: u32, what: &str| {
        problem(line, format!("broken XML: {what}"), "close or correct the element there")
    };
    let mut reader = Reader::from_str(text);
    reader.config_mut().allow_dangling_amp = true;
    // The open elements, outermost first.
    let mut open: Vec<Element> = Vec::new();
    let mut root: Option<Element> = None;
    loop {
        let line = lines.at(reader.buffer_position());
        let event = match reader.read_event() {
            Ok(event) => event,
            Err(error) => {
                let line = lines.at(reader.error_position());
                return Err(broken(line, &error.to_string()));
            }
        };
        let closed = match event {
            Event::Start(tag) | Event::Empty(tag) if root.is_some() => {
                let name = String::from_utf8_lossy(tag.name().0).into_owned();
                return Err(broken(line, &format!("<{name}> follows the outermost element")));
            }
            Event::Start(_) | Event::Empty(_) if open.len() >= MAX_DEPTH => {
                return Err(problem(
                    line,
                    format!("elements are nested more than {MAX_DEPTH} deep"),
                    "close the open elements, or nest fewer",
                ));
            }
            Event::Start(tag) => {
                let source = Source { file: file.clone(), line };
                open.push(element(&tag, source).map_err(|what| broken(line, &what))?);
                None
            }
            Event::Empty(tag) => {
                let source = Source { file: file.clone(), line };
                Some(element(&tag, source).map_err(|what| broken(line, &what))?)
            }
            Event::End(_) => open.pop(),
            Event::Text(text) => {
                let text = unescaped(&String::from_utf8_lossy(&text), false);
                if open.is_empty() && !text.trim().is_empty() {
                    let before = text.len() - text.trim_start().len();
                    let line = line + text[..before].matches('\n').count() as u32;
                    return Err(broken(line, "there is text outside the outermost element"));
                }
                add_text(&mut open, &text);
                None
            }
            Event::GeneralRef(name) => {
                add_text(&mut open, &unescaped(&format!("&{};", String::from_utf8_lossy(&name)), false));
                None
            }
            Event::CData(text) => {
                if let Some(parent) = open.last_mut() {
                    parent.children.push(Node::Cdata(String::from_utf8_lossy(&text).into_owned()));
                }
                None
            }
            Event::Eof => break,
            Event::Comment(_) | Event::Decl(_) | Event::PI(_) | Event::DocType(_) => None,
        };
        if let Some(closed) = closed {
            match open.last_mut() {
                Some(parent) => parent.children.push(Node::Element(closed)),
                None => root = Some(closed),
            }
        }
    }
    if let Some(last) = open.last() {
        let line = lines.at(text.len() as u64);
        return Err(broken(line, &format!("<{}> at line {} is never closed", last.name, last.source.line)));
    }
    root.ok_or_else(|| match text.trim() {
        "" => problem(1, "broken XML: the file is empty".into(), "restore its content, or name another file"),
        _ => broken(1, "there is no element"),
    })
}

fn add_text(open: &mut [Element], text: &str) {
    let Some(parent) = open.last_mut() else { return };
    match parent.children.last_mut() {
        Some(Node::Text(before)) => before.push_str(text),
        _ => parent.children.push(Node::Text(text.to_owned())),
    }
}

/// Returns an element without its content, or an error in its tag.
fn element(tag: &BytesStart<'_>, source: Source) -> Result<Element, String> {
    let name = String::from_utf8_lossy(tag.name().0).into_owned();
    is_name(&name)?;
    let mut keys = HashSet::new();
    let attributes = tag
        .attributes()
        // The library would compare each attribute with all before it.
        .with_checks(false)
        .map(|attribute| {
            let attribute = attribute.map_err(|error| format!("{error} in <{name}>"))?;
            if !keys.insert(attribute.key.0) {
                let key = String::from_utf8_lossy(attribute.key.0);
                return Err(format!("<{name}> has the attribute '{key}' twice"));
            }
            let key = String::from_utf8_lossy(attribute.key.0).into_owned();
            is_name(&key)?;
            Ok((key, unescaped(&String::from_utf8_lossy(&attribute.value), true)))
        })
        // Declarations of prefixes are not attributes of the element.
        .filter(|attribute| !matches!(attribute, Ok((key, _)) if key == "xmlns" || key.starts_with("xmlns:")))
        .collect::<Result<_, String>>()?;
    Ok(Element { name, attributes, children: Vec::new(), source })
}

fn is_name(name: &str) -> Result<(), String> {
    let begins = |c: char| c.is_alphabetic() || matches!(c, '_' | ':');
    let goes_on = |c: char| !c.is_whitespace() && !matches!(c, '<' | '>' | '"' | '\'' | '=' | '&' | '/');
    if name.starts_with(begins) && name.chars().all(goes_on) {
        return Ok(());
    }
    Err(format!("'{name}' cannot be the name of an element or attribute"))
}

/// Resolves entities and normalises white space by the rules of XML. Invalid entities are kept as text.
fn unescaped(raw: &str, in_attribute: bool) -> String {
    let mut text = String::with_capacity(raw.len());
    let mut rest = raw;
    while let Some(at) = rest.find(['&', '\r', '\n', '\t']) {
        text.push_str(&rest[..at]);
        let (special, behind) = rest[at..].split_at(1);
        rest = behind;
        match special {
            "&" => match entity(behind) {
                Some((character, length)) => {
                    text.push(character);
                    rest = &behind[length..];
                }
                None => text.push('&'),
            },
            "\r" if behind.starts_with('\n') => {}
            _ if in_attribute => text.push(' '),
            "\r" => text.push('\n'),
            _ => text.push_str(special),
        }
    }
    text.push_str(rest);
    text
}

/// Returns the character of the entity with which `text` begins, without its `&`, and its length.
fn entity(text: &str) -> Option<(char, usize)> {
    // The longest entity is a character by its number.
    let end = text.bytes().take(10).position(|byte| byte == b';')?;
    let name = &text[..end];
    let number = |text: &str, radix| u32::from_str_radix(text, radix).ok().and_then(char::from_u32);
    let character = match name {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "quot" => '"',
        "apos" => '\'',
        _ => match name.strip_prefix('#')? {
            number_text if number_text.starts_with(['x', 'X']) => number(&number_text[1..], 16)?,
            number_text => number(number_text, 10)?,
        },
    };
    Some((character, end + 1))
}

/// Counts lines in a single pass through the text, however often they are requested.
struct Lines<'t> {
    text: &'t [u8],
    counted: usize,
    line: u32,
}

impl Lines<'_> {
    #[expect(clippy::naive_bytecount, reason = "fast enough, and no dependency more")]
    /// Returns the line of a position, which must not be before the previous one.
    fn at(&mut self, place: u64) -> u32 {
        let place = usize::try_from(place).unwrap_or(usize::MAX).min(self.text.len());
        if place > self.counted {
            let passed = &self.text[self.counted..place];
            self.line += passed.iter().filter(|byte| **byte == b'\n').count() as u32;
            self.counted = place;
        }
        self.line
    }
}

//! The support of every element and attribute of SDF and URDF.
//!
//! The tables `elements/sdf.txt` and `elements/urdf.txt` list what a file can contain, and whether it is read, is harmless,
//! or would have an effect but is not simulated. [`report`] compares a file with them. For each kind of element it reports
//! once what is not simulated, and what is unknown. `elements/plugins.txt` lists the parameters of each plugin that is
//! known, with which [`report_plugin`] compares it.
//!
//! A table is a list of contexts. A line without indentation begins a context; the lines below are its elements and, with
//! a dot, its attributes:
//!
//! | line | meaning |
//! |---|---|
//! | `name` | read; the elements inside it follow, indented further |
//! | `name = context` | read; the elements inside it are those of that context |
//! | `name *` | the element's parser reads everything in it, and reports itself what it leaves out |
//! | `name ~` | harmless: it changes neither motion nor measurements |
//! | `name ! values: difference` | not simulated, with that difference, unless it has one of the values; gives a warning |
//! | `name ? values: difference` | the same for what rarely matters; gives a note |
//! | `+ context` | the rows of that context |
//!
//! The row `others @ context: place` says that the elements of another context belong in that place, and gives a warning.
//! The row `* *` stands for all other elements of the context, which the parser reports itself.
//!
//! A value is a text, numbers, `*` for an empty value, or `=NAME` for the value of the sibling element of that name.

use crate::diagnostics::{Diagnostics, Problem, Severity, Source};
use crate::suggestion::did_you_mean;
use crate::xml::Element;
use std::collections::BTreeMap;
use std::sync::LazyLock;

const TABLES: [&str; 3] = [
    include_str!("elements/sdf.txt"),
    include_str!("elements/urdf.txt"),
    include_str!("elements/plugins.txt"),
];

static CONTEXTS: LazyLock<BTreeMap<&'static str, Vec<Row>>> = LazyLock::new(|| {
    let mut contexts = BTreeMap::new();
    for Row { name, inside, .. } in TABLES.iter().flat_map(|table| rows(&mut table.lines().peekable(), 0)) {
        // Rows that a context takes from another one are those of an earlier one.
        let with_taken = inside.into_iter().flat_map(|row| match row.fate {
            Fate::Taken(from) => contexts.get(from).cloned().unwrap_or_else(|| vec![row]),
            _ => vec![row],
        });
        let with_taken: Vec<Row> = with_taken.collect();
        contexts.insert(name, with_taken);
    }
    contexts
});

/// A row of a table.
#[derive(Clone)]
struct Row {
    /// The name of an element, or of an attribute with a dot before it.
    name: &'static str,
    fate: Fate,
    inside: Vec<Row>,
}

/// The support of an element or attribute.
#[derive(Clone)]
enum Fate {
    Read,
    Context(&'static str),
    /// Its content is not compared.
    Passed,
    /// The rows of this context stand here.
    Taken(&'static str),
    NotSimulated {
        severity: Severity,
        unless: Vec<&'static str>,
        difference: &'static str,
    },
    /// The elements of this context belong in this place.
    Elsewhere {
        context: &'static str,
        place: &'static str,
    },
}

/// Reads the lines of one indentation depth, each with the more deeply indented lines below it.
fn rows(lines: &mut std::iter::Peekable<std::str::Lines<'static>>, depth: usize) -> Vec<Row> {
    let mut found = Vec::new();
    while let Some(line) = lines.peek() {
        let text = line.trim_start();
        if line.len() - text.len() < depth {
            break;
        }
        lines.next();
        let (name, rest) = text.split_once(' ').unwrap_or((text, ""));
        let fate = match (rest.chars().next(), rest.get(2..).unwrap_or_default()) {
            (None, _) => Fate::Read,
            (Some(_), _) if name == "+" => Fate::Taken(rest),
            (Some('='), context) => Fate::Context(context),
            (Some('@'), rest) => {
                let (context, place) = rest.split_once(": ").unwrap_or_default();
                Fate::Elsewhere { context, place }
            }
            (Some(mark @ ('!' | '?')), rest) => {
                let severity = if mark == '!' { Severity::Warning } else { Severity::Note };
                let (values, difference) = rest.split_once(": ").unwrap_or_default();
                Fate::NotSimulated { severity, unless: values.split(',').collect(), difference }
            }
            (Some(_), _) => Fate::Passed,
        };
        found.push(Row { name, fate, inside: rows(lines, depth + 2) });
    }
    found
}

/// Reports to `diagnostics` what is not simulated or unknown in the elements of one file. Each element comes with its
/// context in the tables, such as `root` for `<sdf>`.
pub(crate) fn report<'e>(
    elements: impl IntoIterator<Item = (&'e Element, &'e str)>,
    diagnostics: &mut Diagnostics,
) {
    let mut report = Report::default();
    for (element, context) in elements {
        report.inside(element, inside(&CONTEXTS, context));
    }
    report.finish("file", diagnostics);
}

/// Reports to `diagnostics` which parameters of a plugin are not simulated or unknown. The context is the plugin's name.
pub(crate) fn report_plugin(plugin: &Element, context: &str, diagnostics: &mut Diagnostics) {
    let mut report = Report::default();
    report.inside(plugin, inside(&CONTEXTS, context));
    report.finish("plugin", diagnostics);
}

/// Whether the tables have a context of that name.
pub(crate) fn has_context(name: &str) -> bool {
    CONTEXTS.contains_key(name)
}

/// Whether a context has an element of that name.
pub(crate) fn knows(context: &str, element: &str) -> bool {
    inside(&CONTEXTS, context).iter().any(|row| row.name == element)
}

/// Returns how messages call an element: plugins by their name.
fn title(element: &Element) -> String {
    match element.attribute("name").or(element.attribute("filename")) {
        Some(name) if element.name == "plugin" => format!("plugin '{name}'"),
        _ => format!("<{}>", element.name),
    }
}

fn inside<'t>(contexts: &'t BTreeMap<&'static str, Vec<Row>>, context: &str) -> &'t [Row] {
    contexts.get(context).map_or(&[], Vec::as_slice)
}

/// The problems of one file: the first of each kind, and how often each occurs.
#[derive(Default)]
struct Report {
    found: BTreeMap<(String, String), (Problem, usize)>,
}

impl Report {
    /// Adds the problems to `diagnostics`, with how often they occur in this `place`.
    fn finish(self, place: &str, diagnostics: &mut Diagnostics) {
        for (first, count) in self.found.into_values() {
            let Problem { severity, source, mut what, remedy } = first;
            if count > 1 {
                what = format!("{what} ({count} times in this {place})");
            }
            diagnostics.add(Problem { severity, source, what, remedy });
        }
    }

    fn inside(&mut self, element: &Element, rows: &'static [Row]) {
        // Looked up once, since an element may have any number of attributes that are not known.
        let title = title(element);
        for (name, value) in &element.attributes {
            // Names with a prefix belong to other programs; a value may be in an attribute instead of the element.
            if name.contains(':') || name == "xmlns" || name == "value" {
                continue;
            }
            let what = format!("attribute '{name}'");
            if let Some(row) = rows.iter().find(|row| row.name.strip_prefix('.') == Some(name)) {
                self.not_simulated(row, (element, &title), &what, value, &element.source);
            } else {
                let known = rows.iter().filter_map(|row| row.name.strip_prefix('.'));
                self.unknown((element, &title), &what, did_you_mean(name, known), &element.source);
            }
        }
        for child in element.elements() {
            let what = format!("<{}>", child.name);
            match rows.iter().find(|row| row.name == child.name) {
                Some(row) => match row.fate {
                    Fate::Read => self.inside(child, &row.inside),
                    Fate::Context(context) => self.inside(child, inside(&CONTEXTS, context)),
                    Fate::Passed | Fate::Elsewhere { .. } | Fate::Taken(_) => {}
                    Fate::NotSimulated { .. } => {
                        let value = child.attribute("value").map_or_else(|| child.text(), str::to_owned);
                        self.not_simulated(row, (element, &title), &what, &value, &child.source);
                    }
                },
                None if child.name.contains(':') || rows.iter().any(|row| row.name == "*") => {}
                None => {
                    let (parent, source) = (&element.name, &child.source);
                    if let Some(place) = place_of(&child.name, rows) {
                        let text =
                            format!("{what} of <{parent}> is left out, because Gazebo reads it from {place}");
                        self.add(element, &what, Severity::Warning, source, text, "move it there".to_owned());
                    } else {
                        let known = rows.iter().map(|row| row.name).filter(|name| !name.starts_with('.'));
                        self.unknown((element, &title), &what, did_you_mean(&child.name, known), source);
                    }
                }
            }
        }
    }

    fn not_simulated(
        &mut self,
        row: &Row,
        (parent, title): (&Element, &str),
        what: &str,
        value: &str,
        source: &Source,
    ) {
        let Fate::NotSimulated { severity, unless, difference } = &row.fate else { return };
        if unless.iter().any(|usual| is_value(value, usual, parent)) {
            return;
        }
        let value = value.trim();
        let written = if value.is_empty() { String::new() } else { format!("is '{value}' and ") };
        let what = format!("{what} of {title} {written}is not simulated: {difference}");
        self.add(parent, row.name, *severity, source, what, String::new());
    }

    fn unknown(
        &mut self,
        (parent, title): (&Element, &str),
        what: &str,
        meant: Option<String>,
        source: &Source,
    ) {
        let text = format!("{what} of {title} is not known, and is left out");
        let remedy = meant.unwrap_or_else(|| "check its spelling, and where it belongs".to_owned());
        self.add(parent, what, Severity::Warning, source, text, remedy);
    }

    fn add(
        &mut self,
        parent: &Element,
        name: &str,
        severity: Severity,
        source: &Source,
        what: String,
        remedy: String,
    ) {
        let problem = Problem { severity, source: source.clone(), what, remedy };
        self.found.entry((parent.name.clone(), name.to_owned())).or_insert((problem, 0)).1 += 1;
    }
}

/// Returns where an element belongs that is not one of its parent's, if the rows of the parent say so.
fn place_of(name: &str, rows: &[Row]) -> Option<&'static str> {
    rows.iter().find_map(|row| match row.fate {
        Fate::Elsewhere { context, place } => {
            inside(&CONTEXTS, context).iter().any(|row| row.name == name).then_some(place)
        }
        _ => None,
    })
}

/// Returns true if a text is the value in a table.
fn is_value(text: &str, value: &str, parent: &Element) -> bool {
    if value == "*" {
        return false;
    }
    let beside = value.strip_prefix('=').and_then(|name| parent.child(name)).map(Element::text);
    let value = beside.as_deref().unwrap_or(value);
    let numbers =
        |text: &str| -> Option<Vec<f64>> { text.split_whitespace().map(|word| word.parse().ok()).collect() };
    text.trim().eq_ignore_ascii_case(value)
        || numbers(text).zip(numbers(value)).is_some_and(|(text, value)| text == value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn told(text: &str, context: &str) -> Vec<String> {
        let element = Element::parse(text, Path::new("f")).unwrap();
        let mut diagnostics = Diagnostics::default();
        report([(&element, context)], &mut diagnostics);
        diagnostics.problems().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_is_not_simulated_is_told_once_with_its_difference() {
        let link = |slip: &str| {
            format!(
                "<link name='l'><collision name='c'><surface><friction>\n<ode><slip1>{slip}</slip1></ode></friction></surface></collision></link>"
            )
        };
        let model = format!("<model name='m'>{}{}{}</model>", link("0.5"), link("0.0"), link("2"));
        assert_eq!(
            told(&model, "model"),
            [
                "f:2: warning: <slip1> of <ode> is '0.5' and is not simulated: contacts do not slip below the friction limit \
              (2 times in this file)"
            ]
        );
        let surface = |mu2: &str| {
            format!("<surface><friction><ode><mu>0.8</mu><mu2>{mu2}</mu2></ode></friction></surface>")
        };
        assert_eq!(told(&surface("0.80"), "surface"), [""; 0]);
        assert!(
            told(&surface("0.1"), "surface")[0].starts_with("f:1: note: <mu2> of <ode> is '0.1' and is not")
        );
        assert_eq!(told("<link name='l'><enable_wind>False</enable_wind></link>", "link"), [""; 0]);
    }

    #[test]
    fn what_is_not_known_is_told_with_what_may_be_meant() {
        let told = |text: &str| told(text, "root").join("\n");
        assert_eq!(
            told("<sdf version='1.9'><model name='m'><link name='l'><inertail/></link></model></sdf>"),
            "f:1: warning: <inertail> of <link> is not known, and is left out; did you mean 'inertial'?"
        );
        assert!(told("<sdf version='1.9' vers='2'/>").contains("attribute 'vers' of <sdf> is not known"));
        // Elements with a prefix belong to other programs; plugins and cameras have their own parsers.
        let own = "<sdf version='1.9' xmlns:gz='x'><world name='w'><gz:policies><a/></gz:policies><plugin><any/></plugin>\
                   <model name='m'><link name='l'><sensor name='s' type='camera'><camera><x/></camera></sensor></link></model>\
                   </world></sdf>";
        assert_eq!(told(own), "");
    }

    #[test]
    fn each_row_is_well_formed_and_each_context_is_there() {
        fn check(row: &Row, at: &str) {
            let at = format!("{at}/{}", row.name);
            match &row.fate {
                Fate::Context(context) => assert!(CONTEXTS.contains_key(context), "{at}: {context}"),
                Fate::NotSimulated { difference, .. } => assert!(difference.len() > 5, "{at}"),
                Fate::Elsewhere { context, place } => {
                    assert!(CONTEXTS.contains_key(context) && place.len() > 5, "{at}: {context}");
                }
                Fate::Taken(context) => panic!("{at}: {context} comes later, or is not there"),
                Fate::Read | Fate::Passed => {}
            }
            let rows = &row.inside;
            for (place, inside) in rows.iter().enumerate() {
                assert!(
                    rows[..place].iter().all(|other| other.name != inside.name),
                    "{at}/{} twice",
                    inside.name
                );
                check(inside, &at);
            }
        }
        assert!(CONTEXTS.len() > 40);
        for (context, rows) in CONTEXTS.iter() {
            for row in rows {
                check(row, context);
            }
        }
    }

    /// A row that marks an element as read must name one that a parser requests.
    #[test]
    fn what_is_read_is_asked_for() {
        fn sources(folder: &Path, text: &mut String) {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    sources(&path, text);
                } else if path.extension().is_some_and(|end| end == "rs") && !path.ends_with("elements.rs") {
                    text.push_str(&std::fs::read_to_string(path).unwrap());
                }
            }
        }
        fn check(row: &Row, sources: &str, missing: &mut Vec<String>) {
            let name = row.name.trim_start_matches('.');
            let holds = |fate: fn(&Fate) -> bool| row.inside.iter().any(|row| fate(&row.fate));
            let is_read = |fate: &Fate| matches!(fate, Fate::Read | Fate::Context(_));
            // An element without read content need not be requested.
            let is_asked = matches!(row.fate, Fate::Read) && (row.inside.is_empty() || holds(is_read));
            if is_asked && !sources.contains(&format!("\"{name}\"")) {
                missing.push(name.to_owned());
            }
            for inside in &row.inside {
                check(inside, sources, missing);
            }
        }
        let mut text = String::new();
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut text);
        let mut missing = Vec::new();
        for row in CONTEXTS.values().flatten() {
            check(row, &text, &mut missing);
        }
        assert_eq!(missing, [""; 0]);
    }
}

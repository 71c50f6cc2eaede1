//! A page of a preset.

use super::plot::Plot;
use std::fmt::Write as _;
use std::{fs, path::Path};

/// The largest allowed difference between a measured and a published figure.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Bound {
    /// As a fraction of it.
    Share(f64),
    /// In its unit.
    By(f64),
}

/// A figure of the device.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub(crate) what: String,
    pub(crate) unit: &'static str,
    pub(crate) published: f64,
    pub(crate) measured: f64,
    pub(crate) bound: Bound,
}

impl Row {
    pub(crate) fn new(
        what: impl Into<String>,
        unit: &'static str,
        published: f64,
        measured: f64,
        bound: Bound,
    ) -> Self {
        Self { what: what.into(), unit, published, measured, bound }
    }

    fn holds(&self) -> bool {
        let off = (self.measured - self.published).abs();
        off <= match self.bound {
            Bound::Share(share) => share * self.published.abs(),
            Bound::By(most) => most,
        }
    }
}

/// A preset's page.
pub(crate) struct Page {
    /// The name of the preset.
    pub(crate) name: &'static str,
    /// The name of the device, and the sources of its figures.
    pub(crate) source: String,
    /// Further notes for the reader.
    pub(crate) notes: String,
    pub(crate) rows: Vec<Row>,
    pub(crate) plots: Vec<Plot>,
}

impl Page {
    /// The figures that exceed their bounds.
    pub(crate) fn missed(&self) -> impl Iterator<Item = String> {
        self.rows.iter().filter(|row| !row.holds()).map(|row| format!("{}: {row:?}", self.name))
    }

    pub(crate) fn plot_name(&self, number: usize) -> String {
        let more = if number == 0 { String::new() } else { format!("_{}", number + 1) };
        format!("{}{more}.svg", self.name)
    }

    pub(crate) fn markdown(&self) -> String {
        let Self { name, source, notes, rows, plots } = self;
        let mut text = format!("# `{name}`\n\n{source}.\n");
        if !notes.is_empty() {
            write!(text, "\n{notes}\n").unwrap();
        }
        for (number, plot) in plots.iter().enumerate() {
            write!(text, "\n![{}]({})\n", plot.title, self.plot_name(number)).unwrap();
        }
        text += "\n| what | published | measured | off | bound |\n|---|---:|---:|---:|---:|\n";
        for Row { what, unit, published, measured, bound } in rows {
            let of = |value: f64| format!("{} {unit}", digits(value)).trim_end().to_owned();
            let off = measured - published;
            let (off, bound) = match bound {
                Bound::Share(share) => {
                    (format!("{:+.2} %", 100.0 * off / published), format!("{} %", digits(100.0 * share)))
                }
                Bound::By(most) => (of(off), of(*most)),
            };
            let [published, measured] = [published, measured].map(|value| of(*value));
            writeln!(text, "| {what} | {published} | {measured} | {off} | {bound} |").unwrap();
        }
        text + "\nMade by `BELVEDERE_BLESS=1 cargo test -p belvedere-sensors --test reports`; without the variable the test \
                fails when a figure leaves its bound.\n"
    }
}

/// The text of the list of all pages.
pub(crate) fn index(groups: &[(&str, Vec<(&'static str, String)>)]) -> String {
    let mut text = "# Sensors that can be bought\n\nWhat each preset measures in Belvedere, beside what is published of its \
                    device. `<plugin filename=\"belvedere\"><preset>NAME</preset></plugin>` in a `<sensor>` chooses one: \
                    [lidars](../lidars.md), [depth cameras](../depth.md), [cameras](../cameras.md), [inertial units](../inertial.md).\n"
        .to_owned();
    for (group, pages) in groups {
        write!(text, "\n## {group}\n| preset | device |\n|---|---|\n").unwrap();
        for (name, device) in pages {
            writeln!(text, "| [`{name}`]({name}.md) | {device} |").unwrap();
        }
    }
    text
}

/// The book's table of contents, with a line for each page below that of the list.
pub(crate) fn summary(groups: &[(&str, Vec<(&'static str, String)>)]) -> String {
    const LIST: &str = "(sensors/README.md)";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/SUMMARY.md");
    let mut text = String::new();
    for line in fs::read_to_string(path)
        .unwrap()
        .lines()
        .filter(|line| !line.contains("](sensors/") || line.contains(LIST))
    {
        writeln!(text, "{line}").unwrap();
        if line.contains(LIST) {
            for (name, device) in groups.iter().flat_map(|(_, pages)| pages) {
                writeln!(text, "  - [{device}](sensors/{name}.md)").unwrap();
            }
        }
    }
    text
}

/// Checks that a file of `docs/sensors` is current, or writes it with `BELVEDERE_BLESS`.
pub(crate) fn check(file: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/sensors").join(file);
    if std::env::var_os("BELVEDERE_BLESS").is_some() {
        fs::write(&path, made).unwrap();
    }
    assert!(
        fs::read_to_string(&path).unwrap_or_default() == made,
        "docs/sensors/{file} is not current; run BELVEDERE_BLESS=1 cargo test -p belvedere-sensors --test reports"
    );
}

/// Formats a number with four significant digits.
pub(crate) fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e7).contains(&value.abs()) {
        let text = format!("{value:.3e}");
        let (number, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", number.trim_end_matches('0').trim_end_matches('.'));
    }
    let before = value.abs().log10().floor() as i32 + 1;
    let text = format!("{value:.*}", usize::try_from(4 - before).unwrap_or(0));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

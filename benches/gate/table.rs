//! Printed tables.

use super::figures::{Pooled, Unit};
use super::verdict::{Mark, Verdict};

/// Prints the head of a level's table.
pub fn head(level: &str) {
    println!(
        "\n{:<30} {:>14} {:>14}  {:<20} {:>8} {:>6} {:>15}  verdict",
        level, "belvedere", "other", "the other is", "ratio", "±", "held to"
    );
}

/// Prints the head of the table of gains.
pub fn head_of_gains() {
    println!("\n{:<30} {:>61} {:>6} {:>15}  verdict", "avx512 beside avx2", "gain", "", "held to");
}

/// Prints an entry.
pub fn row(name: &str, pooled: &Pooled, mark: Option<Mark>, verdict: Verdict) {
    let figures = &pooled.figures;
    println!(
        "{name:<30} {:>14} {:>14}  {:<20} {:>7.2}× {:>4.0} % {:>15}  {verdict}",
        show(figures.unit, figures.ours_s),
        show(figures.unit, figures.theirs_s),
        figures.peer,
        figures.ratio,
        50.0 * pooled.spread(),
        held_to(mark),
    );
}

/// Prints how many times as fast a group is at one level as at another.
pub fn gain(name: &str, ratio: f64, mark: Option<Mark>, verdict: Verdict) {
    println!("{name:<30} {:>60.2}× {:>6} {:>15}  {verdict}", ratio, "", held_to(mark));
}

/// Prints an entry that could not be measured.
pub fn left_out(name: &str, why: &str) {
    println!("{name:<30} not measured: {why}");
}

fn held_to(mark: Option<Mark>) -> String {
    mark.map_or("–".into(), |mark| mark.to_string())
}

fn show(unit: Unit, seconds: f64) -> String {
    match unit {
        Unit::Rate => format!("{:.2} Mray/s", 1e-6 / seconds),
        Unit::Time => format!("{:.3} ms", 1e3 * seconds),
    }
}

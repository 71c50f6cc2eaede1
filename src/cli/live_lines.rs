//! Lines at the bottom of a terminal that are updated in place, by writing only what has changed.

use std::fmt::Write as _;

/// The lines at the bottom of a terminal, just above the cursor.
pub(super) struct LiveLines {
    lines: Vec<String>,
    /// Columns of the terminal when the lines were written.
    columns: usize,
}

impl LiveLines {
    /// Creates an empty set of lines.
    pub(super) const fn new() -> Self {
        Self { lines: Vec::new(), columns: 0 }
    }

    /// Returns true if there are any lines.
    pub(super) fn is_shown(&self) -> bool {
        !self.lines.is_empty()
    }

    /// Replaces the lines and returns the text that has to be written to a terminal of this width. Each line must be
    /// shorter than the terminal is wide, and there must be fewer lines than the terminal has rows.
    pub(super) fn draw(&mut self, lines: Vec<String>, columns: usize) -> String {
        if lines.len() == self.lines.len() && columns == self.columns {
            let codes = self.changes(&lines);
            self.lines = lines;
            return codes;
        }
        let mut codes = self.clear(columns);
        for line in &lines {
            codes.extend([line, "\n"]);
        }
        *self = Self { lines, columns };
        codes
    }

    /// Removes the lines and returns the text that has to be written to a terminal of this width. If the terminal has
    /// become narrower, each line may now fill several rows.
    pub(super) fn clear(&mut self, columns: usize) -> String {
        let rows = |line: &String| line.chars().count().div_ceil(columns.max(1)).max(1);
        let mut codes = String::new();
        if !self.lines.is_empty() {
            up(self.lines.iter().map(rows).sum(), &mut codes);
            codes.push_str("\x1b[J");
        }
        self.lines.clear();
        codes
    }

    /// Returns the text that has to be written to put `text` above the lines.
    pub(super) fn write_above(&mut self, text: &str, columns: usize) -> String {
        let lines = self.lines.clone();
        [&self.clear(columns), text, &self.draw(lines, columns)].concat()
    }

    /// Returns the text that updates the lines if their number stays the same.
    fn changes(&self, lines: &[String]) -> String {
        let mut codes = String::new();
        let mut row = self.lines.len();
        for (changed, (old, new)) in self.lines.iter().zip(lines).enumerate() {
            if old != new {
                up(row.saturating_sub(changed), &mut codes);
                down(changed.saturating_sub(row), &mut codes);
                row = changed;
                rewrite(old, new, &mut codes);
            }
        }
        down(self.lines.len() - row, &mut codes);
        codes
    }
}

/// Moves the cursor up, to the first column.
fn up(rows: usize, codes: &mut String) {
    if rows > 0 {
        // Writing to a string cannot fail, here and below.
        let _ = write!(codes, "\r\x1b[{rows}A");
    }
}

/// Moves the cursor down, to the first column.
fn down(rows: usize, codes: &mut String) {
    if rows > 0 {
        let _ = write!(codes, "\r\x1b[{rows}B");
    }
}

/// Writes the part of a line that differs from the line that it replaces.
fn rewrite(old: &str, new: &str, codes: &mut String) {
    let (old, new): (Vec<char>, Vec<char>) = (old.chars().collect(), new.chars().collect());
    let same = |(one, other): &(&char, &char)| one == other;
    let first = old.iter().zip(&new).take_while(same).count();
    let is_as_long = old.len() == new.len();
    let kept = old.iter().rev().zip(new.iter().rev()).take_while(same).count();
    let kept = if is_as_long { kept } else { 0 };
    let end = new.len().saturating_sub(kept).max(first);
    let _ = write!(codes, "\x1b[{}G", first + 1);
    codes.extend(&new[first..end]);
    if new.len() < old.len() {
        codes.push_str("\x1b[K");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(lines: &[&str]) -> Vec<String> {
        lines.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn only_what_has_changed_is_written() {
        let mut live = LiveLines::new();
        assert_eq!(live.draw(lines(&["one 1.00", "two 2.00", "end"]), 80), "one 1.00\ntwo 2.00\nend\n");
        assert_eq!(live.draw(lines(&["one 1.00", "two 2.00", "end"]), 80), "");
        let codes = live.draw(lines(&["one 1.00", "two 2.34", "the end"]), 80);
        assert_eq!(codes, "\r\x1b[2A\x1b[7G34\r\x1b[1B\x1b[1Gthe end\r\x1b[1B");
        let codes = live.draw(lines(&["one 1", "two 2.34", "the end"]), 80);
        assert_eq!(codes, "\r\x1b[3A\x1b[6G\x1b[K\r\x1b[3B");
        // If the number of lines changes, all are written.
        assert_eq!(live.draw(lines(&["one 1"]), 80), "\r\x1b[3A\x1b[Jone 1\n");
        assert_eq!(live.write_above("log\n", 80), "\r\x1b[1A\x1b[Jlog\none 1\n");
    }

    #[test]
    fn lines_wrapped_by_a_narrower_terminal_are_removed() {
        let mut live = LiveLines::new();
        live.draw(lines(&["0123456789", "", "01234"]), 20);
        assert_eq!(live.draw(lines(&["0123", "", "01"]), 5), "\r\x1b[4A\x1b[J0123\n\n01\n");
        assert_eq!(live.clear(5), "\r\x1b[3A\x1b[J");
        assert_eq!(live.clear(5), "");
    }
}

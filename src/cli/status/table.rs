//! The table of streams, fitted to the size of the terminal.

use crate::description::text::count;
use std::fmt::Write as _;

/// The line of a stream.
pub(super) struct Row {
    pub(super) topic: String,
    pub(super) cells: [String; HEADINGS.len()],
    /// True if the stream has no subscribers and sends nothing. Idle streams are omitted first.
    pub(super) is_idle: bool,
}

/// Headings and widths of the cells. In a narrow terminal the last ones are omitted first. Rates are in simulated time.
const HEADINGS: [(&str, usize); 5] =
    [("RATE Hz", 8), ("ASKED Hz", 8), ("SUBS", 4), ("DROPPED", 7), ("FRAME ms", 8)];

/// Shortest width of the topic column, before cells are omitted in favour of it.
const SHORTEST_TOPIC: usize = 16;

/// Returns the lines of the table for a terminal of this size, with the cursor below them.
pub(super) fn table(rows: &[Row], total: &str, columns: usize, height: usize) -> Vec<String> {
    // A line of full width would leave the cursor at its end instead of below it.
    let width = columns.saturating_sub(1);
    let shown = fitting(rows, height);
    let taken = |cells: usize| HEADINGS[..cells].iter().map(|(_, width)| width + 1).sum::<usize>();
    let cells = (0..=HEADINGS.len()).rev().find(|cells| width >= SHORTEST_TOPIC + taken(*cells)).unwrap_or(0);
    let longest = shown.iter().map(|row| row.topic.chars().count()).max().unwrap_or(0).max("TOPIC".len());
    let topic_width = longest.min(width.saturating_sub(taken(cells)));
    let line = |topic: &str, values: &mut dyn Iterator<Item = &str>| {
        let mut line = format!("{:topic_width$}", shortened(topic, topic_width));
        for (value, (_, width)) in values.zip(&HEADINGS[..cells]) {
            // Writing to a string cannot fail.
            let _ = write!(line, " {value:>width$}");
        }
        line
    };
    let mut lines = vec![line("TOPIC", &mut HEADINGS.iter().map(|(heading, _)| *heading))];
    lines.extend(shown.iter().map(|row| line(&row.topic, &mut row.cells.iter().map(String::as_str))));
    let left_out = rows.len() - shown.len();
    if left_out > 0 {
        lines.push(cut(&format!("… {}: belvedere list", count(left_out as u64, "more stream")), width));
    }
    lines.push(cut(total, width));
    lines
}

/// Returns the rows that fit, in their order; idle ones are omitted first.
fn fitting(rows: &[Row], height: usize) -> Vec<&Row> {
    // Lines for the heading, the total and the cursor. If rows are omitted, a line reports how many.
    let room = height.saturating_sub(3);
    if rows.len() <= room {
        return rows.iter().collect();
    }
    let mut places: Vec<usize> = (0..rows.len()).collect();
    places.sort_by_key(|&place| rows[place].is_idle);
    places.truncate(room.saturating_sub(1));
    places.sort_unstable();
    places.into_iter().map(|place| &rows[place]).collect()
}

/// Shortens a topic in the middle, because its namespace and its last words distinguish streams.
fn shortened(topic: &str, width: usize) -> String {
    let length = topic.chars().count();
    if length <= width {
        return topic.to_owned();
    }
    let left = width.saturating_sub(1);
    let begin = left / 3;
    let end = topic.chars().skip(length - (left - begin));
    topic.chars().take(begin).chain(['…']).chain(end).take(width).collect()
}

/// Cuts a line off at this width.
fn cut(line: &str, width: usize) -> String {
    line.chars().take(width).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(topics: &[&str]) -> Vec<Row> {
        let row = |(place, topic): (usize, &&str)| Row {
            topic: (*topic).to_owned(),
            cells: ["30.00", "30.00", "1", "0", "1.23"].map(str::to_owned),
            is_idle: place % 2 == 1,
        };
        topics.iter().enumerate().map(row).collect()
    }

    #[test]
    fn lines_are_as_wide_as_they_need_to_be_and_fit() {
        let rows =
            rows(&["/scan", "/mobile_base/sensors/imu_data", "/robot_1/camera/depth/image_raw/truth/class"]);
        let total = "12.3 s simulated, real-time factor 0.998, 123456 frames, 0 dropped";
        let wide = table(&rows, total, usize::MAX, usize::MAX);
        assert_eq!(
            wide[0].trim_start_matches("TOPIC").trim_start(),
            "RATE Hz ASKED Hz SUBS DROPPED FRAME ms"
        );
        assert!(wide[3].starts_with("/robot_1/camera/depth/image_raw/truth/class    30.00 "), "{wide:?}");
        for columns in [1, 5, 20, 40, 70, 80, 200] {
            let lines = table(&rows, total, columns, 24);
            assert!(lines.iter().all(|line| line.chars().count() < columns), "{columns}: {lines:#?}");
            assert_eq!(lines.len(), 5);
        }
        let narrow = table(&rows, total, 70, 24);
        assert!(narrow[2].starts_with("/mobile_base/sensors/imu_data "), "{narrow:#?}");
        assert!(narrow[3].starts_with("/robot_1/…age_raw/truth/class "), "{narrow:#?}");
        assert!(narrow[3].ends_with("1.23"), "{narrow:#?}");
        assert!(table(&rows, total, 40, 24)[0].ends_with("SUBS"));
    }

    #[test]
    fn streams_that_do_not_fit_are_counted_and_idle_ones_are_omitted_first() {
        let rows = rows(&["/a", "/b", "/c", "/d", "/e", "/f"]);
        let topics = |height| {
            let lines = table(&rows, "total", 80, height);
            assert!(lines.len() < height || height < 4, "{lines:#?}");
            let topic = |line: String| line.split(' ').next().unwrap_or_default().to_owned();
            (lines[lines.len() - 2].clone(), lines.into_iter().map(topic).collect::<Vec<_>>().join(" "))
        };
        assert_eq!(topics(9).1, "TOPIC /a /b /c /d /e /f total");
        assert_eq!(
            topics(8),
            ("… 2 more streams: belvedere list".into(), "TOPIC /a /b /c /e … total".into())
        );
        assert_eq!(topics(6).1, "TOPIC /a /c … total");
        assert_eq!(topics(1).1, "TOPIC … total");
    }
}

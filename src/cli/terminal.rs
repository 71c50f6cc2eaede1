//! Shows pictures in a terminal, for example over ssh, with two pixels per character (half blocks).

use super::error::CliError;
use super::follow::{check_topics, first_of_kinds, stop_wanted, with_slash};
use crate::picture;
use belvedere_bridge::{Kind, Node};
use image::{Rgb, RgbImage, imageops};
use std::fmt::Write as _;
use std::io::{self, IsTerminal as _, Write as _};
use std::time::{Duration, Instant};

/// Time between two pictures, because a terminal over ssh cannot show more.
const PERIOD: Duration = Duration::from_millis(66);
/// Size assumed if the terminal does not report one.
const COLUMNS_AND_ROWS: (u32, u32) = (80, 24);

/// Shows the frames of a topic until the user stops it or the count is reached. If `topic` is empty, shows the first
/// camera or lidar.
pub(super) fn show(node: &Node, topic: &str, count: Option<u64>) -> Result<(), CliError> {
    let topic = if topic.is_empty() {
        let found =
            first_of_kinds(node, &[Kind::Image, Kind::DepthImage, Kind::LaserScan, Kind::PointCloud])?;
        found.ok_or_else(|| CliError::NoSimulator(node.domain().clone()))?
    } else {
        check_topics(node, node.domain(), &[topic.to_owned()])?;
        with_slash(topic)
    };
    let mut subscriber = node.subscriber(&topic)?;
    let screen = Screen::open()?;
    let mut shown = 0;
    let mut text = String::new();
    while !stop_wanted() && count.is_none_or(|count| shown < count) {
        if !subscriber.wait(Duration::from_millis(100))? {
            continue;
        }
        let began = Instant::now();
        let Some(frame) = subscriber.take_newest()? else { continue };
        let picture = picture::draw(&frame.view())
            .map_err(|source| CliError::Picture { topic: topic.clone(), source })?;
        let seconds = frame.header().stamp_ns as f64 * 1e-9;
        drop(frame);
        let (columns, rows) = size();
        // One character row is kept for the text below the picture.
        screen.begin(&mut text);
        half_blocks(&fitted(&picture, columns, 2 * rows.saturating_sub(2)), has_all_colours(), &mut text);
        let _ = write!(text, "{topic}  {seconds:.2} s  press Ctrl-C to stop");
        screen.end(&mut text);
        let mut out = io::stdout().lock();
        out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)?;
        shown += 1;
        std::thread::sleep(PERIOD.saturating_sub(began.elapsed()));
    }
    Ok(())
}

/// Returns columns and rows of the terminal.
fn size() -> (u32, u32) {
    terminal_size::terminal_size()
        .map_or(COLUMNS_AND_ROWS, |(columns, rows)| (u32::from(columns.0), u32::from(rows.0)))
}

/// Returns true if the terminal supports 24-bit colours; others have 256 colours.
fn has_all_colours() -> bool {
    std::env::var("COLORTERM").is_ok_and(|name| name == "truecolor" || name == "24bit")
}

/// Shrinks a picture to the available pixels.
fn fitted(picture: &RgbImage, width: u32, height: u32) -> RgbImage {
    let scale = (f64::from(width) / f64::from(picture.width()))
        .min(f64::from(height) / f64::from(picture.height()))
        .min(1.0);
    let scaled = |length: u32| ((f64::from(length) * scale).round() as u32).max(1);
    imageops::thumbnail(picture, scaled(picture.width()), scaled(picture.height()))
}

/// Writes one line for two rows of pixels: the upper pixel is the foreground colour of a character, the lower one its
/// background.
fn half_blocks(picture: &RgbImage, all_colours: bool, text: &mut String) {
    for row in (0..picture.height()).step_by(2) {
        let mut before = None;
        for column in 0..picture.width() {
            let upper = *picture.get_pixel(column, row);
            let lower = picture.get_pixel_checked(column, row + 1).copied().unwrap_or(Rgb([0; 3]));
            if before != Some((upper, lower)) {
                before = Some((upper, lower));
                let (upper, lower) = (colour(upper, all_colours), colour(lower, all_colours));
                let _ = write!(text, "\x1b[38;{upper};48;{lower}m");
            }
            text.push('▀');
        }
        text.push_str("\x1b[0m\r\n");
    }
}

/// Returns a terminal's colour code: 24-bit, or the nearest in the 6 × 6 × 6 cube.
fn colour(Rgb([red, green, blue]): Rgb<u8>, all_colours: bool) -> String {
    if all_colours {
        return format!("2;{red};{green};{blue}");
    }
    let step = |value: u8| (u32::from(value) * 5 + 127) / 255;
    format!("5;{}", 16 + 36 * step(red) + 6 * step(green) + step(blue))
}

/// The alternate screen of the terminal, which is left on drop. If the output is not a terminal, pictures are written
/// one below the other.
struct Screen {
    is_terminal: bool,
}

impl Screen {
    fn open() -> Result<Self, CliError> {
        let screen = Self { is_terminal: io::stdout().is_terminal() };
        // Switch to the alternate screen, hide the cursor and clear the screen.
        screen.say("\x1b[?1049h\x1b[?25l\x1b[2J")?;
        Ok(screen)
    }

    fn say(&self, codes: &str) -> Result<(), CliError> {
        if !self.is_terminal {
            return Ok(());
        }
        let mut out = io::stdout().lock();
        out.write_all(codes.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)
    }

    fn begin(&self, text: &mut String) {
        text.clear();
        if self.is_terminal {
            text.push_str("\x1b[H");
        }
    }

    fn end(&self, text: &mut String) {
        // Erase the rest of a larger picture.
        text.push_str(if self.is_terminal { "\x1b[J" } else { "\n" });
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // The terminal may be closed already.
        let _ = self.say("\x1b[?25h\x1b[?1049l");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_character_has_two_pixels() {
        let mut picture = RgbImage::new(2, 3);
        picture.put_pixel(0, 0, Rgb([255, 0, 0]));
        picture.put_pixel(0, 1, Rgb([0, 0, 255]));
        picture.put_pixel(1, 2, Rgb([0, 255, 0]));
        let mut text = String::new();
        half_blocks(&picture, true, &mut text);
        let lines: Vec<&str> = text.split("\r\n").collect();
        assert_eq!(lines[0], "\x1b[38;2;255;0;0;48;2;0;0;255m▀\x1b[38;2;0;0;0;48;2;0;0;0m▀\x1b[0m");
        assert_eq!(lines[1], "\x1b[38;2;0;0;0;48;2;0;0;0m▀\x1b[38;2;0;255;0;48;2;0;0;0m▀\x1b[0m");
        assert_eq!(colour(Rgb([255, 255, 255]), false), "5;231");
    }

    #[test]
    fn pictures_keep_their_shape_and_are_not_enlarged() {
        let size = |width, height| fitted(&RgbImage::new(640, 480), width, height).dimensions();
        assert_eq!((size(80, 44), size(64, 1000), size(2000, 2000)), ((59, 44), (64, 48), (640, 480)));
    }
}

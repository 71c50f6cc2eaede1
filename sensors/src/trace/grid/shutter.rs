//! Checks of a shutter: each line needs a moment, and each block must be in a single slice.

use crate::moment::{Shutter, Slice};
use crate::optics::Optics;
use crate::optics::rays::RayGrid;
use crate::scene::Scene;
use crate::trace::error::SenseError;
use crate::trace::placed::view::check_moment;

/// The grid of blocks in which a frame is traced, chosen so that each block is in a single slice.
pub(super) fn ray_grid_of(optics: &Optics<'_>, shutter: &Shutter<'_>) -> Result<RayGrid, SenseError> {
    let ray_grid = optics.ray_grid();
    let height = ray_grid.height as u32;
    let mask = (1 << ray_grid.shift_y) - 1;
    let cuts = |line: u32| line & mask != 0 && line != height;
    match shutter.slices().iter().position(|slice| cuts(slice.lines.start) || cuts(slice.lines.end)) {
        None => Ok(ray_grid),
        Some(slice) if matches!(optics, Optics::Table(_)) => Err(SenseError::Slices {
            slice,
            rule: "begin and end at multiples of four lines, as the table of rays is in blocks of 4 × 4",
        }),
        Some(_) => Ok(ray_grid.by_rows()),
    }
}

/// Checks that each of `height` lines has a moment, with all poses.
pub(crate) fn check_shutter(scene: &Scene<'_>, shutter: &Shutter<'_>, height: u32) -> Result<(), SenseError> {
    let slices = match shutter {
        Shutter::Global(moment) => return check_moment(scene, moment),
        Shutter::Slices(slices) => *slices,
        Shutter::Moving(_) => {
            return Err(SenseError::Shutter {
                rule: "be one moment or slices: this sensor's rays have no individual times",
            });
        }
    };
    let (mut start, mut end) = (0, 0);
    for (slice, Slice { lines, at }) in slices.iter().enumerate() {
        let wrong = |rule| Err(SenseError::Slices { slice, rule });
        if lines.start >= lines.end || lines.end > height {
            return wrong("have at least one line, and none beyond the frame's last line");
        }
        if lines.start < start || lines.end < end {
            return wrong("neither begin nor end before the slice before it");
        }
        if lines.start > end {
            return wrong("begin no later than where the lines before it end");
        }
        check_moment(scene, at)?;
        (start, end) = (lines.start, lines.end);
    }
    if end < height {
        return Err(SenseError::Slices {
            slice: slices.len(),
            rule: "exist: no slice contains the last lines",
        });
    }
    Ok(())
}

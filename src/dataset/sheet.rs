//! The contact sheet: a picture of some samples of a data set, one per row.

use super::folder::CONTACT_SHEET;
use super::shard::{read_shard, write_whole};
use super::{DatasetError, Folder, Plan};
use crate::colours::of_nearness;
use image::imageops::{self, FilterType};
use image::{ImageFormat, Rgb, RgbImage};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Most samples.
const ROWS: u64 = 8;
/// Most files of a sample.
const COLUMNS: usize = 8;
/// Width of an image in pixels.
const WIDTH: u32 = 200;
/// Gap between two images in pixels.
const GAP: u32 = 4;

/// Draws samples that are spread evenly over a data set into `contact_sheet.png`: images, depths from near (red) to far
/// (blue), instances and classes in colours. Returns its path, or `None` if no file of a sample can be drawn, as with
/// scans and clouds.
///
/// # Errors
/// If a shard cannot be read, or the file cannot be written.
pub fn contact_sheet(plan: &Plan, folder: &Folder) -> Result<Option<PathBuf>, DatasetError> {
    let rows = plan.samples().min(ROWS);
    let chosen: BTreeSet<u64> = (0..rows).map(|row| row * plan.samples() / rows).collect();
    let shards: BTreeSet<u64> = chosen.iter().map(|sample| plan.shard_of(*sample)).collect();
    let mut lines: Vec<Vec<RgbImage>> = Vec::new();
    for shard in shards {
        read_shard(&folder.shard(shard), |index, files| {
            if chosen.contains(&index) {
                lines.push(looks(&files));
            }
            Ok(())
        })?;
    }
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0) as u32;
    if columns == 0 {
        return Ok(None);
    }
    let heights: Vec<u32> =
        lines.iter().map(|line| line.iter().map(RgbImage::height).max().unwrap_or(0)).collect();
    let height = heights.iter().map(|height| height + GAP).sum::<u32>() + GAP;
    let mut sheet = RgbImage::from_pixel(columns * (WIDTH + GAP) + GAP, height, Rgb([255; 3]));
    let mut top = GAP;
    for (line, height) in lines.iter().zip(heights) {
        for (column, picture) in line.iter().enumerate() {
            let left = GAP + column as u32 * (WIDTH + GAP);
            imageops::replace(&mut sheet, picture, i64::from(left), i64::from(top));
        }
        top += height + GAP;
    }
    let path = folder.path().join(CONTACT_SHEET);
    let mut bytes = Cursor::new(Vec::new());
    sheet
        .write_to(&mut bytes, ImageFormat::Png)
        .map_err(|error| failed(&path, std::io::Error::other(error)))?;
    write_whole(&path, &bytes.into_inner())?;
    Ok(Some(path))
}

fn failed(path: &Path, source: std::io::Error) -> DatasetError {
    DatasetError::Output { path: path.to_owned(), source }
}

/// Draws the files of a sample that can be drawn, each as wide as a column.
fn looks(files: &BTreeMap<String, Vec<u8>>) -> Vec<RgbImage> {
    let looks = files.iter().filter_map(|(name, bytes)| {
        let picture = if name.split('.').next_back() == Some("png") {
            image::load_from_memory(bytes).ok()?.to_rgb8()
        } else {
            array(bytes)?
        };
        let height =
            (u64::from(picture.height()) * u64::from(WIDTH) / u64::from(picture.width().max(1))) as u32;
        Some(imageops::resize(&picture, WIDTH, height.max(1), FilterType::Nearest))
    });
    looks.take(COLUMNS).collect()
}

/// Draws an npy file with one number per pixel.
fn array(npy: &[u8]) -> Option<RgbImage> {
    let length = usize::from(u16::from_le_bytes([*npy.get(8)?, *npy.get(9)?]));
    let header = std::str::from_utf8(npy.get(10..10 + length)?).ok()?;
    let bytes = npy.get(10 + length..)?;
    let descr = header.strip_prefix("{'descr': '")?.split('\'').next()?;
    let shape = header.split_once('(')?.1.split_once(')')?.0;
    let axes: Vec<u32> = shape.split(',').filter_map(|axis| axis.trim().parse().ok()).collect();
    let [height, width] = axes[..] else { return None };
    // A single line is a scan.
    let count = (height > 1).then_some(height as usize * width as usize)?;
    let colours: Vec<[u8; 3]> = match descr {
        "<f4" => distances(bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes))),
        "<u2" => {
            distances(bytes.as_chunks::<2>().0.iter().map(|bytes| f32::from(u16::from_le_bytes(*bytes))))
        }
        "<i4" => bytes.as_chunks::<4>().0.iter().map(|bytes| hue(i32::from_le_bytes(*bytes))).collect(),
        _ => return None,
    };
    let pixels = colours.get(..count)?.as_flattened().to_vec();
    RgbImage::from_raw(width, height, pixels)
}

/// Converts distances to colours from near to far; black for no value.
fn distances(numbers: impl Iterator<Item = f32> + Clone) -> Vec<[u8; 3]> {
    let there = numbers.clone().filter(|number| number.is_finite() && *number > 0.0);
    let (near, far) = there.fold((f32::INFINITY, 0.0_f32), |(near, far), at| (near.min(at), far.max(at)));
    // The inverse of the distance keeps near objects distinguishable if there is a far horizon.
    let share = |at: f32| (1.0 / at - 1.0 / far) / (1.0 / near - 1.0 / far).max(f32::MIN_POSITIVE);
    let is_there = |at: f32| at.is_finite() && at > 0.0;
    numbers.map(|at| if is_there(at) { of_nearness(f64::from(share(at))) } else { [0; 3] }).collect()
}

/// Returns the colour of a number: black for negative ones, very different for consecutive ones.
fn hue(number: i32) -> [u8; 3] {
    if number < 0 {
        return [0; 3];
    }
    // Steps of the golden ratio go round the circle of hues without coming close to earlier hues.
    let turn = (f64::from(number) * 0.618_033_988_749_895).fract() as f32;
    [0.0, 2.0 / 3.0, 1.0 / 3.0].map(|offset| {
        let distance = ((turn + offset).fract() * 6.0 - 3.0).abs() - 1.0;
        (distance.clamp(0.0, 1.0) * 255.0) as u8
    })
}

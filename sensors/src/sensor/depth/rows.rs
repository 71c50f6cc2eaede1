//! Where the parts of a depth frame go, cut between rows of tiles.

use super::contrast::Brightness;
use super::seen::Seen;
use super::{DepthCamera, POINT_STEP};
use crate::device::TileView;
use crate::execution::{SplitRows, split_at};
use crate::scene::ColourSpace;
use crate::sensor::camera::Camera;
use crate::sensor::camera::brush::ColourRows;
use crate::sensor::edges::{Canvas, TILE_HEIGHT, TILE_WIDTH};
use crate::sensor::pixel::{self, to_byte};
use crate::shade::Colours;
use crate::simd::{LANES, Lanes, WIDTH};
use crate::trace::Truth;
use crate::trace::grid::Band;
use crate::trace::place::Place;
use crate::trace::tiling::{BLOCKS, Tiling};
use fearless_simd::{Simd, f32x16};
use glam::DVec3;

/// From where on a point has its colour.
const POINT_RGB: usize = 16;

/// The colour of a point.
#[inline(always)]
fn rgb(colour: [f32; 3]) -> [u8; 4] {
    let [red, green, blue] = colour.map(to_byte);
    [blue, green, red, 0]
}

/// Writes a whole point.
#[inline(always)]
fn write_point(point: &mut [u8], ray: DVec3, depth: f32, colour: [f32; 3]) {
    let [x, y, z] = xyz(ray, depth);
    let words = [x, y, z, 0, u32::from_le_bytes(rgb(colour)), 0, 0, 0];
    for (bytes, word) in point.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *bytes = word.to_le_bytes();
    }
}

/// Writes the coordinates of a point, and nothing else.
#[inline(always)]
pub(super) fn write_xyz(point: &mut [u8], ray: DVec3, depth: f32) {
    for (bytes, word) in point.as_chunks_mut::<4>().0.iter_mut().zip(xyz(ray, depth)) {
        *bytes = word.to_le_bytes();
    }
}

/// The bits of a point's coordinates, from its ray in the axes of the sensor; NaN where there is no depth.
#[inline(always)]
fn xyz(ray: DVec3, depth: f32) -> [u32; 3] {
    let [right, down] = [((0.0 - ray.y) / ray.x) as f32, ((0.0 - ray.z) / ray.x) as f32];
    let xyz = if depth.is_finite() { [right * depth, down * depth, depth] } else { [f32::NAN; 3] };
    xyz.map(f32::to_bits)
}

/// Depths in millimetres; 0 where there is none that 16 bits hold.
#[inline(always)]
pub(super) fn millimetres(depths: &[f32; WIDTH]) -> [u16; WIDTH] {
    let mut pixels = [0; WIDTH];
    for lane in 0..WIDTH {
        let millimetres = depths[lane] * 1000.0 + 0.5;
        pixels[lane] = if (1.0..65536.0).contains(&millimetres) { millimetres as u16 } else { 0 };
    }
    pixels
}

/// The parts of a frame, cut between rows of tiles.
pub(super) struct Rows<'a> {
    pub(super) depth_32fc1: Option<&'a mut [f32]>,
    pub(super) depth_16uc1: Option<&'a mut [u16]>,
    pub(super) points: Option<&'a mut [u8]>,
    /// What the device is to read; without one, depths are measured as they are traced.
    pub(super) seen: Option<Seen<'a>>,
    /// What it finds pixels by.
    pub(super) brightness: Option<Brightness<'a>>,
    pub(super) truth: Option<Truth<'a>>,
    /// Pixels across.
    pub(super) width: usize,
    /// Rows of a tile.
    pub(super) lines_in_tile: usize,
    pub(super) wants_colour: bool,
    pub(super) colour: ColourRows<'a>,
}

impl SplitRows for Rows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { width, lines_in_tile, wants_colour, .. } = self;
        let pixels = rows * lines_in_tile * width;
        let (depth_32fc1, lower_32fc1) = split_at(self.depth_32fc1, pixels);
        let (depth_16uc1, lower_16uc1) = split_at(self.depth_16uc1, pixels);
        let (points, lower_points) = split_at(self.points, pixels * POINT_STEP);
        let (seen, lower_seen) = self.seen.map(|seen| seen.split_at(pixels)).unzip();
        let (brightness, lower_brightness) = split_at(self.brightness.map(|Brightness(all)| all), pixels);
        let [brightness, lower_brightness] = [brightness, lower_brightness].map(|all| all.map(Brightness));
        let (truth, lower_truth) = self.truth.map(|truth| truth.split_at(pixels)).unzip();
        let (colour, lower_colour) = self.colour.split_rows(rows);
        (
            Self {
                depth_32fc1,
                depth_16uc1,
                points,
                seen,
                brightness,
                truth,
                width,
                lines_in_tile,
                wants_colour,
                colour,
            },
            Self {
                depth_32fc1: lower_32fc1,
                depth_16uc1: lower_16uc1,
                points: lower_points,
                seen: lower_seen,
                brightness: lower_brightness,
                truth: lower_truth,
                width,
                lines_in_tile,
                wants_colour,
                colour: lower_colour,
            },
        )
    }
}

impl Rows<'_> {
    /// The lines of a tile that lie in the picture: number, first pixel in the output, and how many pixels there are.
    #[inline(always)]
    fn lines_of(
        &self,
        band: &Band<'_>,
        [column, row]: [usize; 2],
    ) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let tiling = Tiling::of(band.rays.fan());
        let ([across, down], width) = (tiling.size(), self.width);
        let [first_row, last_row] = [band.first_row, band.rows[1]].map(|row| row as usize);
        (0..BLOCKS).filter_map(move |line| {
            let [x, y] = tiling.line(line);
            let (x, y) = (column * across + x, row * down + y);
            (x < width && y <= last_row).then(|| (line, (y - first_row) * width + x, WIDTH.min(width - x)))
        })
    }

    /// Writes the depths of a block.
    #[inline(always)]
    pub(super) fn write_depths<S: Simd>(
        &mut self,
        simd: S,
        camera: &DepthCamera<'_>,
        depths: f32x16<S>,
        place: &Place,
    ) {
        if let Some(output) = &mut self.depth_32fc1 {
            place.write_f32(simd, camera.shown(simd, depths), output);
        }
        if let Some(output) = &mut self.depth_16uc1 {
            place.write(&millimetres(&depths.into()), output);
        }
    }

    /// Writes how bright a tile is, if that counts.
    #[inline(always)]
    pub(super) fn write_brightness(&mut self, colours: &Colours, band: &Band<'_>, tile: [usize; 2]) {
        let lines = self.lines_of(band, tile);
        let Some(brightness) = &mut self.brightness else { return };
        for (line, first, count) in lines {
            brightness.write(colours, line * WIDTH, (first, count));
        }
    }

    #[inline(always)]
    pub(super) fn write_points(
        &mut self,
        depths: &Lanes<f32>,
        colours: &Colours,
        band: &Band<'_>,
        tile: [usize; 2],
    ) {
        let lines = self.lines_of(band, tile);
        let Some(points) = &mut self.points else { return };
        for (line, first, count) in lines {
            let (column, row) = (first % self.width, first / self.width + band.first_row as usize);
            let output = points[first * POINT_STEP..][..count * POINT_STEP].chunks_exact_mut(POINT_STEP);
            for (x, point) in output.enumerate() {
                let lane = line * WIDTH + x;
                let ray = band.rays.direction((column + x) as i32, row as i32);
                write_point(point, ray, depths[lane], [0, 1, 2].map(|channel| colours[channel][lane]));
            }
        }
    }
}

/// A frame whose edges are painted over, from some row of tiles on.
pub(super) struct Retouched<'a> {
    pub(super) camera: &'a Camera<'a>,
    pub(super) frame: u64,
    pub(super) space: ColourSpace,
    pub(super) colour: Option<&'a mut [u8]>,
    pub(super) points: Option<&'a mut [u8]>,
}

impl SplitRows for Retouched<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { camera, frame, space, .. } = self;
        let rows = rows * TILE_HEIGHT;
        let (colour, colour_below) = split_at(self.colour, rows * camera.row_stride());
        let (points, points_below) = split_at(self.points, rows * camera.size()[0] * POINT_STEP);
        (
            Self { camera, frame, space, colour, points },
            Self { camera, frame, space, colour: colour_below, points: points_below },
        )
    }
}

impl Canvas for Retouched<'_> {
    #[inline(always)]
    fn paint<S: Simd>(
        &mut self,
        simd: S,
        view: &TileView<'_>,
        [column, row]: [usize; 2],
        lanes: u64,
        colours: &mut Colours,
    ) {
        let Self { camera, frame, space, .. } = self;
        camera.expose(simd, (*frame, *space), view, 0, colours);
        let first = row * TILE_HEIGHT;
        if let Some(colour) = &mut self.colour {
            let (format, stride) = ((camera.config().format, camera.full_scale()), camera.row_stride());
            pixel::write_lanes(simd, (colours, lanes), format, column, &mut colour[first * stride..], stride);
        }
        let Some(points) = &mut self.points else { return };
        let mut rest = lanes;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let [x, y] = [column * TILE_WIDTH + lane % TILE_WIDTH, first + lane / TILE_WIDTH];
            let point = &mut points[(y * camera.size()[0] + x) * POINT_STEP..];
            let colour = [0, 1, 2].map(|channel| colours[channel][lane]);
            point[POINT_RGB..POINT_RGB + 4].copy_from_slice(&rgb(colour));
        }
    }
}

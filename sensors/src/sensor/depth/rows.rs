//! The outputs of a depth frame, split between rows of tiles.

use super::contrast::Brightness;
use super::device_input::DeviceInput;
use super::{DepthCamera, POINT_STEP};
use crate::device::TileView;
use crate::execution::{SplitRows, split_at};
use crate::optics::rays::Rays;
use crate::scene::ColourSpace;
use crate::sensor::camera::Camera;
use crate::sensor::camera::brush::ColourRows;
use crate::sensor::edges::{Canvas, TILE_HEIGHT, TILE_WIDTH};
use crate::sensor::pixel::{self, to_byte};
use crate::shade::Colours;
use crate::simd::{LANES, WIDTH, load_row, quarters};
use crate::trace::Truth;
use crate::trace::grid::Band;
use crate::trace::grid::place::Place;
use crate::trace::grid::tiling::{BLOCKS, Tiling};
use fearless_simd::{Bytes, Select, Simd, SimdBase, f32x4, f32x16};

/// The offset of the colour in a point, in bytes.
const POINT_RGB: usize = 16;

/// Returns the colour of a point as bytes.
#[inline(always)]
fn rgb(colour: [f32; 3]) -> [u8; 4] {
    let [red, green, blue] = colour.map(to_byte);
    [blue, green, red, 0]
}

/// The coordinates of sixteen neighbouring points of a row: right, down, ahead and 0; NaN where there is no depth.
pub(super) struct Places([[f32; 4]; WIDTH]);

impl Places {
    /// Computes the points of sixteen pixels of a row, beginning at a column that is a multiple of sixteen.
    #[inline(always)]
    pub(super) fn new<S: Simd>(
        simd: S,
        rays: &Rays<'_>,
        [column, row]: [usize; 2],
        depths: f32x16<S>,
    ) -> Self {
        let [right, down] = rays.slopes(simd, column, row);
        let is_finite = depths.abs().simd_lt(f32x16::splat(simd, f32::INFINITY));
        let nowhere = f32x16::splat(simd, f32::NAN);
        let x = quarters(simd, is_finite.select(right * depths, nowhere));
        let y = quarters(simd, is_finite.select(down * depths, nowhere));
        let z = quarters(simd, is_finite.select(depths, nowhere));
        let zero = f32x4::splat(simd, 0.0);
        let mut places = [[0.0; 4]; WIDTH];
        for (four, places) in places.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let (x, y, z) = (x[four], y[four], z[four]);
            let (xz, yw) = (simd.zip_low_f32x4(x, z), simd.zip_low_f32x4(y, zero));
            simd.zip_low_f32x4(xz, yw).store_array(&mut places[0]);
            simd.zip_high_f32x4(xz, yw).store_array(&mut places[1]);
            let (xz, yw) = (simd.zip_high_f32x4(x, z), simd.zip_high_f32x4(y, zero));
            simd.zip_low_f32x4(xz, yw).store_array(&mut places[2]);
            simd.zip_high_f32x4(xz, yw).store_array(&mut places[3]);
        }
        Self(places)
    }

    /// Writes as many coordinates as there is room for.
    #[inline(always)]
    pub(super) fn write(&self, output: &mut [[f32; 3]]) {
        for (output, &[x, y, z, _]) in output.iter_mut().zip(&self.0) {
            *output = [x, y, z];
        }
    }

    /// Writes as many coordinates as there is room for into points, without changing their colours.
    #[inline(always)]
    pub(super) fn write_places(&self, points: &mut [u8]) {
        for (point, place) in points.as_chunks_mut::<POINT_STEP>().0.iter_mut().zip(&self.0) {
            write_words(&place.map(f32::to_bits), &mut point[..POINT_RGB]);
        }
    }

    /// Writes as many whole points as there is room for.
    #[inline(always)]
    fn write_points(&self, colours: &[u32; WIDTH], points: &mut [u8]) {
        let points = points.as_chunks_mut::<POINT_STEP>().0.iter_mut();
        for ((point, place), &colour) in points.zip(&self.0).zip(colours) {
            write_words(&place.map(f32::to_bits), &mut point[..POINT_RGB]);
            write_words(&[colour, 0, 0, 0], &mut point[POINT_RGB..]);
        }
    }
}

/// Writes words as bytes, in little-endian order.
#[inline(always)]
fn write_words(words: &[u32; 4], bytes: &mut [u8]) {
    for (bytes, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *bytes = word.to_le_bytes();
    }
}

/// Converts depths to millimetres; 0 where they do not fit into 16 bits.
#[inline(always)]
pub(super) fn millimetres<S: Simd>(simd: S, depths: f32x16<S>) -> [u16; WIDTH] {
    let millimetres = depths * 1000.0 + 0.5;
    let (least, end) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 65536.0));
    let fits = millimetres.simd_ge(least) & millimetres.simd_lt(end);
    let whole = simd.cvt_i32_f32x16(fits.select(millimetres, f32x16::splat(simd, 0.0)));
    let (first, second) = simd.split_u32x16(whole.bitcast());
    simd.narrow_u32x8(first, second).into()
}

/// The outputs of a frame, split between rows of tiles.
pub(super) struct DepthRows<'a> {
    pub(super) depth_32fc1: Option<&'a mut [f32]>,
    pub(super) depth_16uc1: Option<&'a mut [u16]>,
    pub(super) points: Option<&'a mut [u8]>,
    pub(super) xyz: Option<&'a mut [[f32; 3]]>,
    /// The true depths that the device model reads. Without one, depths are measured as they are traced.
    pub(super) seen: Option<DeviceInput<'a>>,
    /// The brightnesses that the device model reads.
    pub(super) brightness: Option<Brightness<'a>>,
    pub(super) truth: Option<Truth<'a>>,
    /// The width of the picture.
    pub(super) width: usize,
    /// The number of rows of a tile.
    pub(super) lines_in_tile: usize,
    pub(super) wants_colour: bool,
    pub(super) colour: ColourRows<'a>,
}

impl SplitRows for DepthRows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { width, lines_in_tile, wants_colour, .. } = self;
        let pixels = rows * lines_in_tile * width;
        let (depth_32fc1, lower_32fc1) = split_at(self.depth_32fc1, pixels);
        let (depth_16uc1, lower_16uc1) = split_at(self.depth_16uc1, pixels);
        let (points, lower_points) = split_at(self.points, pixels * POINT_STEP);
        let (xyz, lower_xyz) = split_at(self.xyz, pixels);
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
                xyz,
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
                xyz: lower_xyz,
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

impl DepthRows<'_> {
    /// Returns true if points are requested, with or without colours.
    #[inline(always)]
    pub(super) fn wants_places(&self) -> bool {
        self.points.is_some() || self.xyz.is_some()
    }

    /// Returns true if depths are measured as they are traced: they are requested, and there is no device model to read
    /// them.
    #[inline(always)]
    pub(super) fn wants_measured(&self) -> bool {
        let wants_depth = self.depth_32fc1.is_some() || self.depth_16uc1.is_some() || self.wants_places();
        wants_depth && self.seen.is_none()
    }

    /// Iterates over the lines of a tile that lie in the picture: number, column and row, index of the first pixel in
    /// the output, and number of pixels.
    #[inline(always)]
    fn lines_of(
        &self,
        band: &Band<'_>,
        [column, row]: [usize; 2],
    ) -> impl Iterator<Item = (usize, [usize; 2], usize, usize)> + use<> {
        let tiling = Tiling::of(band.rays.ray_grid());
        let ([across, down], width) = (tiling.size(), self.width);
        let [first_row, last_row] = [band.first_row, band.rows[1]].map(|row| row as usize);
        (0..BLOCKS).filter_map(move |line| {
            let [x, y] = tiling.line(line);
            let (x, y) = (column * across + x, row * down + y);
            (x < width && y <= last_row)
                .then(|| (line, [x, y], (y - first_row) * width + x, WIDTH.min(width - x)))
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
            place.write(&millimetres(simd, depths), output);
        }
    }

    /// Writes the brightnesses of a tile, if the device model reads them.
    #[inline(always)]
    pub(super) fn write_brightness(&mut self, colours: &Colours, band: &Band<'_>, tile: [usize; 2]) {
        let lines = self.lines_of(band, tile);
        let Some(brightness) = &mut self.brightness else { return };
        for (line, _, first, count) in lines {
            brightness.write(colours, line * WIDTH, (first, count));
        }
    }

    /// Writes the requested outputs for the points of a tile, from the depths of its lines. Colours are only used for
    /// [`DepthRows::points`].
    #[inline(always)]
    pub(super) fn write_points<S: Simd>(
        &mut self,
        simd: S,
        depths: &[f32x16<S>; BLOCKS],
        colours: &Colours,
        band: &Band<'_>,
        tile: [usize; 2],
    ) {
        for (line, pixel, first, count) in self.lines_of(band, tile) {
            let places = Places::new(simd, &band.rays, pixel, depths[line]);
            if let Some(xyz) = &mut self.xyz {
                places.write(&mut xyz[first..][..count]);
            }
            if let Some(points) = &mut self.points {
                let [red, green, blue] = colours;
                let [red, green, blue] =
                    [load_row(simd, red, line), load_row(simd, green, line), load_row(simd, blue, line)];
                let colours = pixel::to_bytes(simd, [blue, green, red]).into();
                places.write_points(&colours, &mut points[first * POINT_STEP..][..count * POINT_STEP]);
            }
        }
    }
}

/// The rest of a frame from some row of tiles on, whose edges are painted over.
pub(super) struct RetouchedFrame<'a> {
    pub(super) camera: &'a Camera<'a>,
    pub(super) frame: u64,
    pub(super) space: ColourSpace,
    pub(super) colour: Option<&'a mut [u8]>,
    pub(super) points: Option<&'a mut [u8]>,
}

impl SplitRows for RetouchedFrame<'_> {
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

impl Canvas for RetouchedFrame<'_> {
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

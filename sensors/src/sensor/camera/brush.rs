//! Colouring the tiles of a traced band: light, its mean over the moments of a shutter, exposure and noise.

use super::{Camera, CameraConfig};
use crate::device::TileView;
use crate::execution::{SplitRows, split_at};
use crate::memory::{Cutter, lines};
use crate::moment::{Capture, Shutter};
use crate::optics::rays::RayGrid;
use crate::scene::ColourSpace;
use crate::sensor::edges::{Edges, Marks};
use crate::sensor::pixel;
use crate::shade::tile::{CameraRays, Tile, missing_lanes};
use crate::shade::transparency;
use crate::shade::uniform::UniformTiles;
use crate::shade::{Colours, Shader};
use crate::simd::LANES;
use crate::trace::grid::tiling::Tiling;
use crate::trace::grid::{Band, Sight};
use crate::trace::hit::resolve::Resolver;
use fearless_simd::Simd;

/// Rows of colours, split between rows of tiles.
pub(in crate::sensor) struct ColourRows<'a> {
    /// `None` if the picture itself is not requested.
    pixels: Option<&'a mut [u8]>,
    /// The light of each tile, summed over the moments that see it; empty if no tile is seen at more than one moment.
    sums: &'a mut [Colours],
    marks: Marks<'a>,
    /// Bytes of a row of tiles.
    bytes: usize,
    /// Tiles across.
    tiles: usize,
}

/// Returns the number of cache lines of [`ColourRows::sums`].
pub(in crate::sensor) fn sums_len(ray_grid: &RayGrid, shutter: &Shutter<'_>) -> usize {
    lines(sums(ray_grid, shutter) * size_of::<Colours>())
}

/// Returns the number of tiles whose light is summed: all or none.
fn sums(ray_grid: &RayGrid, shutter: &Shutter<'_>) -> usize {
    if shutter.blurs() {
        Tiling::of(ray_grid).across(ray_grid.width as usize) * ray_grid.blocks_down()
    } else {
        0
    }
}

impl<'a> ColourRows<'a> {
    pub(in crate::sensor) fn new<'m>(
        camera: &Camera<'_>,
        ray_grid: &RayGrid,
        shutter: &Shutter<'_>,
        (pixels, marks): (Option<&'a mut [u8]>, &'a mut [u32]),
        memory: &mut Cutter<'m>,
    ) -> Self
    where
        'm: 'a,
    {
        let tiling = Tiling::of(ray_grid);
        Self {
            pixels,
            sums: memory.take(sums(ray_grid, shutter)),
            marks: Marks::new(marks, ray_grid.width as usize),
            bytes: camera.row_stride() * tiling.size()[1],
            tiles: tiling.across(ray_grid.width as usize),
        }
    }
}

impl ColourRows<'_> {
    /// Returns true if light is summed over moments.
    #[inline(always)]
    pub(in crate::sensor) fn sums(&self) -> bool {
        !self.sums.is_empty()
    }
}

impl SplitRows for ColourRows<'_> {
    fn split_rows(self, rows: usize) -> (Self, Self) {
        let Self { bytes, tiles, .. } = self;
        let (pixels, pixels_below) = split_at(self.pixels, rows * bytes);
        let (sums, sums_below) = self.sums.split_at_mut((rows * tiles).min(self.sums.len()));
        let (marks, marks_below) = self.marks.split_rows(rows);
        (
            Self { pixels, sums, marks, bytes, tiles },
            Self { pixels: pixels_below, sums: sums_below, marks: marks_below, bytes, tiles },
        )
    }
}

/// Colours the tiles of one band.
pub(in crate::sensor) struct Brush<'a> {
    camera: &'a Camera<'a>,
    capture: &'a Capture<'a>,
    rays: CameraRays<'a>,
    resolver: Resolver<'a>,
    seen: Tile,
    shader: Shader,
    /// Finds tiles of a single colour; set if only colours are needed, without per-ray data.
    uniform: Option<UniformTiles>,
    sight: Sight,
    space: ColourSpace,
    /// The light of the last tile seen, and after [`Brush::expose`] its colours.
    pub(in crate::sensor) colours: Colours,
    tiling: Tiling,
    /// Tiles across.
    pub(in crate::sensor) tiles: usize,
}

impl<'a> Brush<'a> {
    #[inline(always)]
    pub(in crate::sensor) fn new<'b: 'a>(
        camera: &'a Camera<'a>,
        capture: &'a Capture<'a>,
        band: &Band<'b>,
    ) -> Self {
        let ray_grid = band.rays.ray_grid();
        let tiling = Tiling::of(ray_grid);
        Self {
            camera,
            capture,
            rays: CameraRays::new(&band.rays, &band.view.world_from_sensor),
            resolver: Resolver::new(band.view),
            seen: const { Tile::new() },
            shader: Shader::NEW,
            uniform: match camera.config() {
                CameraConfig { edges: Edges::Sharp, device: None, faces, .. } => {
                    UniformTiles::new(&band.view.scene, *faces)
                }
                _ => None,
            },
            sight: camera.sight(),
            space: band.view.scene.colour_space(),
            colours: [[0.0; LANES]; 3],
            tiling,
            tiles: tiling.across(ray_grid.width as usize),
        }
    }

    /// Sets its shader, before anything else. Apart from [`Brush::new`], which so returns what lies on the stack but
    /// once.
    pub(in crate::sensor) fn set_shader(&mut self) {
        let CameraConfig { faces, edges, .. } = *self.camera.config();
        self.shader.set(faces, edges == Edges::Smooth);
    }

    /// Works out the light of a tile.
    #[inline(always)]
    pub(in crate::sensor) fn see<S: Simd>(&mut self, simd: S, band: &Band<'_>, tile: [usize; 2]) {
        if let Some(uniform) = &mut self.uniform
            && let Some(colour) = uniform.colour(simd, band, &mut self.resolver, &self.rays, tile)
        {
            for channel in 0..3 {
                self.colours[channel] = [colour[channel]; LANES];
            }
            self.seen.missing = missing_lanes(&band.rays, tile);
            return;
        }
        self.seen.take(simd, band, &mut self.resolver, &self.rays, tile);
        let Self { shader, resolver, colours, seen, .. } = self;
        let steps = &self.rays.steps;
        shader.shade(simd, band.view, seen, steps, colours);
        if shader.is_clear() {
            transparency::look(simd, band.view, &self.sight, (shader, resolver, steps), seen, colours);
        }
    }

    /// Writes the marks of the last tile seen, if marks are kept.
    #[inline(always)]
    pub(in crate::sensor) fn mark<S: Simd>(
        &self,
        simd: S,
        band: &Band<'_>,
        [column, row]: [usize; 2],
        output: &mut ColourRows<'_>,
    ) {
        let (exposure, place) = (self.camera.config().exposure, [column, band.row_in_output(row)]);
        if self.space == ColourSpace::AsGiven || self.shader.seen().is_none() {
            output.marks.put(simd, &self.colours, exposure, &self.shader, self.seen.missing, place);
            return;
        }
        let mut shown = self.colours;
        pixel::expose(&mut shown, exposure);
        pixel::encode(&mut shown);
        output.marks.put(simd, &shown, 1.0, &self.shader, self.seen.missing, place);
    }

    /// Replaces the light of the last tile by its mean over the moments of the shutter. Returns false if further
    /// moments are to come.
    #[inline(always)]
    pub(in crate::sensor) fn take_mean(
        &mut self,
        band: &Band<'_>,
        [column, row]: [usize; 2],
        output: &mut ColourRows<'_>,
    ) -> bool {
        let line = (row * self.tiling.size()[1]) as i32;
        let Some(sum) = output.sums.get_mut(band.row_in_output(row) * self.tiles + column) else {
            return true;
        };
        let (is_first, is_last) = (line >= band.fresh_from, line < band.open_from);
        let moments =
            if is_last { self.capture.shutter.covering(line as u32..line as u32 + 1).len() } else { 1 };
        let share = 1.0 / moments as f32;
        for (colours, sum) in self.colours.iter_mut().zip(sum) {
            for lane in 0..LANES {
                let before = if is_first { 0.0 } else { sum[lane] };
                sum[lane] = before + colours[lane];
                colours[lane] = sum[lane] * share;
            }
        }
        is_last
    }

    /// Converts light to the values that the camera outputs.
    #[inline(always)]
    pub(in crate::sensor) fn expose<S: Simd>(&mut self, simd: S, [column, row]: [usize; 2]) {
        let view = TileView {
            directions: &self.seen.direction,
            forward: self.rays.forward(),
            lines: self.tiling.lines([column, row]),
            samples: self.tiling.samples(self.rays.width(), [column, row]),
        };
        let (frame, missing) = (self.capture.frame, self.seen.missing);
        self.camera.expose(simd, (frame, self.space), &view, missing, &mut self.colours);
    }

    /// Writes the colours into the picture, if it is requested.
    #[inline(always)]
    pub(in crate::sensor) fn write<S: Simd>(
        &self,
        simd: S,
        band: &Band<'_>,
        tile: [usize; 2],
        output: &mut ColourRows<'_>,
    ) {
        let Some(pixels) = output.pixels.as_deref_mut() else { return };
        let format = (self.camera.config().format, self.camera.full_scale());
        let rows = &mut pixels[band.row_in_output(tile[1]) * output.bytes..];
        pixel::write_tile(simd, &self.colours, format, (self.tiling, tile), rows, self.camera.row_stride());
    }
}

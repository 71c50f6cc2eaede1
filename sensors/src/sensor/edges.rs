//! Anti-aliased edges: more rays where neighbouring pixels differ.
//!
//! A picture is first traced and shaded with one ray per pixel, and a [mark](Marks) is kept of each pixel: its colour,
//! and a number for what it shows (instance, face, side of a shadow). Where a neighbour shows something else in another
//! colour, an edge of a shape or of a shadow runs between the two. There the pixel becomes the mean of [`SAMPLES`] rays
//! spread over its square, in linear light and before exposure and noise. Textures on a surface are already filtered by
//! the footprints of the rays.
//!
//! Marks are compared once the picture is complete, so that the borders of bands do not show, and in chunks that do not
//! depend on the number of threads. Pixels without an edge keep their exact values.

mod marks;

use crate::device::TileView;
use crate::execution::{Execution, SplitRows, for_each_row};
use crate::optics::Optics;
use crate::optics::rays::{PinholeRays, Rays, TableRays};
use crate::shade::tile::{CameraRays, Tile};
use crate::shade::transparency;
use crate::shade::{Colours, Shader};
use crate::simd::{LANES, WIDTH, dispatch};
use crate::trace::grid::tiling::Tiling;
use crate::trace::grid::{Frame, Sight};
use crate::trace::hit::resolve::Resolver;
use crate::trace::packet::hits::first_hits;
use crate::trace::packet::{MISS, Packet};
use crate::trace::placed::view::View;
use fearless_simd::{Simd, SimdBase, SimdMask, u32x16};
use glam::DVec3;
pub(crate) use marks::Marks;
use marks::{COLOUR, NO_RAY, beyond};
pub(super) use marks::{TILE_HEIGHT, TILE_WIDTH};

/// The treatment of the edges of shapes and shadows in a picture.
///
/// ```
/// use belvedere_sensors::{camera::*, optics::PinholeGrid, scene::*, trace::*, Capture, Pose, Sensor};
/// let mut builder = SceneBuilder::new();
/// builder.set_environment(Environment { background: [0.0; 3], ..Default::default() });
/// let black = MaterialConfig { diffuse: [0.0; 3], ambient: [0.0; 3], ..Default::default() };
/// let white = builder.add_material(&MaterialConfig { emissive: [1.0; 3], ..black })?;
/// builder.add_instance(&InstanceConfig {
///     shape: Shape::Sphere { radius: 0.5 },
///     world_from_instance: Pose::from_translation(belvedere_sensors::glam::DVec3::X * 2.0),
///     material: white,
///     ..Default::default()
/// })?;
/// let (scene, capture) = (builder.scene(), Capture::new(0, builder.moment(Pose::IDENTITY)));
/// let config = CameraConfig::new(PinholeGrid::from_fov(64, 48, 1.0)?).format(PixelFormat::Mono8);
/// let greys = |edges| {
///     let camera = Camera::new(config.edges(edges)).unwrap();
///     let mut pixels = vec![0; camera.frame_len()];
///     let mut memory = WorkspaceBuf::default();
///     camera.sense_in(&mut memory, &scene, &capture, Picture::new().colour(&mut pixels)).unwrap();
///     pixels.sort_unstable();
///     pixels.dedup();
///     pixels
/// };
/// assert_eq!(greys(Edges::Sharp), [0, 255]);
/// assert_eq!(greys(Edges::Smooth), [0, 64, 128, 191, 255]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edges {
    /// One ray per pixel, through its centre. Edges are aliased.
    #[default]
    Sharp,
    /// Anti-aliasing: a pixel at an edge has the mean colour of four rays spread over it. Edges stay sharp in pictures
    /// taken at several moments ([`Shutter::Slices`](crate::Shutter::Slices)) and in pictures of a grid of angles
    /// ([`SphericalGrid`](crate::optics::SphericalGrid)).
    Smooth,
}

/// The number of rays of a pixel at an edge.
const SAMPLES: usize = 4;
/// Offsets of these rays to the right and down from the pixel's centre. Each lies in a different one of four rows and of four
/// columns.
const OFFSETS: [[f64; 2]; SAMPLES] = [[-0.125, -0.375], [0.375, -0.125], [-0.375, 0.125], [0.125, 0.375]];
/// The number of pixels whose rays are traced together.
const PIXELS: usize = LANES / SAMPLES;
/// The number of rows of tiles that are searched and painted together.
const CHUNK: usize = 8;
/// The number of tiles of a row that are searched together.
const GROUP: usize = 16;
/// The number of pixels that are painted together.
const QUEUE: usize = 8 * PIXELS;

/// A picture in which pixels are painted over.
pub(crate) trait Canvas: SplitRows {
    /// Paints the lanes of a tile that are set in the mask `lanes`; the colours of the others are undefined. `place` is
    /// the column of the tile, and its row in this part of the picture.
    fn paint<S: Simd>(
        &mut self,
        simd: S,
        view: &TileView<'_>,
        place: [usize; 2],
        lanes: u64,
        colours: &mut Colours,
    );
}

/// Smooths the edges of a picture that is otherwise complete, if there are marks. By itself, for the sake of the stack.
#[inline(never)]
pub(crate) fn smooth(
    (frame, optics): (&Frame<'_>, &Optics<'_>),
    sight: Sight,
    marks: &[u32],
    execution: Execution,
    canvas: impl Canvas,
) {
    if let Some(smoothing) = Smoothing::new(frame, optics, sight, marks) {
        smoothing.paint(execution, canvas);
    }
}

/// Smooths the edges of a picture that is otherwise complete.
struct Smoothing<'a> {
    view: &'a View<'a>,
    rays: Rays<'a>,
    camera_rays: CameraRays<'a>,
    sight: Sight,
    marks: &'a [u32],
    /// The width and height of the picture.
    size: [usize; 2],
}

impl<'a> Smoothing<'a> {
    /// None, if there are no marks.
    fn new(frame: &'a Frame<'a>, optics: &Optics<'a>, sight: Sight, marks: &'a [u32]) -> Option<Self> {
        let view = frame.view()?;
        let rays = match optics {
            _ if marks.is_empty() => return None,
            Optics::Pinhole(grid) => Rays::Pinhole(PinholeRays::new(grid, *frame.ray_grid())),
            Optics::Table(table) => Rays::Table(TableRays::new(table)),
            Optics::Spherical(_) => return None,
        };
        let camera_rays = CameraRays::new(&rays, &view.world_from_sensor);
        Some(Self { view, rays, camera_rays, sight, marks, size: optics.size() })
    }

    /// Paints all edges.
    fn paint(&self, execution: Execution, canvas: impl Canvas) {
        let [width, height] = self.size;
        let (across, down) = (width.div_ceil(TILE_WIDTH), height.div_ceil(TILE_HEIGHT));
        let work = |chunk: usize, mut canvas: Chunks<_>| {
            let rows = chunk * CHUNK..((chunk + 1) * CHUNK).min(down);
            dispatch!(execution.level, simd => simd.vectorize(
                #[inline(always)]
                || self.paint_chunk(simd, rows, across, &mut canvas.0)
            ));
        };
        for_each_row(execution, 0..down.div_ceil(CHUNK), Chunks(canvas), &work);
    }

    /// Paints the edges in some rows of `across` tiles each.
    #[inline(always)]
    fn paint_chunk<S: Simd>(
        &self,
        simd: S,
        rows: core::ops::Range<usize>,
        across: usize,
        canvas: &mut impl Canvas,
    ) {
        let mut scratch = EdgeScratch::new(self.view);
        scratch.shader.set(self.sight.faces, false);
        let mut pixels = [Pixel { tile: [0; 2], lane: 0, colour: [0.0; 3] }; QUEUE];
        let (mut waiting, mut sampled) = (0, 0);
        for row in rows.clone() {
            for first in (0..across).step_by(GROUP) {
                let edges = self.find(simd, first..(first + GROUP).min(across), row);
                for (tile, &lanes) in edges.iter().enumerate() {
                    let mut rest = lanes;
                    while rest != 0 {
                        let lane = rest.trailing_zeros() as usize % LANES;
                        rest &= rest - 1;
                        pixels[waiting] = Pixel { tile: [first + tile, row], lane, colour: [0.0; 3] };
                        waiting += 1;
                        if waiting == sampled + PIXELS {
                            self.sample(simd, &mut scratch, &mut pixels[sampled..waiting]);
                            sampled = waiting;
                        }
                        if waiting == QUEUE {
                            self.put_down(simd, &mut scratch.tile, &pixels, rows.start, canvas);
                            (waiting, sampled) = (0, 0);
                        }
                    }
                }
            }
        }
        if sampled < waiting {
            self.sample(simd, &mut scratch, &mut pixels[sampled..waiting]);
        }
        self.put_down(simd, &mut scratch.tile, &pixels[..waiting], rows.start, canvas);
    }

    /// The pixels of some tiles of a row at which there is an edge, a bit each. By itself, for the sake of the stack.
    #[inline(never)]
    fn find<S: Simd>(&self, simd: S, group: core::ops::Range<usize>, row: usize) -> [u64; GROUP] {
        simd.vectorize(
            #[inline(always)]
            || self.find_among_marks(simd, group, row),
        )
    }

    #[inline(always)]
    fn find_among_marks<S: Simd>(&self, simd: S, group: core::ops::Range<usize>, row: usize) -> [u64; GROUP] {
        const MARGIN: usize = WIDTH;
        let [width, height] = self.size;
        // The marks of these rows, with a border around them.
        let mut near = [[NO_RAY; MARGIN + GROUP * TILE_WIDTH + MARGIN]; TILE_HEIGHT + 2];
        let first = group.start * TILE_WIDTH;
        let (before, after) = (first.saturating_sub(1), (group.end * TILE_WIDTH + 1).min(width));
        for (y, line) in near.iter_mut().enumerate() {
            let Some(y) = (row * TILE_HEIGHT + y).checked_sub(1) else { continue };
            if y < height {
                let from = MARGIN - (first - before);
                line[from..from + after - before]
                    .copy_from_slice(&self.marks[y * width + before..y * width + after]);
            }
        }
        let mut edges = [0; GROUP];
        for (tile, edges) in edges.iter_mut().enumerate().take(group.len()) {
            let x = MARGIN + tile * TILE_WIDTH;
            for y in 1..=TILE_HEIGHT {
                let at = |x: usize, y: usize| u32x16::from_slice(simd, &near[y][x..x + WIDTH]);
                let own = at(x, y);
                let sides = [at(x - 1, y), at(x + 1, y), at(x, y - 1), at(x, y + 1)];
                let elsewhere = (own ^ sides[0]) | (own ^ sides[1]) | (own ^ sides[2]) | (own ^ sides[3]);
                if !elsewhere.simd_gt(COLOUR).any_true() {
                    continue;
                }
                let mut edge = u32x16::splat(simd, 0);
                for side in sides {
                    edge |= beyond(simd, own, side);
                }
                let edge = edge.simd_ne(0) & own.simd_ne(NO_RAY);
                *edges |= edge.to_bitmask() << ((y - 1) * TILE_WIDTH);
            }
        }
        edges
    }

    /// Traces the rays of up to sixteen pixels and sets these pixels to their mean colours. Compiled once per SIMD
    /// level, for all canvases.
    #[inline(never)]
    fn sample<S: Simd>(&self, simd: S, scratch: &mut EdgeScratch<'_>, pixels: &mut [Pixel]) {
        let EdgeScratch { tile, shader, resolver, colours } = scratch;
        simd.vectorize(
            #[inline(always)]
            || {
                let (packet, local) = shader.rays();
                self.aim(pixels, packet, tile);
                first_hits(simd, self.view, packet, local, self.sight.faces);
                tile.take_first_hits(simd, packet, resolver);
            },
        );
        let steps = &self.camera_rays.steps;
        shader.shade(simd, self.view, tile, steps, colours);
        if shader.is_clear() {
            transparency::look(simd, self.view, &self.sight, (shader, resolver, steps), tile, colours);
        }
        for channel in 0..3 {
            let samples = colours[channel].as_chunks::<SAMPLES>().0;
            for (pixel, [a, b, c, d]) in pixels.iter_mut().zip(samples) {
                pixel.colour[channel] = ((a + b) + (c + d)) * (1.0 / SAMPLES as f32);
            }
        }
    }

    /// Sets up the rays. The rays of a pixel lie in neighbouring lanes, so that a row of lanes sees few surfaces.
    #[inline(always)]
    fn aim(&self, pixels: &[Pixel], packet: &mut Packet, tile: &mut Tile) {
        let axes = self.view.world_from_sensor.rotation_matrix();
        let [near, far] = self.sight.range;
        (packet.origin, packet.shared_origin) = ([[0.0; LANES]; 3], true);
        packet.t_min = near;
        packet.hit = [MISS; LANES];
        packet.t = [f64::NEG_INFINITY; LANES];
        let mut put = |lane: usize, direction: DVec3| {
            let direction = axes * direction;
            for axis in 0..3 {
                packet.direction[axis][lane] = direction[axis];
            }
            packet.t[lane] = far;
        };
        for (place, pixel) in pixels.iter().enumerate() {
            let column = pixel.tile[0] * TILE_WIDTH + pixel.lane % TILE_WIDTH;
            let row = pixel.tile[1] * TILE_HEIGHT + pixel.lane / TILE_WIDTH;
            if let Rays::Pinhole(pinhole) = &self.rays {
                let lens = pinhole.intrinsics();
                for (sample, [right, down]) in OFFSETS.iter().enumerate() {
                    let left = (lens.cx - (column as f64 + right)) / lens.fx;
                    let up = (lens.cy - (row as f64 + down)) / lens.fy;
                    put(place * SAMPLES + sample, DVec3::new(1.0, left, up));
                }
                continue;
            }
            let neighbours = self.rays.neighbours(column as i32, row as i32);
            let steps = neighbours.steps().map(|step| axes * step);
            for (sample, [right, down]) in OFFSETS.iter().enumerate() {
                let lane = place * SAMPLES + sample;
                put(lane, neighbours.direction(*right, *down));
                for side in 0..2 {
                    for axis in 0..3 {
                        tile.steps[side][axis][lane] = steps[side][axis] as f32;
                    }
                }
            }
        }
    }

    /// Paints pixels into the part of a picture that begins at the tile row `first_row`. Pixels of the same tile must
    /// be adjacent.
    #[inline(never)]
    fn put_down<S: Simd>(
        &self,
        simd: S,
        tile: &mut Tile,
        pixels: &[Pixel],
        first_row: usize,
        canvas: &mut impl Canvas,
    ) {
        simd.vectorize(
            #[inline(always)]
            || {
                let mut colours = [[0.0; LANES]; 3];
                for pixels in pixels.chunk_by(|a, b| a.tile == b.tile) {
                    let ([column, row], mut lanes) = (pixels[0].tile, 0);
                    for pixel in pixels {
                        lanes |= 1 << pixel.lane;
                        for channel in 0..3 {
                            colours[channel][pixel.lane] = pixel.colour[channel];
                        }
                    }
                    tile.take_directions(simd, &self.camera_rays, [column, row]);
                    let view = TileView {
                        directions: &tile.direction,
                        forward: self.camera_rays.forward(),
                        lines: Tiling::Square.lines([column, row]),
                        samples: Tiling::Square.samples(self.size[0], [column, row]),
                    };
                    canvas.paint(simd, &view, [column, row - first_row], lanes, &mut colours);
                }
            },
        );
    }
}

/// A pixel at an edge.
#[derive(Clone, Copy)]
struct Pixel {
    /// Column and row of the pixel's tile.
    tile: [usize; 2],
    lane: usize,
    colour: [f32; 3],
}

/// Working memory that is reused from chunk to chunk.
struct EdgeScratch<'a> {
    tile: Tile,
    shader: Shader,
    resolver: Resolver<'a>,
    colours: Colours,
}

impl<'a> EdgeScratch<'a> {
    #[inline(always)]
    fn new(view: &'a View<'a>) -> Self {
        Self {
            tile: const { Tile::new() },
            shader: Shader::NEW,
            resolver: Resolver::new(view),
            colours: [[0.0; LANES]; 3],
        }
    }
}

/// A canvas, split between chunks of rows.
struct Chunks<C>(C);

impl<C: SplitRows> SplitRows for Chunks<C> {
    fn split_rows(self, chunks: usize) -> (Self, Self) {
        let (upper, lower) = self.0.split_rows(chunks * CHUNK);
        (Self(upper), Self(lower))
    }
}

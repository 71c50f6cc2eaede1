//! Hits seen by specular reflection and transmission.

use crate::simd::{LANES, WIDTH};
use crate::trace::grid::{Band, Sight};
use crate::trace::hit::point::block_index;
use crate::trace::hit::resolve::Resolver;
use crate::trace::image::NO_HIT;
use crate::trace::packet::moving::{MovingHit, MovingPacket, Ways};
use crate::trace::packet::paths::{Behind, Found, Path, Paths, SURFACES};
use crate::trace::packet::scratch::SpecularScratch;
use crate::trace::placed::view::View;
use fearless_simd::{Select, Simd, SimdBase, f32x16};
use glam::{DMat3, DVec3};

/// Rays continue at this fraction of their length behind or in front of a surface, more than the rounding error of
/// single precision.
const GAP: f64 = 1e-5;
/// Paths on which less than this fraction of the light returns are not followed.
const LEAST: f64 = 1e-6;

/// The fractions of the light that a surface reflects and transmits; the rest is scattered.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares {
    reflected: f64,
    passed: f64,
}

impl Shares {
    /// The fractions for an instance.
    #[inline(always)]
    pub(crate) fn of(view: &View<'_>, instance: u32) -> Self {
        let material = view.scene.instances[instance as usize].material;
        let material = &view.scene.materials[material as usize];
        Self { reflected: material.specular_reflectance.into(), passed: material.transmittance.into() }
    }

    /// Returns true if the surface scatters all light.
    #[inline(always)]
    pub(crate) fn is_matt(self) -> bool {
        self.reflected == 0.0 && self.passed == 0.0
    }

    pub(crate) fn scattered(self) -> f64 {
        (1.0 - self.reflected - self.passed).max(0.0)
    }
}

/// The way in which a ray continues.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Through,
    Back,
}

impl Path {
    /// The path after a hit on a surface, or `None` if too little of the light is left.
    fn after(&self, struck: &MovingHit, shares: Shares, way: Way) -> Option<Self> {
        let part = if way == Way::Through { shares.passed } else { shares.reflected };
        // The light passes the surface twice: there and back.
        let light = self.light * part * part;
        if light < LEAST {
            return None;
        }
        let across = self.direction.dot(struck.normal);
        let mirrored = self.direction - struck.normal * (2.0 * across);
        let direction = if way == Way::Through { self.direction } else { mirrored };
        let start = GAP * (self.range + struck.range) / across.abs().max(0.01);
        let point = self.origin + self.direction * struck.range;
        let range = self.range + struck.range + start;
        Some(Self { origin: point + direction * start, direction, range, light, ..*self })
    }
}

/// The hit of a ray at the end of a path, given by its length and the fraction of the light that returns.
fn behind(lane: usize, slot: u32, struck: &MovingHit, (way, light): (f64, f64)) -> Behind {
    Behind {
        lane: lane as u32,
        slot,
        instance: struck.instance,
        cos_incidence: struck.cos_incidence as f32,
        range: way + struck.range,
        light,
    }
}

/// Follows up to this many rays beyond their first hits.
pub(crate) struct Beyond<'m, const RAYS: usize> {
    paths: &'m mut Paths<RAYS>,
    counts: [usize; 2],
    found: &'m mut Found<RAYS>,
    found_count: usize,
}

impl<'m, const RAYS: usize> Beyond<'m, RAYS> {
    /// Uses memory for the paths and the hits, whose previous contents do not matter.
    pub(crate) fn new(paths: &'m mut Paths<RAYS>, found: &'m mut Found<RAYS>) -> Self {
        Self { paths, counts: [0; 2], found, found_count: 0 }
    }

    /// Starts the paths behind mirrors and panes of the rays of a moving packet, which has been cast. No more rays than
    /// there is memory for may have hits. At the first surface, a ray continues in both ways.
    pub(crate) fn set_out(&mut self, (view, resolver): (&View<'_>, &mut Resolver<'_>), first: &MovingPacket) {
        (self.counts, self.found_count) = ([0; 2], 0);
        for lane in 0..LANES {
            let Some(slot) = first.slot(lane) else { continue };
            let shares = Shares::of(view, resolver.hit(slot).instance.instance);
            if shares.is_matt() {
                continue;
            }
            let Some(struck) = first.struck(view, resolver, lane) else { continue };
            let [origin, direction] = first.ray(lane);
            let (lane, share) = (lane as u64, first.share(lane));
            let ray = Path { lane, origin, direction, share, range: 0.0, light: 1.0 };
            for (number, way) in [Way::Through, Way::Back].into_iter().enumerate() {
                let count = &mut self.counts[number];
                if let Some(path) = ray.after(&struck, shares, way)
                    && let Some(place) = self.paths[number].get_mut(*count)
                {
                    *place = path;
                    *count += 1;
                }
            }
        }
    }

    /// Follows the paths. From the second surface on, a ray continues in the way that more of the light takes. Returns
    /// the surfaces that scatter light back; those of one lane are not adjacent. Compiled once per level.
    #[inline(never)]
    pub(crate) fn look<S: Simd>(
        &mut self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        sight: &Sight,
        (moving, ways): (&mut MovingPacket, &mut Ways<'_>),
    ) -> &[Behind] {
        simd.vectorize(
            #[inline(always)]
            || {
                for way in 0..2 {
                    self.follow(simd, (view, resolver), sight, (moving, ways), way);
                }
            },
        );
        &self.found.as_flattened()[..self.found_count]
    }

    /// Follows the paths of one of the two ways to their ends.
    #[inline(always)]
    fn follow<S: Simd>(
        &mut self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        sight: &Sight,
        (moving, ways): (&mut MovingPacket, &mut Ways<'_>),
        way: usize,
    ) {
        let (paths, count) = (&mut self.paths[way], &mut self.counts[way]);
        let sight = Sight { range: [0.0, sight.range[1]], ..*sight };
        for surface in 1..=SURFACES {
            if *count == 0 {
                break;
            }
            moving.clear();
            for (lane, path) in paths[..*count].iter().enumerate() {
                let farthest = sight.range[1] - path.range;
                moving.set(lane, path.origin, path.direction, path.share, farthest);
            }
            moving.cast(simd, view, &sight, ways);
            let mut kept = 0;
            for lane in 0..*count {
                let path = paths[lane];
                let (Some(slot), Some(struck)) = (moving.slot(lane), moving.struck(view, resolver, lane))
                else {
                    continue;
                };
                let shares = Shares::of(view, struck.instance);
                if let Some(found) = self.found.as_flattened_mut().get_mut(self.found_count) {
                    let light = path.light * shares.scattered();
                    *found = behind(path.lane as usize, slot, &struck, (path.range, light));
                    self.found_count += 1;
                }
                let way = if shares.passed >= shares.reflected { Way::Through } else { Way::Back };
                if surface < SURFACES
                    && let Some(next) = path.after(&struck, shares, way)
                {
                    paths[kept] = next;
                    kept += 1;
                }
            }
            *count = kept;
        }
    }
}

/// The surfaces that the rays of a block of a grid see through panes and in mirrors.
pub(crate) struct Seen {
    /// The rays that hit a mirror or a pane, as one bit each; the other lanes are undefined.
    pub(crate) lanes: u16,
    /// Distances in metres, along the ray or along the optical axis.
    pub(crate) far: [f32; WIDTH],
    /// Slots; [`NO_HIT`] if no light comes back.
    pub(crate) slots: [u32; WIDTH],
    pub(crate) cosines: [f32; WIDTH],
}

impl Seen {
    /// Returns `met` with the distances of these lanes in their place.
    #[inline(always)]
    pub(crate) fn put_far<S: Simd>(&self, simd: S, met: f32x16<S>) -> f32x16<S> {
        let lanes = simd.from_bitmask_mask32x16(self.lanes.into());
        lanes.select(f32x16::load_array_ref(simd, &self.far), met)
    }

    /// Returns `met` with the cosines of incidence of these lanes in their place.
    #[inline(always)]
    pub(crate) fn put_cosines<S: Simd>(&self, simd: S, met: f32x16<S>) -> f32x16<S> {
        let lanes = simd.from_bitmask_mask32x16(self.lanes.into());
        lanes.select(f32x16::load_array_ref(simd, &self.cosines), met)
    }

    /// Returns `met` with the slots of these lanes in their place.
    pub(crate) fn put_slots(&mut self, met: &[u32; WIDTH]) -> &[u32; WIDTH] {
        for (lane, slot) in self.slots.iter_mut().enumerate() {
            if self.lanes >> lane & 1 == 0 {
                *slot = met[lane];
            }
        }
        &self.slots
    }
}

/// Follows the rays of a grid beyond mirrors and panes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glazing {
    /// The rotation from the sensor's axes to the world's.
    axes: DMat3,
}

/// The rays of a block that hit a mirror or a pane, as one bit each, with their unit directions in the world and their
/// ranges.
struct Glazed {
    lanes: u16,
    directions: [DVec3; WIDTH],
    farthest: [f64; WIDTH],
}

impl Glazing {
    /// Returns `None` if a scene has no mirrors and panes.
    pub(crate) fn of(view: &View<'_>) -> Option<Self> {
        let is_needed = view.scene.has_mirrors_or_panes();
        is_needed.then(|| Self { axes: view.world_from_sensor.rotation_matrix() })
    }

    /// The hits of a block, if any of its rays hits a mirror or a pane. For each ray, it is the hit from which most
    /// light would come back if all were equally far away; of two equal ones, the nearer.
    pub(crate) fn look<S: Simd, const DEPTH: bool>(
        self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        sight: &Sight,
        [column, row]: [usize; 2],
    ) -> Option<Seen> {
        let ray_grid = band.rays.ray_grid();
        let mut glazed = Glazed { lanes: 0, directions: [DVec3::X; WIDTH], farthest: [0.0; WIDTH] };
        let (mut forward, mut lengths) = ([1.0; WIDTH], [f64::INFINITY, 0.0]);
        for (lane, slot) in band.target.slot[block_index(band, [column, row])].iter().enumerate() {
            if *slot == NO_HIT || Shares::of(band.view, resolver.hit(*slot).instance.instance).is_matt() {
                continue;
            }
            let (x, y) = ray_grid.lane_position(lane);
            let ray = [(column << ray_grid.shift_x) + x, (row << ray_grid.shift_y) + y];
            let direction = band.rays.direction(ray[0] as i32, ray[1] as i32);
            let length = direction.length();
            let unit = direction / length;
            lengths = [lengths[0].min(length), lengths[1].max(length)];
            if DEPTH {
                forward[lane] = unit.x;
            }
            glazed.directions[lane] = self.axes * unit;
            glazed.farthest[lane] = sight.range[1] * length;
            glazed.lanes |= 1 << lane;
        }
        if glazed.lanes == 0 {
            return None;
        }
        // Convert from t of the grid to metres.
        let range = [0, 1].map(|end| sight.range[end] * lengths[end]);
        let sight = Sight { range, ..*sight };
        let mut room = band.room.borrow_mut();
        Some(see(simd, (band.view, resolver), &sight, (&glazed, &forward), room.first_mut()?))
    }
}

/// Follows the rays that hit mirrors or panes. It is a separate function because its scratch data takes 10 kB of stack.
#[inline(never)]
fn see<S: Simd>(
    simd: S,
    (view, resolver): (&View<'_>, &mut Resolver<'_>),
    sight: &Sight,
    (glazed, forward): (&Glazed, &[f64; WIDTH]),
    room: &mut SpecularScratch,
) -> Seen {
    let mut seen = Seen {
        lanes: glazed.lanes,
        far: [f32::INFINITY; WIDTH],
        slots: [NO_HIT; WIDTH],
        cosines: [1.0; WIDTH],
    };
    let mut first = const { MovingPacket::new() };
    let mut beyond = Beyond::new(&mut room.paths, &mut room.found);
    let mut ways = Ways::new(&mut room.moving);
    first.clear();
    for lane in (0..WIDTH).filter(|lane| glazed.lanes >> lane & 1 == 1) {
        first.set(lane, DVec3::ZERO, glazed.directions[lane], 0.0, glazed.farthest[lane]);
    }
    cast(simd, (&mut first, &mut ways), view, sight);
    let mut most = [0.0; WIDTH];
    let mut take = |behind: &Behind| {
        let lane = behind.lane();
        if behind.light > most[lane] {
            most[lane] = behind.light;
            seen.far[lane] = (behind.range * forward[lane]) as f32;
            seen.slots[lane] = behind.slot;
            seen.cosines[lane] = behind.cos_incidence.clamp(0.0, 1.0);
        }
    };
    for lane in 0..WIDTH {
        let Some(struck) = first.struck(view, resolver, lane) else { continue };
        let slot = first.slot(lane).unwrap_or(NO_HIT);
        let light = Shares::of(view, struck.instance).scattered();
        take(&behind(lane, slot, &struck, (0.0, light)));
    }
    beyond.set_out((view, resolver), &first);
    for behind in beyond.look(simd, (view, resolver), sight, (&mut first, &mut ways)) {
        take(behind);
    }
    seen
}

/// Casts a packet of moving rays. Compiled once per level.
#[inline(never)]
fn cast<S: Simd>(
    simd: S,
    (moving, ways): (&mut MovingPacket, &mut Ways<'_>),
    view: &View<'_>,
    sight: &Sight,
) {
    simd.vectorize(
        #[inline(always)]
        || moving.cast(simd, view, sight, ways),
    );
}

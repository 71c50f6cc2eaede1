//! What rays meet by way of mirrors and panes.

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

/// Rays begin this share of their way behind a surface, or before it: more than single precision loses of it.
const GAP: f64 = 1e-5;
/// Ways of which less light comes back are not followed.
const LEAST: f64 = 1e-6;

/// What a surface does with the light that meets it, in shares of it; the rest it scatters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares {
    reflected: f64,
    passed: f64,
}

impl Shares {
    /// Of an instance.
    #[inline(always)]
    pub(crate) fn of(view: &View<'_>, instance: u32) -> Self {
        let material = view.scene.instances[instance as usize].material;
        let material = &view.scene.materials[material as usize];
        Self { reflected: material.specular_reflectance.into(), passed: material.transmittance.into() }
    }

    /// Whether it scatters all of it.
    #[inline(always)]
    pub(crate) fn is_matt(self) -> bool {
        self.reflected == 0.0 && self.passed == 0.0
    }

    pub(crate) fn scattered(self) -> f64 {
        (1.0 - self.reflected - self.passed).max(0.0)
    }
}

/// How a ray goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    Through,
    Back,
}

impl Path {
    /// How it goes on where it has met a surface; none if too little of the light does.
    fn after(&self, struck: &MovingHit, shares: Shares, way: Way) -> Option<Self> {
        let part = if way == Way::Through { shares.passed } else { shares.reflected };
        // There and back.
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

/// What a ray has met after a way, of which so much of the light comes back.
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

/// Follows up to so many rays beyond what they have met.
pub(crate) struct Beyond<'m, const RAYS: usize> {
    paths: &'m mut Paths<RAYS>,
    counts: [usize; 2],
    found: &'m mut Found<RAYS>,
    found_count: usize,
}

impl<'m, const RAYS: usize> Beyond<'m, RAYS> {
    /// Room for the rays' ways and for what they meet, whatever is in it.
    pub(crate) fn new(paths: &'m mut Paths<RAYS>, found: &'m mut Found<RAYS>) -> Self {
        Self { paths, counts: [0; 2], found, found_count: 0 }
    }

    /// Takes the rays of a moving packet that was cast, of which no more than there is room for meet anything: their
    /// paths behind mirrors and panes. A ray goes on in both ways behind the first surface.
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

    /// Follows the rays that have set out, from the second surface on in that way which more of the light takes. What
    /// scatters light back is returned, that of a lane not in one piece. Compiled once a level.
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

    /// Follows the paths of one way to their ends.
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

/// What the rays of a block of a grid see by way of mirrors and panes.
pub(crate) struct Seen {
    /// Those that meet any, a bit each; of the others nothing is said.
    pub(crate) lanes: u16,
    /// Metres, along the ray or along the optical axis.
    pub(crate) far: [f32; WIDTH],
    /// [`NO_HIT`] where no light comes back.
    pub(crate) slots: [u32; WIDTH],
    pub(crate) cosines: [f32; WIDTH],
}

impl Seen {
    /// In the place of what the rays meet.
    #[inline(always)]
    pub(crate) fn put_far<S: Simd>(&self, simd: S, met: f32x16<S>) -> f32x16<S> {
        let lanes = simd.from_bitmask_mask32x16(self.lanes.into());
        lanes.select(f32x16::load_array_ref(simd, &self.far), met)
    }

    /// The same of cosines of incidence.
    #[inline(always)]
    pub(crate) fn put_cosines<S: Simd>(&self, simd: S, met: f32x16<S>) -> f32x16<S> {
        let lanes = simd.from_bitmask_mask32x16(self.lanes.into());
        lanes.select(f32x16::load_array_ref(simd, &self.cosines), met)
    }

    /// The same of slots.
    pub(crate) fn put_slots(&mut self, met: &[u32; WIDTH]) -> &[u32; WIDTH] {
        for (lane, slot) in self.slots.iter_mut().enumerate() {
            if self.lanes >> lane & 1 == 0 {
                *slot = met[lane];
            }
        }
        &self.slots
    }
}

/// Looks beyond mirrors and panes for a grid of rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Glazing {
    /// From the sensor's axes to the world's.
    axes: DMat3,
}

/// The rays of a block that meet a mirror or a pane: a bit each, and of those unit directions in the world, and how far
/// they reach.
struct Glazed {
    lanes: u16,
    directions: [DVec3; WIDTH],
    farthest: [f64; WIDTH],
}

impl Glazing {
    /// None if a scene has no mirrors and panes.
    pub(crate) fn of(view: &View<'_>) -> Option<Self> {
        let is_needed = view.scene.has_mirrors_or_panes();
        is_needed.then(|| Self { axes: view.world_from_sensor.rotation_matrix() })
    }

    /// What a block sees, if any of its rays meets such a surface: of each ray that from which most light comes back,
    /// were all as far away; of two alike, the nearer.
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
        // From t of the grid to metres.
        let range = [0, 1].map(|end| sight.range[end] * lengths[end]);
        let sight = Sight { range, ..*sight };
        let mut room = band.room.borrow_mut();
        Some(see(simd, (band.view, resolver), &sight, (&glazed, &forward), room.first_mut()?))
    }
}

/// What rays see that meet mirrors or panes. By itself, since what rays are followed with takes 10 kB of the stack.
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

/// Casts a packet of moving rays. Compiled once a level.
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

//! What rays meet by way of mirrors and panes.

use super::grid::{Band, Sight};
use super::hit_point::block_index;
use super::image::NO_HIT;
use super::resolve::Resolver;
use super::view::View;
use super::volley::{Struck, Volley};
use crate::simd::{LANES, WIDTH};
use fearless_simd::{Select, Simd, SimdBase, f32x16};
use glam::{DMat3, DVec3};

/// Surfaces that a ray meets one behind the other after the first, at the most.
const SURFACES: usize = 4;
/// Most that a ray meets: of a way through a surface and of one back from it.
pub(crate) const SURFACES_BEYOND: usize = 2 * SURFACES;
const MOST: usize = SURFACES_BEYOND * LANES;
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

/// A ray that goes on behind a surface.
#[derive(Clone, Copy)]
struct Path {
    /// Of the ray that it was at first.
    lane: usize,
    origin: DVec3,
    direction: DVec3,
    /// Its time, as a share of the way from the view's moment to the next one.
    share: f64,
    /// From where it was sent to its origin.
    range: f64,
    /// What of the light comes this way, there and back.
    light: f64,
}

impl Path {
    const NONE: Self =
        Self { lane: 0, origin: DVec3::ZERO, direction: DVec3::X, share: 0.0, range: 0.0, light: 0.0 };

    /// How it goes on where it has met a surface; none if too little of the light does.
    fn after(&self, struck: &Struck, shares: Shares, way: Way) -> Option<Self> {
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

/// A surface that scatters light back by way of others.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Behind {
    /// Of the ray.
    lane: u32,
    pub(crate) slot: u32,
    pub(crate) instance: u32,
    cos_incidence: f32,
    /// All the way.
    pub(crate) range: f64,
    /// What of the light it scatters and comes back.
    pub(crate) light: f64,
}

impl Behind {
    const NONE: Self =
        Self { lane: 0, slot: NO_HIT, instance: 0, cos_incidence: 1.0, range: f64::INFINITY, light: 0.0 };

    /// Of a ray that has met it after a way, of which so much of the light comes back.
    fn new(lane: usize, slot: u32, struck: &Struck, (way, light): (f64, f64)) -> Self {
        Self {
            lane: lane as u32,
            slot,
            instance: struck.instance,
            cos_incidence: struck.cos_incidence as f32,
            range: way + struck.range,
            light,
        }
    }

    /// Which ray it is of.
    pub(crate) fn lane(&self) -> usize {
        self.lane as usize
    }

    pub(crate) fn cos_incidence(&self) -> f64 {
        self.cos_incidence.into()
    }
}

/// Follows rays beyond what they have met.
pub(crate) struct Beyond {
    volley: Volley,
    paths: [Path; LANES],
    count: usize,
    found: [Behind; MOST],
    found_count: usize,
}

impl Beyond {
    pub(crate) const fn new() -> Self {
        Self {
            volley: Volley::new(),
            paths: [Path::NONE; LANES],
            count: 0,
            found: [Behind::NONE; MOST],
            found_count: 0,
        }
    }

    /// Follows the rays of a volley that was cast, beyond mirrors and panes. A ray goes on in both ways behind the first surface,
    /// and from then on in that which more of the light takes. What scatters light back is returned, that of a lane not in
    /// one piece. Compiled once a level.
    #[inline(never)]
    pub(crate) fn look<S: Simd>(
        &mut self,
        simd: S,
        (view, resolver): (&View<'_>, &mut Resolver<'_>),
        sight: &Sight,
        first: &Volley,
    ) -> &[Behind] {
        self.found_count = 0;
        simd.vectorize(
            #[inline(always)]
            || {
                for way in [Way::Through, Way::Back] {
                    self.set_out((view, resolver), first, way);
                    self.follow(simd, (view, resolver), sight);
                }
            },
        );
        &self.found[..self.found_count]
    }

    /// The paths of one way behind the first surfaces.
    fn set_out(&mut self, (view, resolver): (&View<'_>, &mut Resolver<'_>), first: &Volley, way: Way) {
        self.count = 0;
        for lane in 0..LANES {
            let Some(slot) = first.slot(lane) else { continue };
            let shares = Shares::of(view, resolver.hit(slot).instance.instance);
            if shares.is_matt() {
                continue;
            }
            let Some(struck) = first.struck(view, resolver, lane) else { continue };
            let [origin, direction] = first.ray(lane);
            let ray = Path { lane, origin, direction, share: first.share(lane), range: 0.0, light: 1.0 };
            if let Some(path) = ray.after(&struck, shares, way) {
                self.paths[self.count] = path;
                self.count += 1;
            }
        }
    }

    /// Follows the paths to their ends.
    #[inline(always)]
    fn follow<S: Simd>(&mut self, simd: S, (view, resolver): (&View<'_>, &mut Resolver<'_>), sight: &Sight) {
        let sight = Sight { range: [0.0, sight.range[1]], ..*sight };
        for surface in 1..=SURFACES {
            if self.count == 0 {
                break;
            }
            self.volley.clear();
            for (lane, path) in self.paths[..self.count].iter().enumerate() {
                let farthest = sight.range[1] - path.range;
                self.volley.set(lane, path.origin, path.direction, path.share, farthest);
            }
            self.volley.cast(simd, view, &sight);
            let mut kept = 0;
            for lane in 0..self.count {
                let path = self.paths[lane];
                let (Some(slot), Some(struck)) =
                    (self.volley.slot(lane), self.volley.struck(view, resolver, lane))
                else {
                    continue;
                };
                let shares = Shares::of(view, struck.instance);
                if let Some(found) = self.found.get_mut(self.found_count) {
                    let light = path.light * shares.scattered();
                    *found = Behind::new(path.lane, slot, &struck, (path.range, light));
                    self.found_count += 1;
                }
                let way = if shares.passed >= shares.reflected { Way::Through } else { Way::Back };
                if surface < SURFACES
                    && let Some(next) = path.after(&struck, shares, way)
                {
                    self.paths[kept] = next;
                    kept += 1;
                }
            }
            self.count = kept;
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

    /// What a block sees, if any of its rays meets such a surface: of each ray that from which most light comes back, were all as
    /// far away; of two alike, the nearer.
    pub(crate) fn look<S: Simd, const DEPTH: bool>(
        self,
        simd: S,
        band: &Band<'_>,
        resolver: &mut Resolver<'_>,
        sight: &Sight,
        [column, row]: [usize; 2],
    ) -> Option<Seen> {
        let fan = band.rays.fan();
        let mut glazed = Glazed { lanes: 0, directions: [DVec3::X; WIDTH], farthest: [0.0; WIDTH] };
        let (mut forward, mut lengths) = ([1.0; WIDTH], [f64::INFINITY, 0.0]);
        for (lane, slot) in band.target.slot[block_index(band, [column, row])].iter().enumerate() {
            if *slot == NO_HIT || Shares::of(band.view, resolver.hit(*slot).instance.instance).is_matt() {
                continue;
            }
            let (x, y) = fan.lane_position(lane);
            let ray = [(column << fan.shift_x) + x, (row << fan.shift_y) + y];
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
        Some(see(simd, (band.view, resolver), &sight, &glazed, &forward))
    }
}

/// What rays see that meet mirrors or panes. By itself, since what rays are followed with takes some 400 KB of the stack:
/// more than is left to a thread that waits for others in the middle of a band.
#[inline(never)]
fn see<S: Simd>(
    simd: S,
    (view, resolver): (&View<'_>, &mut Resolver<'_>),
    sight: &Sight,
    glazed: &Glazed,
    forward: &[f64; WIDTH],
) -> Seen {
    let mut seen = Seen {
        lanes: glazed.lanes,
        far: [f32::INFINITY; WIDTH],
        slots: [NO_HIT; WIDTH],
        cosines: [1.0; WIDTH],
    };
    let mut first = Volley::new();
    let mut beyond = Beyond::new();
    first.clear();
    for lane in (0..WIDTH).filter(|lane| glazed.lanes >> lane & 1 == 1) {
        first.set(lane, DVec3::ZERO, glazed.directions[lane], 0.0, glazed.farthest[lane]);
    }
    cast(simd, &mut first, view, sight);
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
        take(&Behind::new(lane, slot, &struck, (0.0, light)));
    }
    for behind in beyond.look(simd, (view, resolver), sight, &first) {
        take(behind);
    }
    seen
}

/// Casts a volley. Compiled once a level.
#[inline(never)]
fn cast<S: Simd>(simd: S, volley: &mut Volley, view: &View<'_>, sight: &Sight) {
    simd.vectorize(
        #[inline(always)]
        || volley.cast(simd, view, sight),
    );
}

//! Every scene with every ray set.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use crate::scenes::{RAYS, RaySet, Scene, ours, peer};
use belvedere_sensors::simd::Level;

/// parry3d casts about as many rays of a set a call; their rate is what counts.
const PEER_RAYS: usize = 30_000;

/// Measures the ray sets of a scene.
pub fn run(gate: &mut Gate<'_>, scene: &str, level: Level) {
    if !RAYS.iter().any(|rays| gate.options.wants(scene, rays)) {
        return;
    }
    let scene = &Scene::new(scene);
    let ours = ours::Built::new(&scene.mesh);
    let theirs = peer::Built::new(&scene.mesh);
    for name in RAYS.into_iter().filter(|rays| gate.options.wants(scene.name, rays)) {
        let rays = RaySet::new(name, scene);
        let Some(mut caster) = ours::Caster::new(&rays, ours::execution(level), ours::Wanted::All) else {
            continue;
        };
        let chosen = chosen(&rays);
        let mut distances = Vec::with_capacity(chosen.len());
        let entry =
            Entry { group: scene.name, name, unit: Unit::Rate, peer: "parry3d", clock: Clock::Thread };
        gate.run(
            entry,
            (&mut || caster.cast(&ours), rays.len() as f64),
            (&mut || theirs.cast(&rays, chosen.iter().copied(), &mut distances), chosen.len() as f64),
        );
    }
}

/// A part of the set that looks like the whole: rows spread evenly over it, or its beginning if it has no rows.
fn chosen(rays: &RaySet) -> Vec<usize> {
    let rows = (PEER_RAYS / rays.width).clamp(1, rays.height);
    let row_rays = rays.width.min(PEER_RAYS);
    let row = |index: usize| (2 * index + 1) * rays.height / (2 * rows);
    (0..rows).flat_map(|index| row(index) * rays.width..row(index) * rays.width + row_rays).collect()
}

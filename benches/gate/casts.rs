//! Every scene with every ray set.

use super::clock::Clock;
use super::gate::{Entry, Gate, Unit};
use crate::scenes::{RAYS, RaySet, Scene, ours, peer};
use belvedere_sensors::Execution;
use belvedere_sensors::simd::Level;
use std::hint::black_box;

/// About the number of rays of a set that parry3d casts per call; only the rate matters.
const PEER_RAYS: usize = 30_000;
/// The number of rays of `R5` that Belvedere casts; the rate is that of the full million.
const OUR_RANDOM_RAYS: usize = 100_000;

/// Measures the ray sets of a scene.
pub fn run(gate: &mut Gate<'_>, scene: &str, level: Level) -> Result<(), String> {
    if !RAYS.iter().any(|rays| gate.options.wants(scene, rays)) {
        return Ok(());
    }
    let scene = &Scene::new(scene);
    let ours = ours::Built::new(&scene.mesh);
    let theirs = peer::Built::new(&scene.mesh);
    for name in RAYS.into_iter().filter(|rays| gate.options.wants(scene.name, rays)) {
        let rays = RaySet::new(name, scene).first(OUR_RANDOM_RAYS);
        let mut caster = ours::Caster::new(&rays, Execution::at(level), ours::Wanted::All);
        let chosen = chosen(&rays);
        let mut distances = Vec::with_capacity(chosen.len());
        let entry =
            Entry { group: scene.name, name, unit: Unit::Rate, peer: "parry3d", clock: Clock::Thread };
        gate.run(
            entry,
            (
                &mut || {
                    black_box(caster.cast(&ours));
                },
                rays.len() as f64,
            ),
            (&mut || theirs.cast(&rays, chosen.iter().copied(), &mut distances), chosen.len() as f64),
        );
        check(&entry, caster.cast(&ours), &distances, &chosen)?;
    }
    Ok(())
}

/// The fraction of the rays about which two casters may disagree: those that pass within a rounding error of an edge.
const DISAGREEMENT: f64 = 2e-3;

/// Checks that both sides give the same distances.
fn check(entry: &Entry<'_>, ours: &[f32], theirs: &[f32], chosen: &[usize]) -> Result<(), String> {
    let differ = |ours: f32, theirs: f32| match (ours.is_finite(), theirs.is_finite()) {
        (true, true) => (ours - theirs).abs() > 1e-3 * theirs.max(1.0),
        (ours, theirs) => ours != theirs,
    };
    let different = chosen.iter().zip(theirs).filter(|&(&ray, &theirs)| differ(ours[ray], theirs)).count();
    if different as f64 > DISAGREEMENT * chosen.len() as f64 {
        let Entry { group, name, .. } = entry;
        return Err(format!(
            "{group}/{name}: {different} of {} rays do not meet what parry3d's do",
            chosen.len()
        ));
    }
    Ok(())
}

/// Returns a representative part of the set: rows spread evenly over it, or its beginning if it has no rows.
fn chosen(rays: &RaySet) -> Vec<usize> {
    let rows = (PEER_RAYS / rays.width).clamp(1, rays.height);
    let row_rays = rays.width.min(PEER_RAYS);
    let row = |index: usize| (2 * index + 1) * rays.height / (2 * rows);
    (0..rows).flat_map(|index| row(index) * rays.width..row(index) * rays.width + row_rays).collect()
}

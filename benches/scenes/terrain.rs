//! S4: hills with small stones.

use super::Scene;
use super::noise::octaves;
use super::solids::Solids;
use glam::DVec3;

const CELLS: u32 = 500;
const SIZE_M: f64 = 100.0;

pub fn terrain() -> Scene {
    let mut solids = Solids::default();
    let step = SIZE_M / f64::from(CELLS);
    solids.grid(CELLS, false, |i, j| {
        let [x, y] = [i as f64 * step, j as f64 * step];
        DVec3::new(x, y, height(x, y))
    });
    let eye = height(50.0, 50.0) + 1.5;
    Scene::finish("S4", 104, solids, [50.05, 50.07, eye], [0.7, -0.10])
}

fn height(x: f64, y: f64) -> f64 {
    let place = DVec3::new(x, y, 0.0);
    5.0 * octaves(place / 28.0 + 5.0, 4, 21, 0.45) + 0.12 * octaves(place / 1.7 + 60.0, 3, 22, 0.5)
}

//! S3: a ball whose surface is rough at three scales, over a ground of wide triangles.

use super::Scene;
use super::noise::octaves;
use super::solids::Solids;
use core::f64::consts::PI;
use glam::DVec3;

/// Cells along an edge of each face of the cube that is projected onto the ball.
const CELLS: u32 = 288;
const GROUND_CELLS: u32 = 32;

pub fn blob() -> Scene {
    let mut solids = Solids::default();
    let edge: Vec<f64> =
        (0..=CELLS).map(|i| libm::tan((f64::from(i) / f64::from(CELLS) * 2.0 - 1.0) * PI / 4.0)).collect();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            solids.grid(CELLS, side < 0.0, |i, j| {
                let mut on_cube = DVec3::ZERO;
                on_cube[axis] = side;
                on_cube[(axis + 1) % 3] = edge[i];
                on_cube[(axis + 2) % 3] = edge[j];
                rough(on_cube)
            });
        }
    }
    let step = 80.0 / f64::from(GROUND_CELLS);
    solids.grid(GROUND_CELLS, false, |i, j| DVec3::new(i as f64 * step - 40.0, j as f64 * step - 40.0, 0.0));
    let mut scene = Scene::finish("S3", 103, solids, [-5.6, -0.9, 2.2], [0.16, 0.02]);
    // Around the ball, not over the distant ground.
    scene.inside = [DVec3::new(-6.0, -6.0, 0.0), DVec3::new(6.0, 6.0, 8.0)];
    scene
}

fn rough(on_cube: DVec3) -> DVec3 {
    let direction = on_cube / on_cube.dot(on_cube).sqrt();
    // Quantised, so that adjacent faces of the cube have the same points on their common edges.
    let key = DVec3::from_array(direction.to_array().map(|x| (x * 1e6).round_ties_even() / 1e6));
    let height = 0.55 * octaves(key * 2.0 + 40.0, 3, 11, 0.5)
        + 0.16 * octaves(key * 18.0 + 90.0, 3, 12, 0.5).abs()
        + 0.045 * octaves(key * 110.0 + 300.0, 2, 13, 0.5);
    direction * (3.0 + height) + DVec3::new(0.0, 0.0, 3.2)
}

//! S1: a room with ten boxes and ten cylinders.

use super::Scene;
use super::random::Random;
use super::solids::Solids;

#[allow(clippy::approx_constant, reason = "not π: what the scene was first made with")]
const MOST_YAW_RAD: f64 = 3.14;

pub fn room() -> Scene {
    let (mut solids, mut random) = (Solids::default(), Random::new(1));
    let wall = 0.1;
    for (centre, half) in [
        ([5.0, 4.0, -wall], [5.0, 4.0, wall]),
        ([5.0, 4.0, 3.0 + wall], [5.0, 4.0, wall]),
        ([-wall, 4.0, 1.5], [wall, 4.0, 1.5]),
        ([10.0 + wall, 4.0, 1.5], [wall, 4.0, 1.5]),
        ([5.0, -wall, 1.5], [5.0, wall, 1.5]),
        ([5.0, 8.0 + wall, 1.5], [5.0, wall, 1.5]),
    ] {
        solids.cuboid(centre, half, 0.0);
    }
    let mut things = 0;
    while things < 20 {
        let [x, y] = [random.range(0.8, 9.2), random.range(0.8, 7.2)];
        let [dx, dy] = [x - 5.0, y - 4.0];
        if (dx * dx + dy * dy).sqrt() < 1.1 {
            continue; // too near to the sensor
        }
        if things % 2 == 0 {
            let half = [random.range(0.15, 0.5), random.range(0.15, 0.5), random.range(0.2, 0.9)];
            solids.cuboid([x, y, half[2]], half, random.range(0.0, MOST_YAW_RAD));
        } else {
            let half_height = random.range(0.3, 1.4);
            solids.cylinder([x, y, half_height], random.range(0.12, 0.35), half_height, 48);
        }
        things += 1;
    }
    Scene::finish("S1", 101, solids, [5.0, 4.0, 0.6], [0.5, -0.08])
}

//! S2: a hall with ten rows of racks.

use super::Scene;
use super::random::Random;
use super::solids::Solids;

pub fn warehouse() -> Scene {
    let (mut solids, mut random) = (Solids::default(), Random::new(2));
    let [length, width, height] = [62.0, 42.0, 9.0];
    let wall = 0.2;
    for (centre, half) in [
        ([length / 2.0, width / 2.0, -wall], [length / 2.0, width / 2.0, wall]),
        ([length / 2.0, width / 2.0, height + wall], [length / 2.0, width / 2.0, wall]),
        ([-wall, width / 2.0, height / 2.0], [wall, width / 2.0, height / 2.0]),
        ([length + wall, width / 2.0, height / 2.0], [wall, width / 2.0, height / 2.0]),
        ([length / 2.0, -wall, height / 2.0], [length / 2.0, wall, height / 2.0]),
        ([length / 2.0, width + wall, height / 2.0], [length / 2.0, wall, height / 2.0]),
    ] {
        solids.cuboid(centre, half, 0.0);
    }
    for row in 0..10 {
        let y = 3.0 + f64::from(row) * 4.0;
        for bay in 0..20 {
            rack(&mut solids, &mut random, 3.0 + f64::from(bay) * 2.8, y);
        }
    }
    // Pallets and columns at the ends of the aisles.
    for _ in 0..60 {
        let centre = [random.range(0.4, 2.4), random.range(0.5, width - 0.5), 0.4];
        solids.cuboid(centre, [0.3, 0.3, 0.4], random.range(0.0, 3.0));
    }
    Scene::finish("S2", 102, solids, [14.3, 21.0 + 2.1, 1.1], [0.12, 0.05])
}

fn rack(solids: &mut Solids, random: &mut Random, x: f64, y: f64) {
    for dx in [0.0, 2.6] {
        for dy in [-0.55, 0.55] {
            solids.cuboid([x + dx, y + dy, 3.7], [0.05, 0.05, 3.7], 0.0);
        }
    }
    for level in 0..6 {
        let z = 0.2 + f64::from(level) * 1.4;
        solids.cuboid([x + 1.3, y, z], [1.3, 0.6, 0.03], 0.0);
        for slot in 0..6 {
            if random.unit() < 0.12 {
                continue; // an empty place
            }
            let half = [random.range(0.10, 0.19), random.range(0.2, 0.52), random.range(0.12, 0.62)];
            let along = x + 0.25 + f64::from(slot) * 0.42;
            let centre = [along, y + random.range(-0.05, 0.05), z + 0.03 + half[2]];
            solids.cuboid(centre, half, random.range(-0.06, 0.06));
        }
    }
}

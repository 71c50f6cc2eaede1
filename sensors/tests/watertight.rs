//! No ray slips between the triangles of a closed mesh.

mod common;

use belvedere_sensors::Pose;
use belvedere_sensors::lidar::{Beams, LidarConfig};
use belvedere_sensors::scene::{SceneBuilder, Shape};
use common::{LIDAR, add_grey, scan};
use core::f64::consts::{FRAC_PI_2, PI};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// An octahedron whose faces are cut in four `rounds` times, on the unit ball.
fn geosphere(rounds: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let mut corners = vec![Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let mut triangles =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..rounds {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                corners.push((corners[a as usize] + corners[b as usize]).normalize());
                corners.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (corners.into_iter().map(|corner| corner.to_array()).collect(), triangles)
}

#[test]
fn no_ray_escapes() {
    let (corners, triangles) = geosphere(5);
    assert_eq!(triangles.len(), 8192);
    let mut builder = SceneBuilder::new();
    let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
    let all_round = LidarConfig {
        horizontal: Beams { samples: 801, min_angle_rad: -PI, max_angle_rad: PI },
        vertical: Beams { samples: 401, min_angle_rad: -FRAC_PI_2, max_angle_rad: FRAC_PI_2 },
        range_min_m: 0.0,
        ..LIDAR
    };
    let turned = Pose::from_xyz_rpy(DVec3::new(3.0, -1.0, 2.0), DVec3::new(0.3, 0.7, -1.9));
    let ball = add_grey(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY);
    for (world_from_ball, place) in [
        // From the middle of an upright ball many beams run right along edges and into corners.
        (Pose::IDENTITY, DVec3::ZERO),
        (Pose::IDENTITY, DVec3::new(0.1, 0.0, 0.0)),
        (turned, DVec3::ZERO),
        (turned, DVec3::new(-0.3, 0.5, 0.2)),
    ] {
        builder.set_pose(ball, world_from_ball).unwrap();
        let pose = world_from_ball * Pose::from_translation(place);
        let (ranges, _) = scan(&builder.scene(), all_round, pose);
        let (nearest, farthest) = (0.99 - place.length(), 1.01 + place.length());
        for (beam, &range) in ranges.iter().enumerate() {
            let (line, column) = (beam / 801, beam % 801);
            let inside = (nearest..farthest).contains(&f64::from(range));
            assert!(inside, "beam {column} of line {line} from {place}: {range}");
        }
    }
}

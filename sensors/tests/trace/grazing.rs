//! Rays that run nearly along triangles.

use crate::common::add_grey;
use crate::common::exactness::Dice;
use belvedere_sensors::Pose;
use belvedere_sensors::optics::{Lens, Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use glam::{DVec3, Vec3};

#[test]
fn a_hit_lies_between_the_corners_of_its_triangle() {
    let mut dice = Dice(3);
    let (mut hits, mut behind, mut worst) = (0, 0, 0.0_f64);
    for round in 0..400 {
        // Small triangles in a plane through the sensor, or near it, at any distance.
        let normal = dice.cube().normalize();
        let (u, v) = normal.any_orthonormal_pair();
        let above = [0.0, 1e-9, 1e-7, 1e-5][round % 4];
        let mut corners = Vec::new();
        for _ in 0..60 {
            let way = 0.2 + 20.0 * dice.roll();
            let turn = dice.roll() * 6.3;
            let centre = (u * turn.cos() + v * turn.sin()) * way + normal * (above * way);
            let size = way * [0.01, 0.1, 0.5][round % 3];
            for _ in 0..3 {
                let beside = dice.cube() * size;
                corners.push((centre + beside - normal * beside.dot(normal)).as_vec3().to_array());
            }
        }
        let triangles: Vec<[u32; 3]> = (0..60).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mut builder = SceneBuilder::new();
        let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
        add_grey(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY);
        let scene = builder.scene();
        // Rays in the plane, whose normal is the sensor's z.
        let pose = Pose::new(DVec3::ZERO, glam::DQuat::from_rotation_arc(DVec3::Z, normal));
        let step = 0.01;
        let lidar = SphericalGrid {
            columns: 628,
            rows: 3,
            first_azimuth_rad: -3.1,
            azimuth_step_rad: step,
            first_elevation_rad: -3e-8,
            elevation_step_rad: 3e-8,
        };
        let lens = PinholeGrid::from_fov(301, 3, 1.5).unwrap();
        for grid in [Optics::Spherical(lidar), Optics::Pinhole(lens)] {
            let rays = grid.size()[0] * grid.size()[1];
            let (mut distance, mut primitive) = (vec![f32::NAN; rays], vec![7; rays]);
            let mut workspace = WorkspaceBuf::default();
            let mut workspace = workspace.lend(grid_workspace_len(&scene, &grid));
            let outputs =
                Hits { distance: Some(&mut distance), primitive: Some(&mut primitive), ..Hits::default() };
            let range = [1e-3, 1e3];
            cast_grid(
                &scene,
                &builder.moment(pose),
                &grid,
                range,
                VISUAL,
                Faces::Both,
                &mut workspace,
                outputs,
            )
            .unwrap();
            for ray in 0..rays {
                if !distance[ray].is_finite() {
                    continue;
                }
                let (column, row) = ((ray % grid.size()[0]) as f64, (ray / grid.size()[0]) as f64);
                let direction = if let Optics::Spherical(_) = grid {
                    let (sin, cos) = (-3.1 + column * step).sin_cos();
                    let (up, level) = (-3e-8 + row * 3e-8_f64).sin_cos();
                    DVec3::new(cos * level, sin * level, up)
                } else {
                    let optical = lens.lens().unproject(glam::DVec2::new(column, row)).unwrap();
                    DVec3::new(optical.z, -optical.x, -optical.y)
                };
                let direction = pose.rotation() * direction;
                let along = triangles[primitive[ray] as usize]
                    .map(|corner| Vec3::from_array(corners[corner as usize]).as_dvec3().dot(direction));
                let least = along.into_iter().fold(f64::INFINITY, f64::min);
                let most = along.into_iter().fold(f64::NEG_INFINITY, f64::max);
                if most <= 0.0 {
                    // In single precision, such a triangle seems to be ahead.
                    behind += 1;
                    continue;
                }
                let t = f64::from(distance[ray]);
                let beyond = ((least - t) / t).max((t - most) / t);
                hits += 1;
                worst = worst.max(beyond);
                assert!(
                    beyond < 1e-6,
                    "{t} m, and the triangle lies from {least} to {most} m, round {round}, {grid:?}, {column}, {row}"
                );
            }
        }
    }
    println!(
        "{hits} hits, {behind} on triangles behind the sensor, {worst:e} beyond their triangles at most"
    );
    assert!(hits > 1000, "{hits}");
}

//! No ray slips between the triangles of a closed mesh.
//!
//! Two million rays, or with `BELVEDERE_FULL=1` in the environment a hundred million, for release builds.

use crate::common::exactness::{Dice, geosphere};
use crate::common::random::is_full;
use crate::common::{LIDAR, add_grey, scan};
use belvedere_sensors::Pose;
use belvedere_sensors::lidar::Beams;
use belvedere_sensors::optics::{Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::rays::{Rays, cast_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;

#[test]
fn no_beam_of_a_lidar_escapes() {
    let (corners, triangles) = geosphere(5);
    assert_eq!(triangles.len(), 8192);
    let mut builder = SceneBuilder::new();
    let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
    let all_round = LIDAR
        .horizontal(Beams { samples: 801, min_angle_rad: -PI, max_angle_rad: PI })
        .vertical(Beams { samples: 401, min_angle_rad: -FRAC_PI_2, max_angle_rad: FRAC_PI_2 })
        .range_min_m(0.0);
    let turned = Pose::from_xyz_rpy(DVec3::new(3.0, -1.0, 2.0), DVec3::new(0.3, 0.7, -1.9));
    let ball = add_grey(&mut builder, Shape::Mesh(mesh), Pose::IDENTITY);
    for (world_from_ball, place) in [
        // From the centre of an upright ball, many beams run exactly along edges and into corners.
        (Pose::IDENTITY, DVec3::ZERO),
        (Pose::IDENTITY, DVec3::new(0.1, 0.0, 0.0)),
        (turned, DVec3::ZERO),
        (turned, DVec3::new(-0.3, 0.5, 0.2)),
    ] {
        builder.set_pose(ball, world_from_ball).unwrap();
        let pose = world_from_ball * Pose::from_translation(place);
        let (ranges, _) = scan(&builder, all_round, pose);
        let (nearest, farthest) = (0.99 - place.length(), 1.01 + place.length());
        for (beam, &range) in ranges.iter().enumerate() {
            let (line, column) = (beam / 801, beam % 801);
            let inside = (nearest..farthest).contains(&f64::from(range));
            assert!(inside, "beam {column} of line {line} from {place}: {range}");
        }
    }
}

/// The total number of rays to cast.
fn wanted() -> usize {
    if is_full() { 100_000_000 } else { 2_000_000 }
}

/// Origins within half the radius of the ball: its centre, points on its axes and planes of symmetry, where rays run
/// along edges and into corners, and random points.
fn place(dice: &mut Dice, index: usize) -> DVec3 {
    let at = dice.cube() * 0.28;
    match index % 8 {
        0 => DVec3::ZERO,
        1 => DVec3::X * at.x,
        2 => DVec3::Y * at.y,
        3 => DVec3::Z * at.z,
        4 => DVec3::new(at.x, at.x, 0.0),
        5 => DVec3::new(0.25, -0.125, 0.0625),
        _ => at,
    }
}

/// The ball in several sizes and positions.
fn balls() -> Vec<(SceneBuilder, Pose, f64)> {
    let mut all = Vec::new();
    for (rounds, size, pose) in [
        (2, 1.0, Pose::IDENTITY),
        (5, 1.0, Pose::IDENTITY),
        (4, 1.0, Pose::from_xyz_rpy(DVec3::new(3.0, -1.0, 2.0), DVec3::new(0.3, 0.7, -1.9))),
        (3, 1e4, Pose::from_translation(DVec3::new(1e5, 1e5, 0.0))),
        (3, 1e-6, Pose::IDENTITY),
    ] {
        let (corners, triangles) = geosphere(rounds);
        let corners: Vec<_> = corners.iter().map(|corner| corner.map(|x| x * size as f32)).collect();
        let mut builder = SceneBuilder::new();
        let mesh = builder.add_mesh(&corners, &[], &triangles).unwrap();
        add_grey(&mut builder, Shape::Mesh(mesh), pose);
        all.push((builder, pose, size));
    }
    all
}

fn all_inside(what: &str, distances: &[f32], size: f64) {
    for (ray, &distance) in distances.iter().enumerate() {
        // In a pinhole, the direction of a ray is longer than 1; its distance is measured along it nevertheless.
        let inside = (0.3 * size..1.6 * size).contains(&f64::from(distance));
        assert!(inside, "{what}, ray {ray}: {distance} in a ball of {size} m");
    }
}

fn cast_a_grid(
    builder: &SceneBuilder,
    pose: &Pose,
    grid: &Optics,
    size: f64,
    workspace: &mut WorkspaceBuf,
) -> usize {
    let [width, height] = grid.size();
    let mut distance = vec![0.0; width * height];
    let hits = Hits { distance: Some(&mut distance), ..Hits::default() };
    let scene = builder.scene();
    let mut workspace = workspace.lend(grid_workspace_len(&scene, grid));
    let range = [1e-9, f64::INFINITY];
    cast_grid(&scene, &builder.moment(*pose), grid, range, VISUAL, Faces::Both, &mut workspace, hits)
        .unwrap();
    all_inside(&format!("{grid:?} at {pose:?}"), &distance, size);
    distance.len()
}

#[test]
fn no_ray_of_a_grid_escapes() {
    let mut dice = Dice(1);
    let mut workspace = WorkspaceBuf::default();
    let mut cast = 0;
    let balls = balls();
    for index in 0.. {
        let (builder, world_from_ball, size) = &balls[index % balls.len()];
        let turn = if index % 3 == 0 { DVec3::ZERO } else { dice.turn() };
        let pose = *world_from_ball * Pose::from_xyz_rpy(place(&mut dice, index) * *size, turn);
        let sphere = |columns, rows, step: f64| {
            Optics::Spherical(SphericalGrid {
                columns,
                rows,
                first_azimuth_rad: -PI,
                azimuth_step_rad: step,
                first_elevation_rad: -FRAC_PI_2,
                elevation_step_rad: PI / f64::from(rows - 1),
            })
        };
        let grid = match index % 4 {
            0 => Optics::Pinhole(PinholeGrid::from_fov(256, 256, 2.0).unwrap()),
            // A full ring, then an arc that ends where it begins, then lines of single beams.
            1 => sphere(512, 129, TAU / 512.0),
            2 => sphere(257, 181, TAU / 256.0),
            _ => sphere(2048, 17, TAU / 2048.0),
        };
        cast += cast_a_grid(builder, &pose, &grid, *size, &mut workspace);
        if cast >= wanted() / 2 {
            break;
        }
    }
    println!("{cast} rays of grids, none escaped");
}

#[test]
fn no_single_ray_escapes() {
    const BATCH: usize = 50_000;
    let mut dice = Dice(2);
    let mut workspace = WorkspaceBuf::default();
    let mut cast = 0;
    let balls = balls();
    let corners = geosphere(2).0;
    for index in 0.. {
        let (builder, world_from_ball, size) = &balls[index % balls.len()];
        let scene = builder.scene();
        let reference = world_from_ball.translation();
        let (mut origins, mut directions) = (Vec::new(), Vec::new());
        for ray in 0..BATCH {
            let origin = place(&mut dice, ray) * *size;
            // One ray in four is aimed exactly at a corner of the coarsest ball, which all balls have.
            let direction = match ray % 4 {
                0 => {
                    let [x, y, z] = corners[ray / 4 % corners.len()].map(f64::from);
                    world_from_ball.rotation() * (DVec3::new(x, y, z) * *size) - origin
                }
                1 => [DVec3::X, DVec3::NEG_Y, DVec3::Z][ray / 4 % 3],
                _ => dice.cube() + DVec3::splat(1e-9),
            };
            origins.push(origin.as_vec3().to_array());
            directions.push(direction.normalize().as_vec3().to_array());
        }
        let mut distance = vec![0.0; BATCH];
        let hits = Hits { distance: Some(&mut distance), ..Hits::default() };
        let rays = Rays { origins: &origins, directions: &directions, ranges: None };
        cast_rays(
            &scene,
            builder.poses(),
            reference,
            &rays,
            VISUAL,
            Faces::Both,
            &mut workspace.lend(workspace_len(&scene)),
            hits,
        )
        .expect("outputs of the right size");
        all_inside(&format!("batch {index}"), &distance, *size);
        cast += BATCH;
        if cast >= wanted() / 2 {
            break;
        }
    }
    println!("{cast} single rays, none escaped");
}

//! Every ray against a scalar oracle in f64, over scenes that are hard to trace.

use crate::common::adversary;
use crate::common::brute::{Pair, Tally};
use crate::common::casts::{cast, cast_each};
use crate::common::exactness::{Dice, Scenario, scenarios, stands};
use belvedere_sensors::optics::{Lens, Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::trace::Faces;
use belvedere_sensors::trace::rays::Rays;
use belvedere_sensors::{Execution, Pose};
use core::f64::consts::{FRAC_PI_2, TAU};
use glam::{DVec2, DVec3};

/// A camera, a lidar with a full ring, and one with poles and single steps.
fn grids() -> [Optics<'static>; 3] {
    let spherical = |columns, rows, azimuth: [f64; 2], elevation: [f64; 2]| {
        Optics::Spherical(SphericalGrid {
            columns,
            rows,
            first_azimuth_rad: azimuth[0],
            azimuth_step_rad: azimuth[1],
            first_elevation_rad: elevation[0],
            elevation_step_rad: elevation[1],
        })
    };
    [
        Optics::Pinhole(PinholeGrid::from_fov(71, 53, 1.5).unwrap()),
        spherical(96, 33, [-3.0, TAU / 96.0], [FRAC_PI_2, -FRAC_PI_2 / 16.0]),
        spherical(250, 5, [1.0, -0.013], [-0.4, 0.17]),
    ]
}

/// The direction of a ray as documented for the grids, in the axes of the sensor.
fn direction(grid: &Optics, column: usize, row: usize) -> DVec3 {
    let (column, row) = (column as f64, row as f64);
    match grid {
        Optics::Pinhole(lens) => {
            // With length 1 along the axis, because t is the depth.
            let optical = lens.lens().unproject(DVec2::new(column, row)).unwrap();
            DVec3::new(1.0, -optical.x / optical.z, -optical.y / optical.z)
        }
        Optics::Spherical(grid) => {
            let (sin, cos) = (grid.first_azimuth_rad + column * grid.azimuth_step_rad).sin_cos();
            let (up, level) = (grid.first_elevation_rad + row * grid.elevation_step_rad).sin_cos();
            DVec3::new(cos * level, sin * level, up)
        }
        _ => unreachable!("tables have a test of their own"),
    }
}

fn check_grid(
    scenario: &Scenario,
    grid: &Optics,
    pose: &Pose,
    range: [f64; 2],
    faces: Faces,
    tally: &mut Tally,
) {
    let pair: &Pair = &scenario.pair;
    let [width, height] = grid.size();
    let answers = cast(scenario, (grid, pose, range), faces, Execution::default());
    for row in 0..height {
        for column in 0..width {
            let direction = direction(grid, column, row);
            let ray = (pose.translation(), DVec3::ZERO, pose.rotation() * direction);
            let what = format!("{}, {grid:?}, ray ({column}, {row})", scenario.name);
            let found = answers.of(row * width + column);
            pair.check(&what, ray, range, faces == Faces::Both, &found, direction.length(), tally);
        }
    }
}

#[test]
fn grids_agree_with_the_oracle() {
    let mut all = Tally::default();
    for scenario in &scenarios() {
        let mut tally = Tally::default();
        for pose in stands(scenario) {
            for grid in grids() {
                // Metres.
                let range = [1e-3 * scenario.size, 1e3 * scenario.size];
                for faces in [Faces::Front, Faces::Both] {
                    check_grid(scenario, &grid, &pose, range, faces, &mut tally);
                }
            }
        }
        println!("{}: {tally:?}", scenario.name);
        all.rays += tally.rays;
        all.hits += tally.hits;
        all.doubtful += tally.doubtful;
        all.worst = all.worst.max(tally.worst);
    }
    println!("all: {all:?}");
}

/// Rays of all kinds: along axes and diagonals, from inside and outside, and random ones.
fn assorted(scenario: &Scenario, count: usize) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let mut dice = Dice(21);
    let axes = [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, -1.0, 1.0)];
    (0..count)
        .map(|index| {
            let origin = dice.cube() * [0.1, 2.0, 6.0][index % 3] * scenario.size;
            let direction = match index % 4 {
                0 => axes[index / 4 % 5] * [1.0, -1.0][index / 20 % 2],
                1 => -origin / scenario.size + dice.cube() * 0.5,
                _ => dice.cube(),
            };
            (origin.as_vec3().to_array(), direction.as_vec3().to_array())
        })
        .unzip()
}

#[test]
fn single_rays_agree_with_the_oracle() {
    let wide = |v: [f32; 3]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let mut all = Tally::default();
    for scenario in &scenarios() {
        let (origins, directions) = assorted(scenario, 6000);
        let ranges = vec![[(1e-3 * scenario.size) as f32, f32::INFINITY]; origins.len()];
        let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
        for faces in [Faces::Front, Faces::Both] {
            let (answers, occluded) =
                cast_each(scenario, scenario.centre, &rays, faces, Execution::default());
            for (index, &occluded) in occluded.iter().enumerate() {
                let ray = (scenario.centre, wide(origins[index]), wide(directions[index]));
                let range = ranges[index].map(f64::from);
                let found = answers.of(index);
                let what = format!("{}, ray {index}", scenario.name);
                scenario.pair.check(&what, ray, range, faces == Faces::Both, &found, 1.0, &mut all);
                assert_eq!(
                    occluded,
                    found.distance.is_finite(),
                    "{what} of {faces:?}: any hit and nearest hit"
                );
            }
        }
    }
    println!("all: {all:?}");
}

#[test]
fn rays_from_surfaces_hit_the_next_surface() {
    let mut tally = Tally::default();
    for scenario in scenarios().iter().take(2) {
        // Origins are the hits of a first cast.
        let (origins, directions) = assorted(scenario, 60);
        let rays = Rays { origins: &origins, directions: &directions, ranges: None };
        let (answers, _) = cast_each(scenario, scenario.centre, &rays, Faces::Both, Execution::default());
        for ray in 0..origins.len() {
            let distance = f64::from(answers.distance[ray]);
            if distance.is_finite() {
                let at =
                    |axis: usize| f64::from(origins[ray][axis]) + f64::from(directions[ray][axis]) * distance;
                let place = scenario.centre + DVec3::new(at(0), at(1), at(2));
                let pose = Pose::from_xyz_rpy(place, DVec3::splat(ray as f64));
                let grid = &grids()[ray % 3];
                check_grid(scenario, grid, &pose, [1e-3, 1e3], Faces::Both, &mut tally);
            }
        }
    }
    println!("all: {tally:?}");
}

/// The number of scenes of each kind.
const SEEDS: u64 = 40;

#[test]
fn random_scenes_agree_with_the_oracle() {
    for kind in adversary::KINDS {
        let (mut grids, mut singles) = (Tally::default(), Tally::default());
        for seed in 0..SEEDS {
            let mut dice = Dice(seed * 1000 + kind as u64);
            let hard = adversary::scene(&mut dice, kind);
            let scenario = &hard.scenario;
            for pose in &hard.poses {
                let faces = if dice.roll() < 0.5 { Faces::Front } else { Faces::Both };
                let lens = PinholeGrid::from_fov(27, 21, 0.2 + 2.0 * dice.roll()).unwrap();
                let lidar = SphericalGrid {
                    columns: 40,
                    rows: 12,
                    first_azimuth_rad: dice.roll() * TAU,
                    azimuth_step_rad: TAU / 40.0,
                    first_elevation_rad: -1.2,
                    elevation_step_rad: 0.21,
                };
                let range = [1e-3 * scenario.size, 1e3 * scenario.size];
                for grid in [Optics::Pinhole(lens), Optics::Spherical(lidar)] {
                    check_grid(scenario, &grid, pose, range, faces, &mut grids);
                }
                check_rays(&hard, pose.translation(), &mut dice, faces, &mut singles);
            }
        }
        println!("{kind:?}: grids {grids:?}, single rays {singles:?}");
    }
}

/// Rays from around a position to all sides, at triangles and closely past their edges.
fn check_rays(hard: &adversary::Hard, place: DVec3, dice: &mut Dice, faces: Faces, tally: &mut Tally) {
    let wide = |v: [f32; 3]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    let scenario = &hard.scenario;
    let (origins, directions): (Vec<_>, Vec<_>) = (0..300)
        .map(|index| {
            let origin = if index % 3 == 0 { dice.cube() * scenario.size } else { DVec3::ZERO };
            let origin = origin.as_vec3();
            // Within rounding of a triangle's plane, every ray that is aimed at it passes its edges within 1e-6.
            let direction = if index % 2 == 0 || hard.kind == adversary::Kind::NearPlanes {
                dice.cube()
            } else {
                let from = place + origin.as_dvec3();
                adversary::aim(dice, hard.corners[index % hard.corners.len()], from) - from
            };
            (origin.to_array(), direction.normalize().as_vec3().to_array())
        })
        .unzip();
    let range = [(1e-3 * scenario.size) as f32, f32::INFINITY];
    let ranges = vec![range; origins.len()];
    let rays = Rays { origins: &origins, directions: &directions, ranges: Some(&ranges) };
    let (answers, occluded) = cast_each(scenario, place, &rays, faces, Execution::default());
    for (index, &occluded) in occluded.iter().enumerate() {
        let ray = (place, wide(origins[index]), wide(directions[index]));
        let found = answers.of(index);
        let what = format!("{}, single ray {index}", scenario.name);
        scenario.pair.check(&what, ray, range.map(f64::from), faces == Faces::Both, &found, 1.0, tally);
        assert_eq!(occluded, found.distance.is_finite(), "{what} of {faces:?}: any hit and nearest hit");
    }
}

//! Lidars whose angles exceed a pole or a turn.

use crate::common::brute::{Found, Tally};
use crate::common::exactness::{Dice, Scenario, scenarios, stands};
use crate::common::{LIDAR, add_grey, scan};
use belvedere_sensors::Pose;
use belvedere_sensors::lidar::Beams;
use belvedere_sensors::optics::{Optics, SphericalGrid};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::scene::{SceneBuilder, Shape};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use core::f64::consts::{PI, TAU};
use glam::DVec3;

fn beams(samples: u32, min_angle_rad: f64, max_angle_rad: f64) -> Beams {
    Beams { samples, min_angle_rad, max_angle_rad }
}

#[test]
fn a_vertical_scanner_sees_all_round() {
    let mut builder = SceneBuilder::new();
    add_grey(&mut builder, Shape::Sphere { radius: 2.0 }, Pose::IDENTITY);
    for (horizontal, vertical) in [
        (Beams::ONE, beams(720, -PI, PI)),
        (beams(5, -0.4, 0.4), beams(720, 0.0, TAU)),
        (beams(360, -PI, PI), beams(16, 1.0, 3.0)),
        (Beams::ONE, beams(2, 2.0, 2.0)),
    ] {
        let config = LIDAR.horizontal(horizontal).vertical(vertical);
        let (ranges, _) = scan(&builder, config, Pose::IDENTITY);
        let wrong = ranges.iter().filter(|&&range| (range - 2.0).abs() > 2e-5).count();
        assert_eq!(wrong, 0, "of {} beams, {horizontal:?} by {vertical:?}", ranges.len());
    }
}

#[test]
fn beams_beyond_a_turn_repeat() {
    // A plate between 3.11 and 3.13 rad, one metre away.
    let mut builder = SceneBuilder::new();
    let middle = 3.12_f64;
    let place = DVec3::new(middle.cos(), middle.sin(), 0.0);
    let plate = Shape::Box { size: [1e-3, 2.0 * 0.01_f64.tan(), 1.0] };
    add_grey(&mut builder, plate, Pose::from_xyz_rpy(place, DVec3::Z * middle));
    for half in [3.2, 6.0, 9.5] {
        let horizontal = beams(360, -half, half);
        let (ranges, _) = scan(&builder, LIDAR.horizontal(horizontal), Pose::IDENTITY);
        let mut seen = 0;
        for (beam, range) in ranges.iter().enumerate() {
            let off = (horizontal.angle(beam as u32) - middle).rem_euclid(TAU);
            let off = off.min(TAU - off);
            assert_eq!(range.is_finite(), off < 0.01, "beam {beam} of ±{half}, {off} rad beside the plate");
            seen += usize::from(range.is_finite());
        }
        assert!(seen > 1, "{seen} beams of ±{half}");
    }
}

/// Random angles: first angles up to many turns away, steps of both signs, spans from none to many turns.
fn random_steps(dice: &mut Dice, most: u32) -> (u32, f64, f64) {
    let pick = |dice: &mut Dice, values: &[f64]| values[(dice.roll() * values.len() as f64) as usize];
    let count = 1 + (dice.roll() * dice.roll() * f64::from(most)) as u32;
    let first = (dice.roll() * 2.0 - 1.0) * pick(dice, &[0.0, 1.5, 4.0, 10.0, 1e3]);
    let span = pick(dice, &[0.0, 1e-7, 0.3, 1.5, PI, 6.2, TAU, 6.4, 9.0, 40.0, 1e3]);
    let sign = pick(dice, &[-1.0, 1.0]);
    let span = if dice.roll() < 0.5 { span } else { span * dice.roll() };
    (count, first, sign * span / f64::from(count))
}

fn check(scenario: &Scenario, pose: &Pose, grid: &SphericalGrid, faces: Faces, tally: &mut Tally) {
    let scene = scenario.pair.builder.scene();
    let rays = (grid.columns * grid.rows) as usize;
    let (mut distance, mut normal) = (vec![f32::NAN; rays], vec![[f32::NAN; 3]; rays]);
    let (mut instance, mut primitive) = (vec![7; rays], vec![7; rays]);
    let mut barycentrics = vec![[f32::NAN; 2]; rays];
    let hits = Hits {
        distance: Some(&mut distance),
        normal: Some(&mut normal),
        instance: Some(&mut instance),
        primitive: Some(&mut primitive),
        barycentrics: Some(&mut barycentrics),
    };
    let range = [1e-3 * scenario.size, 1e3 * scenario.size];
    let mut workspace = WorkspaceBuf::default();
    let any = Optics::Spherical(*grid);
    let mut workspace = workspace.lend(grid_workspace_len(&scene, &any));
    cast_grid(&scene, &scenario.pair.builder.moment(*pose), &any, range, VISUAL, faces, &mut workspace, hits)
        .unwrap();
    for ray in 0..rays {
        let (column, row) = (ray as u32 % grid.columns, ray as u32 / grid.columns);
        let (sin, cos) = (grid.first_azimuth_rad + f64::from(column) * grid.azimuth_step_rad).sin_cos();
        let (up, level) = (grid.first_elevation_rad + f64::from(row) * grid.elevation_step_rad).sin_cos();
        let direction = pose.rotation() * DVec3::new(cos * level, sin * level, up);
        let found = Found {
            distance: distance[ray],
            normal: normal[ray],
            instance: instance[ray],
            primitive: primitive[ray],
            barycentrics: barycentrics[ray],
        };
        let what = format!("{}, {grid:?}, ray ({column}, {row})", scenario.name);
        let ray = (pose.translation(), DVec3::ZERO, direction);
        scenario.pair.check(&what, ray, range, faces == Faces::Both, &found, 1.0, tally);
    }
}

#[test]
fn any_angles_agree_with_the_oracle() {
    let mut dice = Dice(5);
    for scenario in &scenarios() {
        let mut tally = Tally::default();
        for pose in stands(scenario) {
            for _ in 0..30 {
                let (columns, first_azimuth_rad, azimuth_step_rad) = random_steps(&mut dice, 90);
                let (rows, first_elevation_rad, elevation_step_rad) = random_steps(&mut dice, 90);
                let grid = SphericalGrid {
                    columns,
                    rows,
                    first_azimuth_rad,
                    azimuth_step_rad,
                    first_elevation_rad,
                    elevation_step_rad,
                };
                let faces = if dice.roll() < 0.5 { Faces::Front } else { Faces::Both };
                check(scenario, &pose, &grid, faces, &mut tally);
            }
        }
        println!("{}: {tally:?}", scenario.name);
    }
}

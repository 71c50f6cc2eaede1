//! Every output of a cast has the same bytes at every SIMD level and for any number of threads.

use crate::common::casts::{cast, cast_each, levels};
use crate::common::exactness::{Dice, Scenario, scenarios, stands};
use belvedere_sensors::Execution;
use belvedere_sensors::optics::{Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::Faces;
use belvedere_sensors::trace::rays::Rays;

/// All outputs for the hits of a scene, as bytes.
fn cast_all(scenario: &Scenario, execution: Execution) -> Vec<(&'static str, Vec<u8>)> {
    let mut told = Vec::new();
    let range = [1e-3 * scenario.size, 1e3 * scenario.size];
    // The first is divided into several bands.
    let ring = SphericalGrid {
        columns: 360,
        rows: 65,
        first_azimuth_rad: -3.0,
        azimuth_step_rad: core::f64::consts::TAU / 360.0,
        first_elevation_rad: -1.55,
        elevation_step_rad: 0.048,
    };
    for grid in [Optics::Pinhole(PinholeGrid::from_fov(331, 245, 1.4).unwrap()), Optics::Spherical(ring)] {
        for (pose, faces) in stands(scenario).iter().zip([Faces::Both, Faces::Both, Faces::Front]) {
            told.extend(cast(scenario, (&grid, pose, range), faces, execution).bytes());
        }
    }
    let mut dice = Dice(77);
    let mut vector = |size: f64| (dice.cube() * size).as_vec3().to_array();
    let origins: Vec<_> = (0..5000).map(|_| vector(3.0 * scenario.size)).collect();
    let directions: Vec<_> = (0..5000).map(|_| vector(1.0)).collect();
    let rays = Rays { origins: &origins, directions: &directions, ranges: None };
    let (answers, occluded) = cast_each(scenario, scenario.centre, &rays, Faces::Both, execution);
    told.extend(answers.bytes());
    told.push(("occluded", occluded.into_iter().map(u8::from).collect()));
    told
}

fn assert_same(what: &str, scenario: &Scenario, expected: &[(&str, Vec<u8>)], found: &[(&str, Vec<u8>)]) {
    assert_eq!(expected.len(), found.len());
    for (cast, (expected, found)) in expected.iter().zip(found).enumerate() {
        let name = scenario.name;
        assert!(expected == found, "{} of cast {} of the scene `{name}` differs {what}", found.0, cast / 5);
    }
}

#[test]
fn every_level_gives_the_same_hits() {
    for scenario in &scenarios() {
        let expected = cast_all(scenario, Execution::at(Level::baseline()));
        for (name, level) in levels() {
            let Some(level) = level else {
                println!("this machine has no {name}: not tested");
                continue;
            };
            let found = cast_all(scenario, Execution::at(level));
            assert_same(&format!("at {name}"), scenario, &expected, &found);
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn any_number_of_threads_gives_the_same_hits() {
    for scenario in &scenarios() {
        let expected = cast_all(scenario, Execution::default());
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| cast_all(scenario, Execution::parallel()));
            assert_same(&format!("with {threads} threads"), scenario, &expected, &found);
        }
    }
}

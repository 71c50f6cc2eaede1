//! Every output of a cast has the same bytes at every SIMD level and for any number of threads.

mod common;

use belvedere_sensors::Execution;
use belvedere_sensors::optics::{Optics, PinholeGrid, SphericalGrid};
use belvedere_sensors::scene::visibility::VISUAL;
use belvedere_sensors::simd::Level;
use belvedere_sensors::trace::rays::{Rays, cast_rays, occluded_rays, workspace_len};
use belvedere_sensors::trace::{Faces, Hits, WorkspaceBuf, cast_grid, grid_workspace_len};
use common::exactness::{Dice, Scenario, scenarios, stands};

/// All that is told of a scene's hits, as bytes.
fn cast_all(scenario: &Scenario, execution: Execution) -> Vec<(&'static str, Vec<u8>)> {
    let scene = scenario.pair.builder.scene();
    let mut workspace = WorkspaceBuf::default();
    workspace.execution = execution;
    let mut told = Vec::new();
    let mut tell = |count: usize, cast: &mut dyn FnMut(Hits<'_>)| {
        let mut distance = vec![0.0_f32; count];
        let mut normal = vec![[0.0_f32; 3]; count];
        let (mut instance, mut primitive) = (vec![0_u32; count], vec![0_u32; count]);
        let mut barycentrics = vec![[0.0_f32; 2]; count];
        cast(Hits {
            distance: Some(&mut distance),
            normal: Some(&mut normal),
            instance: Some(&mut instance),
            primitive: Some(&mut primitive),
            barycentrics: Some(&mut barycentrics),
        });
        told.push(("distance", bytemuck::cast_slice(&distance).to_vec()));
        told.push(("normal", bytemuck::cast_slice(&normal).to_vec()));
        told.push(("instance", bytemuck::cast_slice(&instance).to_vec()));
        told.push(("primitive", bytemuck::cast_slice(&primitive).to_vec()));
        told.push(("barycentrics", bytemuck::cast_slice(&barycentrics).to_vec()));
    };
    let range = [1e-3 * scenario.size, 1e3 * scenario.size];
    // The first is cut into several bands.
    let ring = SphericalGrid {
        columns: 360,
        rows: 65,
        first_azimuth_rad: -3.0,
        azimuth_step_rad: core::f64::consts::TAU / 360.0,
        first_elevation_rad: -1.55,
        elevation_step_rad: 0.048,
    };
    for grid in [Optics::Pinhole(PinholeGrid::from_fov(331, 245, 1.4).unwrap()), Optics::Spherical(ring)] {
        let [width, height] = grid.size();
        for (pose, faces) in stands(scenario).iter().zip([Faces::Both, Faces::Both, Faces::Front]) {
            let mut workspace = workspace.lend(grid_workspace_len(&scene, &grid));
            tell(width * height, &mut |hits| {
                cast_grid(
                    &scene,
                    &scenario.pair.builder.moment(*pose),
                    &grid,
                    range,
                    VISUAL,
                    faces,
                    &mut workspace,
                    hits,
                )
                .unwrap();
            });
        }
    }
    let mut dice = Dice(77);
    let mut vector = |size: f64| (dice.cube() * size).as_vec3().to_array();
    let origins: Vec<_> = (0..5000).map(|_| vector(3.0 * scenario.size)).collect();
    let directions: Vec<_> = (0..5000).map(|_| vector(1.0)).collect();
    let rays = Rays { origins: &origins, directions: &directions, ranges: None };
    let mut workspace = workspace.lend(workspace_len(&scene));
    tell(origins.len(), &mut |hits| {
        cast_rays(
            &scene,
            scenario.pair.builder.poses(),
            scenario.centre,
            &rays,
            VISUAL,
            Faces::Both,
            &mut workspace,
            hits,
        )
        .expect("outputs of the right size");
    });
    let mut occluded = vec![false; origins.len()];
    occluded_rays(
        &scene,
        scenario.pair.builder.poses(),
        scenario.centre,
        &rays,
        VISUAL,
        Faces::Both,
        &mut workspace,
        &mut occluded,
    )
    .expect("outputs of the right size");
    told.push(("occluded", occluded.into_iter().map(u8::from).collect()));
    told
}

/// The levels of this machine's architecture; none for those that the machine has not.
fn levels() -> Vec<(&'static str, Option<Level>)> {
    let best = Level::new();
    #[cfg(target_arch = "x86_64")]
    return vec![
        ("SSE2", best.as_sse2().map(Level::Sse2)),
        ("SSE4.2", best.as_sse4_2().map(Level::Sse4_2)),
        ("AVX2", best.as_avx2().map(Level::Avx2)),
        ("AVX-512", best.as_avx512().map(Level::Avx512)),
    ];
    #[cfg(not(target_arch = "x86_64"))]
    return vec![("the baseline", Some(Level::baseline())), ("the best", Some(best))];
}

fn assert_same(what: &str, scenario: &Scenario, expected: &[(&str, Vec<u8>)], found: &[(&str, Vec<u8>)]) {
    assert_eq!(expected.len(), found.len());
    for (cast, (expected, found)) in expected.iter().zip(found).enumerate() {
        let name = scenario.name;
        assert!(expected == found, "{} of cast {} of the scene `{name}` differs {what}", found.0, cast / 5);
    }
}

#[test]
fn every_level() {
    for scenario in &scenarios() {
        let expected = cast_all(scenario, Execution { level: Level::baseline(), ..Execution::default() });
        for (name, level) in levels() {
            let Some(level) = level else {
                println!("this machine has no {name}: not tested");
                continue;
            };
            let found = cast_all(scenario, Execution { level, ..Execution::default() });
            assert_same(&format!("at {name}"), scenario, &expected, &found);
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn any_number_of_threads() {
    for scenario in &scenarios() {
        let expected = cast_all(scenario, Execution::default());
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| cast_all(scenario, Execution::parallel()));
            assert_same(&format!("with {threads} threads"), scenario, &expected, &found);
        }
    }
}

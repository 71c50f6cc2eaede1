//! Rays per second for every scene and ray set, with criterion's statistics, for people. `gate` gives the verdict.

#![allow(unreachable_pub, reason = "the modules of a program, which exports nothing")]

mod scenes;

use belvedere_sensors::Execution;
use belvedere_sensors::simd::best_level;
use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use scenes::ours::{Built, Caster, Wanted};
use scenes::{RAYS, RaySet, SCENES, Scene};
use std::hint::black_box;
use std::time::Duration;

fn trace(criterion: &mut Criterion) {
    for name in SCENES {
        let mut group = criterion.benchmark_group(name);
        group.sampling_mode(SamplingMode::Flat).sample_size(20).measurement_time(Duration::from_secs(3));
        let scene = Scene::new(name);
        let built = Built::new(&scene.mesh);
        for name in RAYS {
            let rays = RaySet::new(name, &scene).first(100_000);
            let mut caster = Caster::new(&rays, Execution::at(best_level()), Wanted::All);
            group.throughput(Throughput::Elements(rays.len() as u64));
            group.bench_function(name, |bencher| bencher.iter(|| black_box(caster.cast(&built)).len()));
        }
    }
}

criterion_group!(benches, trace);
criterion_main!(benches);

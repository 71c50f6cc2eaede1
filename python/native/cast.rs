//! Casting of arbitrary rays.

use crate::data::Data;
use crate::errors::of;
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::Moves;
use crate::states::States;
use belvedere_sensors::trace::rays::{self, cast_rays};
use belvedere_sensors::trace::{Faces, Hits};
use glam::DVec3;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// Rays with checked array shapes.
pub(crate) struct Rays {
    pub(crate) origins: Vec<[f32; 3]>,
    pub(crate) directions: Vec<[f32; 3]>,
    pub(crate) ranges: Option<Vec<[f32; 2]>>,
    /// The place in the world that origins are relative to.
    pub(crate) reference: [f64; 3],
    pub(crate) visibility: u32,
    pub(crate) both_faces: bool,
}

impl Rays {
    fn check(&self) -> PyResult<()> {
        let finite = |argument: &str, rows: &[[f32; 3]]| match rows
            .iter()
            .position(|row| !row.iter().all(|number| number.is_finite()))
        {
            Some(ray) => Err(of(argument, format_args!("that of ray {ray} is not finite: {:?}", rows[ray]))),
            None => Ok(()),
        };
        finite("origins", &self.origins)?;
        finite("directions", &self.directions)?;
        if let Some(ray) = self.directions.iter().position(|row| *row == [0.0; 3]) {
            return Err(of("directions", format_args!("that of ray {ray} is 0 0 0")));
        }
        let ranges = self.ranges.as_deref().unwrap_or_default();
        if let Some(ray) = ranges.iter().position(|[least, most]| !(*least >= 0.0 && least < most)) {
            let [least, most] = ranges[ray];
            return Err(of("ranges", format_args!("of ray {ray}, 0 <= {least} < {most} does not hold")));
        }
        if !self.reference.iter().all(|number| number.is_finite()) {
            return Err(of("reference", format_args!("it is not finite: {:?}", self.reference)));
        }
        Ok(())
    }
}

/// Poses of bodies from Python, unless they are [`States`]: numbers of bodies, their poses.
type GivenMoves<'py> = (Vec<usize>, Option<PyReadonlyArrayDyn<'py, f64>>);

/// The number of rays cast at a time, so that Ctrl-C need not wait for all.
const AT_A_TIME: usize = 1 << 20;

/// Finds the first hit of each ray. Without a hit, normals and barycentrics are 0.
pub(crate) fn cast(
    py: Python<'_>,
    world: Arc<Data>,
    rays: &Rays,
    moves: &Bound<'_, PyAny>,
    outputs: &Bound<'_, PyDict>,
    threads: usize,
) -> PyResult<()> {
    rays.check()?;
    let given;
    let moves = if let Ok(states) = moves.cast::<States>() {
        states.get().places().moves()
    } else {
        let (bodies, moved): GivenMoves<'_> = moves.extract()?;
        given = Moves::read("bodies", &world, 1, bodies, moved.as_ref())?;
        &given
    };
    moves.check("bodies", &world, 1)?;
    let count = rays.directions.len();
    if count == 0 {
        return Ok(());
    }
    let mut outputs = Outputs::borrow(outputs)?;
    let mut slices = outputs.lend(1)?;
    let mut distance = parts(slices.f32("distance", count)?.next());
    let mut normal = parts(slices.f32("normal", count)?.next());
    let mut instance = parts(slices.u32("instance", count)?.next());
    let mut primitive = parts(slices.u32("primitive", count)?.next());
    let mut barycentrics = parts(slices.f32("barycentrics", count)?.next());
    slices.finish()?;
    let hits: Vec<_> = (0..count.div_ceil(AT_A_TIME))
        .map(|_| Hits {
            distance: distance.next(),
            normal: normal.next(),
            instance: instance.next(),
            primitive: primitive.next(),
            barycentrics: barycentrics.next(),
        })
        .collect();
    let threads = Threads::new(threads, count)?;
    let faces = if rays.both_faces { Faces::Both } else { Faces::Front };
    py.detach(|| {
        threads.for_each(hits, |index, mut hits, memory| {
            hits.normal.iter_mut().for_each(|normals| normals.fill([0.0; 3]));
            hits.barycentrics.iter_mut().for_each(|weights| weights.fill([0.0; 2]));
            let first = index * AT_A_TIME;
            let here = first..count.min(first + AT_A_TIME);
            let given = rays::Rays {
                // One origin for each ray, or one for all.
                origins: rays.origins.get(here.clone()).unwrap_or(&rays.origins),
                directions: &rays.directions[here.clone()],
                ranges: rays.ranges.as_ref().map(|ranges| &ranges[here]),
            };
            let scene = world.builder.scene();
            let instances = moves.place(&world, 0, &mut memory.poses[0]);
            let workspace = &mut memory.workspace.lend(rays::workspace_len(&scene));
            let reference = DVec3::from_array(rays.reference);
            cast_rays(&scene, instances, reference, &given, rays.visibility, faces, workspace, hits)
                .map_err(|why| why.to_string())
        })
    })
}

/// Splits an output into chunks of [`AT_A_TIME`] rays.
fn parts<T>(output: Option<&mut [T]>) -> impl Iterator<Item = &mut [T]> {
    output.into_iter().flat_map(|output| output.chunks_mut(AT_A_TIME))
}

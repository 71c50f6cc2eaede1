//! Rays with nothing in common.

use crate::data::Data;
use crate::errors::{of, value_error};
use crate::outputs::Outputs;
use crate::pool::Threads;
use crate::shots::Moves;
use belvedere_sensors::trace::rays::{self, cast_rays};
use belvedere_sensors::trace::{Faces, Hits};
use glam::DVec3;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Arc;

/// Rays, checked as arrays.
pub(crate) struct Rays {
    pub(crate) origins: Vec<[f32; 3]>,
    pub(crate) directions: Vec<[f32; 3]>,
    pub(crate) ranges: Option<Vec<[f32; 2]>>,
    /// Where the origins' zero is in the world.
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

/// Finds what each ray first meets. Where that is nothing, normals and barycentrics are 0.
pub(crate) fn cast(
    py: Python<'_>,
    world: Arc<Data>,
    rays: &Rays,
    (bodies, moved): (Vec<usize>, Option<PyReadonlyArrayDyn<'_, f64>>),
    outputs: &Bound<'_, PyDict>,
    threads: usize,
) -> PyResult<()> {
    rays.check()?;
    let moves = Moves::read("bodies", &world, 1, bodies, moved.as_ref())?;
    let count = rays.directions.len();
    if count == 0 {
        return Ok(());
    }
    let mut outputs = Outputs::borrow(outputs)?;
    let mut slices = outputs.lend(1)?;
    let mut hits = Hits {
        distance: slices.f32("distance", count)?.next(),
        normal: slices.f32("normal", count)?.next(),
        instance: slices.u32("instance", count)?.next(),
        primitive: slices.u32("primitive", count)?.next(),
        barycentrics: slices.f32("barycentrics", count)?.next(),
    };
    slices.finish()?;
    let threads = Threads::new(threads, count)?;
    let faces = if rays.both_faces { Faces::Both } else { Faces::Front };
    let done = py.detach(|| {
        hits.normal.iter_mut().for_each(|normals| normals.fill([0.0; 3]));
        hits.barycentrics.iter_mut().for_each(|weights| weights.fill([0.0; 2]));
        let given = rays::Rays {
            origins: &rays.origins,
            directions: &rays.directions,
            ranges: rays.ranges.as_deref(),
        };
        threads.for_each(vec![hits], |_, hits, memory| {
            let scene = world.builder.scene();
            let instances = moves.place(&world, 0, &mut memory.poses[0]);
            let workspace = &mut memory.workspace.lend(rays::workspace_len(&scene));
            let reference = DVec3::from_array(rays.reference);
            cast_rays(&scene, instances, reference, &given, rays.visibility, faces, workspace, hits)
                .map_err(|why| why.to_string())
        })
    });
    done.map_err(value_error)
}

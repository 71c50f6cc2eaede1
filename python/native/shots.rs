//! From where, and when, each frame of a batch is seen.

use crate::data::Data;
use crate::errors::of;
use crate::looks::{GivenLooks, Looks};
use crate::path;
use crate::pool::Memory;
use crate::poses;
use belvedere_sensors::scene::Scene;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Moment, Pose};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Arc;

/// Other places of some bodies, frame by frame.
#[derive(Default)]
pub(crate) struct Moves {
    bodies: Vec<usize>,
    /// Of each frame as many as there are bodies.
    world_from_body: Vec<Pose>,
}

/// Where the sensor and the bodies are at the frames' moments.
pub(crate) struct Places {
    world_from_sensor: Vec<Pose>,
    moves: Moves,
}

/// The frames of a batch.
pub(crate) struct Shots {
    pub(crate) world: Arc<Data>,
    now: Places,
    /// The moments that flow goes to.
    after: Option<Places>,
    before: Option<Places>,
    each: Each,
}

/// What each frame has of its own besides poses.
struct Each {
    seeds: Vec<u64>,
    /// Numbers of frames.
    numbers: Vec<u64>,
    /// Which frames are taken, if not all.
    mask: Option<Vec<bool>>,
    looks: Option<Looks>,
}

/// The same as Python hands it over.
pub(crate) type GivenEach<'py> = (Vec<u64>, Vec<u64>, Option<Vec<bool>>, Option<GivenLooks<'py>>);

/// A moment as Python hands it over: poses of the sensor, numbers of bodies, their poses.
type Given<'py> = (PyReadonlyArrayDyn<'py, f64>, Vec<usize>, Option<PyReadonlyArrayDyn<'py, f64>>);

impl Moves {
    /// Of so many frames.
    pub(crate) fn read(
        argument: &str,
        world: &Data,
        frames: usize,
        bodies: Vec<usize>,
        array: Option<&PyReadonlyArrayDyn<'_, f64>>,
    ) -> PyResult<Self> {
        if let Some(body) = bodies.iter().find(|body| **body >= world.bodies.len()) {
            let count = world.bodies.len();
            return Err(of(argument, format_args!("there is no body {body}; the world has {count}")));
        }
        let world_from_body =
            array.map(|array| poses::read(argument, array)).transpose()?.unwrap_or_default();
        if world_from_body.len() != frames * bodies.len() {
            let (have, need) = (world_from_body.len(), frames * bodies.len());
            return Err(of(argument, format_args!("{have} poses, and {need} are expected")));
        }
        Ok(Self { bodies, world_from_body })
    }

    /// The bodies that are elsewhere in a frame, and where.
    fn of_frame(&self, frame: usize) -> impl Iterator<Item = (usize, Pose)> {
        let moved = &self.world_from_body[frame * self.bodies.len()..][..self.bodies.len()];
        self.bodies.iter().copied().zip(moved.iter().copied())
    }

    /// Where all instances are in a frame.
    pub(crate) fn place<'a>(&self, world: &'a Data, frame: usize, memory: &'a mut Vec<Pose>) -> &'a [Pose] {
        let stand = world.builder.poses();
        if self.bodies.is_empty() {
            return stand;
        }
        memory.clear();
        memory.extend_from_slice(stand);
        put(world, self.of_frame(frame), memory);
        memory
    }
}

/// Puts the instances of bodies where those are.
fn put(world: &Data, bodies: impl Iterator<Item = (usize, Pose)>, world_from_instance: &mut [Pose]) {
    for (body, world_from_body) in bodies {
        for (instance, body_from_instance) in &world.bodies[body].parts {
            world_from_instance[instance.0 as usize] = world_from_body * *body_from_instance;
        }
    }
}

impl Places {
    fn read(
        argument: &str,
        bodies: &str,
        world: &Data,
        given: Given<'_>,
        frames: Option<usize>,
    ) -> PyResult<Self> {
        let (sensor, numbers, moved) = given;
        let world_from_sensor = poses::read(argument, &sensor)?;
        let count = world_from_sensor.len();
        if frames.is_some_and(|frames| frames != count) {
            return Err(of(
                argument,
                format_args!("{count} poses, and {} are expected", frames.unwrap_or(0)),
            ));
        }
        let moves = Moves::read(bodies, world, count, numbers, moved.as_ref())?;
        Ok(Self { world_from_sensor, moves })
    }

    fn moment<'a>(&self, world: &'a Data, frame: usize, memory: &'a mut Vec<Pose>) -> Moment<'a> {
        Moment {
            world_from_sensor: self.world_from_sensor[frame],
            world_from_instance: self.moves.place(world, frame, memory),
        }
    }

    /// Where the sensor is in a frame, and then all bodies.
    fn all(&self, world: &Data, frame: usize) -> Vec<Pose> {
        let stand = world.bodies.iter().map(|body| body.pose);
        let mut all: Vec<_> = std::iter::once(self.world_from_sensor[frame]).chain(stand).collect();
        self.moves.of_frame(frame).for_each(|(body, pose)| all[1 + body] = pose);
        all
    }
}

impl Shots {
    /// Checks what Python hands over: tuples of poses of the sensor, numbers of the bodies that are elsewhere, their poses.
    pub(crate) fn read(
        world: Arc<Data>,
        now: &Bound<'_, PyTuple>,
        after: Option<&Bound<'_, PyTuple>>,
        before: Option<&Bound<'_, PyTuple>>,
        each: GivenEach<'_>,
    ) -> PyResult<Self> {
        let now = Places::read("poses", "bodies", &world, now.extract()?, None)?;
        let frames = now.world_from_sensor.len();
        let other = |given: Option<&Bound<'_, PyTuple>>, names: [&str; 2]| {
            given
                .map(|given| Places::read(names[0], names[1], &world, given.extract()?, Some(frames)))
                .transpose()
        };
        let after = other(after, ["after", "bodies_after"])?;
        let before = other(before, ["before", "bodies_before"])?;
        let (seeds, numbers, mask, looks) = each;
        let masked = mask.as_ref().map_or(frames, Vec::len);
        for (argument, have) in [("seeds", seeds.len()), ("frames", numbers.len()), ("mask", masked)] {
            if have != frames {
                return Err(of(argument, format_args!("{have} elements, and {frames} are expected")));
            }
        }
        let looks = looks.map(|looks| Looks::read(&world, frames, looks)).transpose()?;
        Ok(Self { world, now, after, before, each: Each { seeds, numbers, mask, looks } })
    }

    /// That there is a moment for each flow that is wanted.
    pub(crate) fn check_flows(&self, [after, before]: [bool; 2]) -> PyResult<()> {
        for (is_wanted, there, flow, argument) in
            [(after, &self.after, "flow", "after"), (before, &self.before, "flow_back", "before")]
        {
            if is_wanted && there.is_none() {
                return Err(of(
                    "channels",
                    format_args!("{flow:?} wants a moment to flow to: give {argument}=poses"),
                ));
            }
        }
        Ok(())
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.now.world_from_sensor.len()
    }

    /// Whether a frame is taken.
    pub(crate) fn is_wanted(&self, frame: usize) -> bool {
        self.each.mask.as_ref().is_none_or(|mask| mask[frame])
    }

    /// The seed of a frame.
    pub(crate) fn seed(&self, frame: usize) -> u64 {
        self.each.seeds[frame]
    }

    /// Where the sensor and all instances are at even times between now and the moment after, so that nothing turns far
    /// from one to the next. The two themselves are left out; if nothing turns far between them there are no others.
    pub(crate) fn between(&self, frame: usize) -> Vec<(Pose, Vec<Pose>)> {
        let Some(after) = &self.after else { return Vec::new() };
        let world = &*self.world;
        let steps = path::steps(self.now.all(world, frame), after.all(world, frame));
        let inner = steps.get(1..steps.len() - 1).unwrap_or_default();
        let moving = self.now.moves.bodies.iter().chain(&after.moves.bodies);
        let place = |step: &Vec<Pose>| {
            let mut world_from_instance = world.builder.poses().to_vec();
            put(world, moving.clone().map(|body| (*body, step[1 + body])), &mut world_from_instance);
            (step[0], world_from_instance)
        };
        inner.iter().map(place).collect()
    }

    /// Lends a frame's scene and moments.
    pub(crate) fn take(
        &self,
        frame: usize,
        memory: &mut Memory,
        take: impl FnOnce(&Scene<'_>, &Capture<'_>, &mut WorkspaceBuf) -> Result<(), String>,
    ) -> Result<(), String> {
        let Memory { workspace, poses: [now, after, before], materials, lights } = memory;
        let world = &*self.world;
        let mut capture = Capture::new(self.each.numbers[frame], self.now.moment(world, frame, now));
        if let Some(places) = &self.after {
            capture = capture.after(places.moment(world, frame, after));
        }
        if let Some(places) = &self.before {
            capture = capture.before(places.moment(world, frame, before));
        }
        let mut scene = world.builder.scene();
        if let Some(looks) = &self.each.looks {
            scene = looks.of_frame(world, frame, materials, lights).map_err(|why| why.to_string())?;
        }
        take(&scene, &capture, workspace)
    }
}

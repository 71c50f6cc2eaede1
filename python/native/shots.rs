//! The poses of sensor and bodies for each frame of a batch.

use crate::data::Data;
use crate::errors::of;
use crate::looks::{GivenLooks, Looks};
use crate::path;
use crate::pool::Memory;
use crate::poses;
use crate::states::States;
use belvedere_sensors::scene::Scene;
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Capture, Moment, Pose};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use std::sync::Arc;

/// Poses of moved bodies, frame by frame.
#[derive(Default)]
pub(crate) struct Moves {
    bodies: Vec<usize>,
    /// The poses of `bodies` for each frame.
    world_from_body: Vec<Pose>,
}

/// The poses of sensor and bodies at the times of the frames.
pub(crate) struct Places {
    world_from_sensor: Vec<Pose>,
    moves: Moves,
}

/// The frames of a batch.
pub(crate) struct Shots {
    pub(crate) world: Arc<Data>,
    now: Arc<Places>,
    /// The next and the previous frame, for optical flow.
    after: Option<Arc<Places>>,
    before: Option<Arc<Places>>,
    each: Each,
}

/// Properties of each frame besides poses.
struct Each {
    seeds: Vec<u64>,
    /// Numbers of frames.
    numbers: Vec<u64>,
    /// The frames to render, if not all.
    mask: Option<Vec<bool>>,
    looks: Option<Looks>,
}

/// Properties of each frame from Python.
pub(crate) type GivenEach<'py> = (Vec<u64>, Vec<u64>, Option<Vec<bool>>, Option<GivenLooks<'py>>);

/// Poses at one time from Python: poses of the sensor, numbers of bodies, their poses.
type Given<'py> = (PyReadonlyArrayDyn<'py, f64>, Vec<usize>, Option<PyReadonlyArrayDyn<'py, f64>>);

impl Moves {
    /// Reads the poses for this number of frames.
    pub(crate) fn read(
        argument: &str,
        world: &Data,
        frames: usize,
        bodies: Vec<usize>,
        array: Option<&PyReadonlyArrayDyn<'_, f64>>,
    ) -> PyResult<Self> {
        let world_from_body =
            array.map(|array| poses::read(argument, array)).transpose()?.unwrap_or_default();
        let moves = Self { bodies, world_from_body };
        moves.check(argument, world, frames)?;
        Ok(moves)
    }

    /// The poses of these bodies, frame by frame.
    pub(crate) fn new(bodies: Vec<usize>, world_from_body: Vec<Pose>) -> Self {
        Self { bodies, world_from_body }
    }

    /// Checks that the world has these bodies, and that there is a pose of each in each frame.
    pub(crate) fn check(&self, argument: &str, world: &Data, frames: usize) -> PyResult<()> {
        let count = world.bodies.len();
        if let Some(body) = self.bodies.iter().find(|body| **body >= count) {
            return Err(of(argument, format_args!("there is no body {body}; the world has {count}")));
        }
        let (have, need) = (self.world_from_body.len(), frames * self.bodies.len());
        if have != need {
            return Err(of(argument, format_args!("{have} poses, and {need} are expected")));
        }
        Ok(())
    }

    /// Returns the moved bodies of a frame, with their poses.
    fn of_frame(&self, frame: usize) -> impl Iterator<Item = (usize, Pose)> {
        let moved = &self.world_from_body[frame * self.bodies.len()..][..self.bodies.len()];
        self.bodies.iter().copied().zip(moved.iter().copied())
    }

    /// Returns the poses of all instances in a frame.
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

/// Moves the instances of bodies to the bodies' poses.
fn put(world: &Data, bodies: impl Iterator<Item = (usize, Pose)>, world_from_instance: &mut [Pose]) {
    for (body, world_from_body) in bodies {
        for (instance, body_from_instance) in &world.bodies[body].parts {
            world_from_instance[instance.0 as usize] = world_from_body * *body_from_instance;
        }
    }
}

impl Places {
    pub(crate) fn new(world_from_sensor: Vec<Pose>, moves: Moves) -> Self {
        Self { world_from_sensor, moves }
    }

    /// The poses of the bodies.
    pub(crate) fn moves(&self) -> &Moves {
        &self.moves
    }

    /// Reads the places of these frames, or of as many as there are: [`States`], or arrays.
    fn read(
        [argument, bodies]: [&str; 2],
        world: &Data,
        given: &Bound<'_, PyAny>,
        frames: Option<usize>,
    ) -> PyResult<Arc<Self>> {
        let places = if let Ok(states) = given.cast::<States>() {
            states.get().places().clone()
        } else {
            let (sensor, numbers, moved): Given<'_> = given.extract()?;
            let world_from_sensor = poses::read(argument, &sensor)?;
            let moves = Moves::read(bodies, world, world_from_sensor.len(), numbers, moved.as_ref())?;
            Arc::new(Self { world_from_sensor, moves })
        };
        let count = places.world_from_sensor.len();
        let need = frames.unwrap_or(count);
        if count != need {
            return Err(of(argument, format_args!("{count} poses, and {need} are expected")));
        }
        places.moves.check(bodies, world, count)?;
        Ok(places)
    }

    fn moment<'a>(&self, world: &'a Data, frame: usize, memory: &'a mut Vec<Pose>) -> Moment<'a> {
        Moment {
            world_from_sensor: self.world_from_sensor[frame],
            world_from_instance: self.moves.place(world, frame, memory),
        }
    }

    /// Returns the pose of the sensor in a frame, followed by those of all bodies.
    fn all(&self, world: &Data, frame: usize) -> Vec<Pose> {
        let stand = world.bodies.iter().map(|body| body.pose);
        let mut all: Vec<_> = std::iter::once(self.world_from_sensor[frame]).chain(stand).collect();
        self.moves.of_frame(frame).for_each(|(body, pose)| all[1 + body] = pose);
        all
    }
}

impl Shots {
    /// Checks arguments from Python: [`States`], or tuples of poses of the sensor, numbers of moved bodies, their poses.
    pub(crate) fn read(
        world: Arc<Data>,
        now: &Bound<'_, PyAny>,
        after: Option<&Bound<'_, PyAny>>,
        before: Option<&Bound<'_, PyAny>>,
        each: GivenEach<'_>,
    ) -> PyResult<Self> {
        let now = Places::read(["poses", "bodies"], &world, now, None)?;
        let frames = now.world_from_sensor.len();
        let other = |given: Option<&Bound<'_, PyAny>>, names| {
            given.map(|given| Places::read(names, &world, given, Some(frames))).transpose()
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

    /// Checks that the poses for each requested flow are present.
    pub(crate) fn check_flows(&self, [after, before]: [bool; 2]) -> PyResult<()> {
        for (is_wanted, there, flow, argument) in
            [(after, &self.after, "flow", "after"), (before, &self.before, "flow_back", "before")]
        {
            if is_wanted && there.is_none() {
                return Err(of(
                    "channels",
                    format_args!("{flow:?} needs the poses at another time: give {argument}=poses"),
                ));
            }
        }
        Ok(())
    }

    /// Returns the number of frames.
    pub(crate) fn len(&self) -> usize {
        self.now.world_from_sensor.len()
    }

    /// Returns true if the frame is to be rendered.
    pub(crate) fn is_wanted(&self, frame: usize) -> bool {
        self.each.mask.as_ref().is_none_or(|mask| mask[frame])
    }

    /// Returns the seed of a frame.
    pub(crate) fn seed(&self, frame: usize) -> u64 {
        self.each.seeds[frame]
    }

    /// Returns the poses of sensor and instances at equally spaced times before the next frame, such that nothing turns
    /// far from one to the next. The two frames themselves are excluded; if nothing turns far between them, the result
    /// is empty.
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

    /// Lends the scene and poses of a frame.
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

//! A running simulation with robots.

use crate::data::Data;
use crate::errors::{of, value_error};
use crate::interrupt::Interrupt;
use crate::load::{self, Options};
use crate::pool::Threads;
use crate::poses;
use crate::world::World;
use belvedere::description::load::Described;
use belvedere::description::model;
use belvedere::entities::EntityId;
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{self, SpawnOptions};
use belvedere_sensors::Execution;
use glam::DVec3;
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::ThreadPoolBuilder;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// A simulation in its own thread, since parts of it cannot move to another thread.
#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct Simulation {
    jobs: Mutex<Sender<Job>>,
    /// The process that owns the thread; a forked child has no such thread.
    process: u32,
}

struct Inside {
    simulation: simulation::Simulation,
    /// The buffers that frames are rendered into.
    frames: Vec<FrameBuf>,
    notes: Vec<String>,
    /// How many notes of the simulation are among them, or are no warnings.
    looked_at: usize,
    /// The robot or object that was given as the world.
    thing: Option<String>,
}

/// The header of a frame, and its payload.
type Rendered<'py> = (Bound<'py, PyBytes>, Bound<'py, PyArray1<u8>>);

/// A task for the simulation's thread.
type Job = Box<dyn FnOnce(&mut Inside) + Send>;

impl Simulation {
    /// Runs a task in the simulation's thread and waits for it with the interpreter's lock released.
    fn with<T: Send + 'static>(
        &self,
        py: Python<'_>,
        job: impl FnOnce(&mut Inside) -> PyResult<T> + Send + 'static,
    ) -> PyResult<T> {
        self.with_interrupt(py, |inside, _| job(inside))
    }

    /// Runs a task that can be interrupted.
    fn with_interrupt<T: Send + 'static>(
        &self,
        py: Python<'_>,
        job: impl FnOnce(&mut Inside, &Interrupt) -> PyResult<T> + Send + 'static,
    ) -> PyResult<T> {
        if std::process::id() != self.process {
            return Err(PyRuntimeError::new_err(
                "the simulation belongs to the process from which this one was forked; create another one here",
            ));
        }
        py.detach(|| {
            let (answer, answered) = channel();
            let interrupt = Arc::new(Interrupt::default());
            let its_own = interrupt.clone();
            let job: Job = Box::new(move |inside| {
                // The receiver is waiting.
                let _ = answer.send(job(inside, &its_own));
            });
            let sent = self.jobs.lock().unwrap_or_else(PoisonError::into_inner).send(job);
            let answer = if sent.is_ok() { interrupt.wait(&answered)? } else { None };
            answer.unwrap_or_else(|| Err(PyRuntimeError::new_err("the simulation's thread has ended")))
        })
    }
}

/// Builds a simulation and runs tasks until all senders are gone.
fn live(
    build: impl FnOnce() -> PyResult<Inside>,
    ready: &Sender<PyResult<()>>,
    jobs: &Receiver<Job>,
    threads: usize,
) {
    // This thread also renders.
    let pool = ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build();
    let mut inside = match pool.map_err(|error| of("threads", error)).and_then(|pool| Ok((build()?, pool))) {
        Ok(inside) => inside,
        Err(error) => {
            let _ = ready.send(Err(error));
            return;
        }
    };
    let _ = ready.send(Ok(()));
    for job in jobs {
        job(&mut inside.0);
    }
}

impl Inside {
    fn find(&self, name: &str) -> PyResult<EntityId> {
        self.simulation.find(name).map_err(value_error)
    }
}

#[pymethods]
impl Simulation {
    /// Creates a simulation of a world by file, name or text, or of a robot in an empty world.
    #[new]
    fn new(
        py: Python<'_>,
        world: &str,
        seed: u64,
        gazebo_compat: bool,
        threads: usize,
        package_path: Vec<PathBuf>,
        models: PathBuf,
    ) -> PyResult<Self> {
        let (source, threads) = (world.to_owned(), Threads::count(threads));
        let build = move || {
            let options = Options { package_path, models, xacro_args: Vec::new() };
            let (described, notes) = load::load(&source, options)?;
            let (world, thing) = match described {
                Described::World(world) => (world, None),
                Described::Model(thing) => (model::World::empty(), Some(thing)),
            };
            let execution = if threads == 1 { Execution::default() } else { Execution::parallel() };
            let builder = simulation::Simulation::builder(world).seed(seed).gazebo_compat(gazebo_compat);
            let mut simulation = builder.execution(execution).build().map_err(value_error)?;
            let called = thing.as_ref().map(|thing| thing.name.clone());
            if let Some(thing) = thing {
                simulation.spawn(&thing, SpawnOptions::default()).map_err(value_error)?;
            }
            Ok(Inside { simulation, frames: Vec::new(), notes, looked_at: 0, thing: called })
        };
        let ((ready, is_ready), (sender, jobs)) = (channel(), channel());
        let thread = std::thread::Builder::new().name("belvedere-simulation".into());
        thread.spawn(move || live(build, &ready, &jobs, threads)).map_err(|error| of("threads", error))?;
        let built = py.detach(move || is_ready.recv());
        built.map_err(|_| PyRuntimeError::new_err("the simulation's thread has ended"))??;
        Ok(Self { jobs: Mutex::new(sender), process: std::process::id() })
    }

    /// Spawns a robot or an object and returns its name.
    fn spawn(
        &self,
        py: Python<'_>,
        source: &str,
        name: String,
        namespace: String,
        pose: PyReadonlyArrayDyn<'_, f64>,
        package_path: Vec<PathBuf>,
        models: PathBuf,
        xacro_args: Vec<(String, String)>,
    ) -> PyResult<String> {
        let world_from_model = poses::read("pose", &pose)?.into_iter().next().unwrap_or_default();
        let source = source.to_owned();
        self.with(py, move |inside| {
            let (described, notes) = load::load(&source, Options { package_path, models, xacro_args })?;
            let Described::Model(model) = described else {
                return Err(of(
                    "robot",
                    format_args!("{source} is a world; give a robot, or a model of SDF"),
                ));
            };
            let name = if name.is_empty() { model.name.clone() } else { name };
            let options = SpawnOptions { name: name.clone(), namespace, world_from_model, is_robot: None };
            inside.simulation.spawn(&model, options).map_err(value_error)?;
            inside.notes.extend(notes);
            Ok(name)
        })
    }

    #[getter]
    fn notes(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |inside| {
            let new = &inside.simulation.notes()[inside.looked_at..];
            inside.notes.extend(load::warnings(new));
            inside.looked_at += new.len();
            Ok(inside.notes.clone())
        })
    }

    /// Returns the robot or object that was given as the world.
    #[getter]
    fn thing(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.with(py, |inside| Ok(inside.thing.clone()))
    }

    #[getter]
    fn time_ns(&self, py: Python<'_>) -> PyResult<u64> {
        self.with(py, |inside| Ok(inside.simulation.time_ns()))
    }

    #[getter]
    fn models(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |inside| {
            Ok(inside.simulation.entities().iter().map(|(_, entity)| entity.name.clone()).collect())
        })
    }

    fn topics(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.with(py, |inside| inside.simulation.topics().map_err(value_error))
    }

    fn command(&self, py: Python<'_>, name: String, linear: f64, angular: f64) -> PyResult<()> {
        if !(linear.is_finite() && angular.is_finite()) {
            return Err(of("command", format_args!("({linear}, {angular}): finite numbers are expected")));
        }
        self.with(py, move |inside| {
            let id = inside.find(&name)?;
            inside.simulation.command(id, Command::new(linear, angular)).map_err(value_error)
        })
    }

    fn step(&self, py: Python<'_>, steps: u32) -> PyResult<()> {
        self.with_interrupt(py, move |inside, interrupt| {
            (0..steps).take_while(|_| !interrupt.is_set()).for_each(|_| inside.simulation.step());
            Ok(())
        })
    }

    fn run_for(&self, py: Python<'_>, time_ns: u64) -> PyResult<()> {
        self.with_interrupt(py, move |inside, interrupt| {
            let until_ns = inside.simulation.time_ns().saturating_add(time_ns);
            while inside.simulation.time_ns() < until_ns && !interrupt.is_set() {
                inside.simulation.step();
            }
            Ok(())
        })
    }

    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, |inside| inside.simulation.reset().map_err(value_error))
    }

    fn pose<'py>(&self, py: Python<'py>, name: String) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let pose =
            self.with(py, move |inside| inside.simulation.pose(inside.find(&name)?).map_err(value_error))?;
        Ok(PyArray1::from_slice(py, &poses::numbers(&pose)))
    }

    fn place(&self, py: Python<'_>, name: String, pose: PyReadonlyArrayDyn<'_, f64>) -> PyResult<()> {
        let pose = poses::read("pose", &pose)?.into_iter().next().unwrap_or_default();
        self.with(py, move |inside| {
            let id = inside.find(&name)?;
            inside.simulation.place(id, &pose, DVec3::ZERO, DVec3::ZERO).map_err(value_error)
        })
    }

    /// Renders the current frames of topics; topics of one sensor are of one frame. Returns the bytes of each header
    /// and its payload in owned memory, or `None` for a topic without a frame.
    fn render<'py>(&self, py: Python<'py>, topics: Vec<String>) -> PyResult<Vec<Option<Rendered<'py>>>> {
        let frames = self.with(py, move |inside| {
            let Inside { simulation, frames, .. } = inside;
            let topics: Vec<&str> = topics.iter().map(String::as_str).collect();
            frames.resize_with(topics.len().max(frames.len()), FrameBuf::default);
            let filled = simulation.render_all(&topics, frames).map_err(value_error)?;
            let copied =
                |frame: &FrameBuf| (bytemuck::bytes_of(frame.header()).to_vec(), frame.payload().to_vec());
            Ok(frames.iter().zip(filled).map(|(frame, is_filled)| is_filled.then(|| copied(frame))).collect())
        })?;
        let frames: Vec<Option<(Vec<u8>, Vec<u8>)>> = frames;
        let lent = |(header, payload): (Vec<u8>, Vec<u8>)| {
            (PyBytes::new(py, &header), PyArray1::from_vec(py, payload))
        };
        Ok(frames.into_iter().map(|frame| frame.map(lent)).collect())
    }

    /// Returns a copy of the current state as a world.
    fn world(&self, py: Python<'_>) -> PyResult<World> {
        self.with(py, |inside| Ok(World::of_data(Data::of_simulation(&mut inside.simulation))))
    }
}

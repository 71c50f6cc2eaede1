//! Threads, and their working memory.

use belvedere_sensors::scene::{Light, Material};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Execution, Pose};
use pyo3::prelude::*;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use crate::errors::{of, value_error};
use crate::interrupt::Interrupt;

/// For fewer rays no thread is woken, since that takes as long as tracing them.
const FEW_RAYS: usize = 20_000;

/// The number of pool sizes that are kept; the threads of other pools end when their work is done.
const KEPT: usize = 2;

static POOLS: Mutex<Pools> = Mutex::new(Pools { process: 0, recent: Vec::new() });

/// The most recently used pools.
struct Pools {
    /// The process that owns the threads.
    process: u32,
    /// Keyed by the number of threads; the most recent one is last.
    recent: Vec<(usize, Arc<ThreadPool>)>,
}

impl Pools {
    fn of_size(&mut self, count: usize) -> PyResult<Arc<ThreadPool>> {
        let process = std::process::id();
        if self.process != process {
            // A forked child has none of its parent's threads, so the end of their pools cannot be awaited.
            std::mem::forget(std::mem::take(&mut self.recent));
            self.process = process;
        }
        let pool = if let Some(index) = self.recent.iter().position(|(of, _)| *of == count) {
            self.recent.remove(index).1
        } else {
            let builder = ThreadPoolBuilder::new().num_threads(count);
            let pool = builder.thread_name(|index| format!("belvedere-{index}")).build();
            Arc::new(pool.map_err(|error| of("threads", error))?)
        };
        self.recent.push((count, pool.clone()));
        if self.recent.len() > KEPT {
            self.recent.remove(0);
        }
        Ok(pool)
    }
}

/// The working memory of a thread, which is kept so that later batches allocate nothing.
#[derive(Default)]
pub(crate) struct Memory {
    pub(crate) workspace: WorkspaceBuf,
    /// Poses of instances now, in the next and in the previous frame.
    pub(crate) poses: [Vec<Pose>; 3],
    /// Materials and lamps of a frame.
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
}

thread_local! {
    static MEMORY: Cell<Option<Box<Memory>>> = const { Cell::new(None) };
}

/// Lends this thread's memory. Work that is stolen meanwhile gets another one.
fn with_memory<T>(execution: Execution, work: impl FnOnce(&mut Memory) -> T) -> T {
    let mut memory = MEMORY.take().unwrap_or_default();
    memory.workspace.execution = execution;
    let done = work(&mut memory);
    MEMORY.set(Some(memory));
    done
}

/// A number of threads to work with.
#[derive(Clone)]
pub(crate) struct Threads(Option<Arc<ThreadPool>>);

impl Threads {
    /// Returns the number of threads; for 0, one per processor.
    pub(crate) fn count(threads: usize) -> usize {
        match threads {
            0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            count => count,
        }
    }

    /// Creates this number of threads; 0 means one per processor. Work with one thread, or with few rays, runs on the
    /// caller's thread.
    pub(crate) fn new(threads: usize, rays: usize) -> PyResult<Self> {
        // Counting processors reads files of the system, which takes longer than tracing few rays.
        if rays < FEW_RAYS {
            return Ok(Self(None));
        }
        let count = Self::count(threads);
        if count == 1 {
            return Ok(Self(None));
        }
        POOLS.lock().unwrap_or_else(PoisonError::into_inner).of_size(count).map(|pool| Self(Some(pool)))
    }

    /// Renders frames independently. If there are fewer frames than threads, several threads work on one. Returns the
    /// first error, or the exception of a signal handler, such as `KeyboardInterrupt` for Ctrl-C; other frames may have
    /// been written then.
    pub(crate) fn for_each<F: Send>(
        &self,
        frames: Vec<F>,
        work: impl Fn(usize, F, &mut Memory) -> Result<(), String> + Sync,
    ) -> PyResult<()> {
        let interrupt = Interrupt::default();
        let one = |execution, (index, frame)| {
            if interrupt.is_set() {
                return Ok(());
            }
            with_memory(execution, |memory| work(index, frame, memory))
        };
        let Some(pool) = &self.0 else {
            let mut looked = Instant::now();
            return frames.into_iter().enumerate().try_for_each(|frame| {
                interrupt.look(&mut looked)?;
                one(Execution::default(), frame).map_err(value_error)
            });
        };
        let ((sender, done), one) = (channel(), &one);
        let answer = pool.in_place_scope(|scope| {
            scope.spawn(move |_| {
                let done = if frames.len() < rayon::current_num_threads() {
                    frames.into_iter().enumerate().try_for_each(|frame| one(Execution::parallel(), frame))
                } else {
                    let frames = frames.into_par_iter().enumerate();
                    frames.try_for_each(|frame| one(Execution::default(), frame))
                };
                // The receiver is waiting.
                let _ = sender.send(done);
            });
            interrupt.wait(&done)
        })?;
        // The scope propagates the panic of a thread.
        answer.unwrap_or(Ok(())).map_err(value_error)
    }
}

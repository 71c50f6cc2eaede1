//! Threads, and the memory that each works in.

use belvedere_sensors::scene::{Light, Material};
use belvedere_sensors::trace::WorkspaceBuf;
use belvedere_sensors::{Execution, Pose};
use pyo3::PyResult;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::errors::of;

/// Of fewer rays no thread is woken: that takes as long as to trace them.
const FEW_RAYS: usize = 20_000;

/// Pools that were made, by process and number of threads. A forked child has none of its parent's threads, so it makes its
/// own.
static POOLS: Mutex<Option<Pools>> = Mutex::new(None);

type Pools = HashMap<(u32, usize), Arc<ThreadPool>>;

/// What a thread works in. It is kept, so that batch after batch nothing is allocated.
#[derive(Default)]
pub(crate) struct Memory {
    pub(crate) workspace: WorkspaceBuf,
    /// Where instances are now, then, and before.
    pub(crate) poses: [Vec<Pose>; 3],
    /// Other scratch, of bytes.
    pub(crate) bytes: Vec<u8>,
    /// How things look in a frame, and its lamps.
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
}

thread_local! {
    static MEMORY: Cell<Option<Box<Memory>>> = const { Cell::new(None) };
}

/// Lends this thread's memory. Work that is stolen while it is lent gets another.
fn with_memory<T>(execution: Execution, work: impl FnOnce(&mut Memory) -> T) -> T {
    let mut memory = MEMORY.take().unwrap_or_default();
    memory.workspace.execution = execution;
    let done = work(&mut memory);
    MEMORY.set(Some(memory));
    done
}

/// Threads to work with.
#[derive(Clone)]
pub(crate) struct Threads(Option<Arc<ThreadPool>>);

impl Threads {
    /// So many; for 0, one each processor.
    pub(crate) fn count(threads: usize) -> usize {
        match threads {
            0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            count => count,
        }
    }

    /// So many; 0 stands for one each processor. For one, and for few rays, the caller's own.
    pub(crate) fn new(threads: usize, rays: usize) -> PyResult<Self> {
        let count = Self::count(threads);
        if count == 1 || rays < FEW_RAYS {
            return Ok(Self(None));
        }
        let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
        let pools = pools.get_or_insert_default();
        let key = (std::process::id(), count);
        if let Some(pool) = pools.get(&key) {
            return Ok(Self(Some(pool.clone())));
        }
        let pool =
            ThreadPoolBuilder::new().num_threads(count).thread_name(|index| format!("belvedere-{index}"));
        let pool = Arc::new(pool.build().map_err(|error| of("threads", error))?);
        pools.insert(key, pool.clone());
        Ok(Self(Some(pool)))
    }

    /// Takes frames, each by itself. If there are fewer than threads, several work on one. The first error is the answer;
    /// other frames may have been written then.
    pub(crate) fn for_each<F: Send>(
        &self,
        frames: Vec<F>,
        work: impl Fn(usize, F, &mut Memory) -> Result<(), String> + Sync,
    ) -> Result<(), String> {
        let one_by_one = |frames: Vec<F>, execution| {
            frames
                .into_iter()
                .enumerate()
                .try_for_each(|(index, frame)| with_memory(execution, |memory| work(index, frame, memory)))
        };
        let Some(pool) = &self.0 else { return one_by_one(frames, Execution::default()) };
        pool.install(|| {
            if frames.len() < rayon::current_num_threads() {
                return one_by_one(frames, Execution::parallel());
            }
            frames.into_par_iter().enumerate().try_for_each(|(index, frame)| {
                with_memory(Execution::default(), |memory| work(index, frame, memory))
            })
        })
    }
}

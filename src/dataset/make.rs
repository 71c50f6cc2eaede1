//! Makes shards, several at a time.

use super::making::Making;
use super::shard::ShardWriter;
use super::studio::Studio;
use super::{DatasetError, Folder, Plan};
use belvedere_sensors::Execution;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Makes missing shards, up to `workers` of them at a time. The bytes do not depend on that number or on the order of
/// the shards.
///
/// # Errors
/// The first error of a worker; the shards that were complete by then are kept.
pub fn make(
    plan: &Plan,
    folder: &Folder,
    shards: &[u64],
    workers: NonZeroUsize,
    making: &dyn Making,
) -> Result<(), DatasetError> {
    let missing: Vec<u64> = shards.iter().copied().filter(|shard| !folder.has(*shard)).collect();
    let workers = workers.get().min(missing.len());
    let next = AtomicUsize::new(0);
    let has_failed = AtomicBool::new(false);
    let first_error = Mutex::new(None);
    let work = || {
        // A single worker uses all cores for each frame; several workers use one core each.
        let execution = if workers == 1 { Execution::parallel() } else { Execution::default() };
        let mut worker = Worker { plan, folder, execution, studio: None };
        while let Some(shard) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            let is_stopped = || has_failed.load(Ordering::Acquire) || making.is_stopped();
            if let Err(error) = worker.make(*shard, making, &is_stopped) {
                first_error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                // This stops the other workers; their errors come after this one and are ignored.
                has_failed.store(true, Ordering::Release);
                return;
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(work);
        }
    });
    first_error.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// A worker that makes shards.
struct Worker<'a> {
    plan: &'a Plan,
    folder: &'a Folder,
    execution: Execution,
    /// The world that was used last.
    studio: Option<Studio<'a>>,
}

impl Worker<'_> {
    fn make(
        &mut self,
        shard: u64,
        making: &dyn Making,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<(), DatasetError> {
        let mut writer = ShardWriter::create(&self.folder.shard(shard))?;
        for index in self.plan.samples_of(shard) {
            if is_stopped() {
                return Err(DatasetError::Stopped);
            }
            let sample = self.plan.sample(index);
            let studio = match self.studio.take().filter(|studio| studio.world() == sample.world) {
                Some(studio) => studio,
                None => Studio::open(self.plan, sample.world, self.execution)?,
            };
            let fields = self.studio.insert(studio).take(sample)?;
            writer.add(index, &fields)?;
            making.sample_done();
        }
        writer.finish()?;
        self.folder.sweep(shard);
        Ok(())
    }
}

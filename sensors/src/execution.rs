//! Options for how a frame is computed: SIMD level and threads. They never change the result.

use crate::simd::{Level, best_level};

/// The SIMD level and threads to use.
#[derive(Debug, Clone, Copy)]
pub struct Execution {
    /// The instruction set.
    pub level: Level,
    /// Uses all threads of the current rayon pool instead of only the calling one.
    #[cfg(feature = "rayon")]
    pub parallel: bool,
}

impl Default for Execution {
    /// The calling thread only, with the best instruction set available.
    fn default() -> Self {
        Self::at(best_level())
    }
}

impl Execution {
    /// The calling thread only, with this instruction set.
    pub fn at(level: Level) -> Self {
        Self {
            level,
            #[cfg(feature = "rayon")]
            parallel: false,
        }
    }

    /// Uses all threads of the current rayon pool.
    #[cfg(feature = "rayon")]
    pub fn parallel() -> Self {
        Self { parallel: true, ..Self::default() }
    }
}

impl Execution {
    /// The same execution on the calling thread only.
    #[cfg_attr(not(feature = "rayon"), allow(unused_mut, reason = "threads come with rayon"))]
    pub(crate) fn alone(mut self) -> Self {
        #[cfg(feature = "rayon")]
        {
            self.parallel = false;
        }
        self
    }
}

/// Output of a frame that can be split between rows of tiles, so that two threads can write to it.
pub(crate) trait SplitRows: Sized + Send {
    /// Splits off the first `rows` rows of tiles.
    fn split_rows(self, rows: usize) -> (Self, Self);
}

/// Splits an output if it is requested.
pub(crate) fn split_at<T>(values: Option<&mut [T]>, at: usize) -> (Option<&mut [T]>, Option<&mut [T]>) {
    values.map(|values| values.split_at_mut(at.min(values.len()))).unzip()
}

/// Calls `work` for each row of tiles, with the part of `output` that is the row's.
#[cfg_attr(not(feature = "rayon"), allow(unused_variables, reason = "threads come with rayon"))]
pub(crate) fn for_each_row<O: SplitRows>(
    execution: Execution,
    rows: core::ops::Range<usize>,
    output: O,
    work: &(impl Fn(usize, O) + Sync),
) {
    #[cfg(feature = "rayon")]
    if execution.parallel {
        on_threads(rows, output, work);
        return;
    }
    let (mut row, mut rest) = (rows.start, output);
    while row + 1 < rows.end {
        let (own, below) = rest.split_rows(1);
        work(row, own);
        (row, rest) = (row + 1, below);
    }
    if row < rows.end {
        work(row, rest);
    }
}

/// The same with many threads: the rows are halved again and again until one is left, and at each cut another thread
/// may take one of the halves. This allocates nothing.
#[cfg(feature = "rayon")]
fn on_threads<O: SplitRows>(rows: core::ops::Range<usize>, output: O, work: &(impl Fn(usize, O) + Sync)) {
    match rows.len() {
        0 => {}
        1 => work(rows.start, output),
        count => {
            let middle = rows.start + count / 2;
            let (upper, lower) = output.split_rows(count / 2);
            rayon::join(
                || on_threads(rows.start..middle, upper, work),
                || on_threads(middle..rows.end, lower, work),
            );
        }
    }
}

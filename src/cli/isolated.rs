//! What only shows a run: where it panics, the run goes on without it.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// A display of a run.
pub(super) struct Isolated<T> {
    what: &'static str,
    /// None once it has panicked.
    display: Option<T>,
}

impl<T> Isolated<T> {
    /// Makes a display, which errors call by this name.
    pub(super) fn new(what: &'static str, make: impl FnOnce() -> T) -> Self {
        let mut isolated = Self { what, display: None };
        isolated.display = isolated.caught(make);
        isolated
    }

    /// Lets it show what is now, unless it has panicked before.
    pub(super) fn show(&mut self, show: impl FnOnce(&mut T)) {
        if let Some(mut display) = self.display.take() {
            self.display = self.caught(move || {
                show(&mut display);
                display
            });
        }
    }

    /// Ends it, and gives what it leaves, if it has not panicked.
    pub(super) fn end<R>(mut self, end: impl FnOnce(T) -> R) -> Option<R> {
        let display = self.display.take()?;
        self.caught(move || end(display))
    }

    /// What is done, unless it panics, which is told: the display is not used again then.
    fn caught<R>(&self, work: impl FnOnce() -> R) -> Option<R> {
        let what = self.what;
        catch_unwind(AssertUnwindSafe(work))
            .inspect_err(|_| {
                tracing::error!("{what} has panicked and is left out from now on; the simulation goes on");
            })
            .ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_panics_is_left_out_from_then_on() {
        let mut shown = 0;
        let mut display = Isolated::new("the counter", || vec![1, 2]);
        for place in [0, 1, 2, 0] {
            display.show(|values| shown += values[place]);
        }
        assert_eq!((shown, display.end(|values| values.len())), (3, None));
        let ended = Isolated::new("the counter", || 7).end(|value| value + 1);
        assert_eq!(ended, Some(8));
        assert!(Isolated::new("the counter", || Vec::<u8>::new()[0]).end(|_| ()).is_none());
    }
}

//! [`Isolated`]: a display of a run that is dropped if it panics, so that the run continues.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// A display of a run, isolated from its panics.
pub(super) struct Isolated<T> {
    what: &'static str,
    /// `None` after a panic.
    display: Option<T>,
}

impl<T> Isolated<T> {
    /// Creates a display. `what` names it in error messages.
    pub(super) fn new(what: &'static str, make: impl FnOnce() -> T) -> Self {
        let mut isolated = Self { what, display: None };
        isolated.display = isolated.caught(make);
        isolated
    }

    /// Updates the display, unless it has panicked before.
    pub(super) fn show(&mut self, show: impl FnOnce(&mut T)) {
        if let Some(mut display) = self.display.take() {
            self.display = self.caught(move || {
                show(&mut display);
                display
            });
        }
    }

    /// Ends the display and returns the result of `end`, unless it has panicked.
    pub(super) fn end<R>(mut self, end: impl FnOnce(T) -> R) -> Option<R> {
        let display = self.display.take()?;
        self.caught(move || end(display))
    }

    /// Runs `work`. If it panics, logs the panic and returns `None`; the display is then not used again.
    fn caught<R>(&self, work: impl FnOnce() -> R) -> Option<R> {
        let what = self.what;
        catch_unwind(AssertUnwindSafe(work))
            .inspect_err(|_| {
                tracing::error!("{what} panicked and is switched off; the simulation continues");
            })
            .ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_display_that_panics_is_not_used_again() {
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

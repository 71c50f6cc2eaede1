//! [`Cost`]: estimates the time that a repeated task takes.

use std::time::Duration;

/// Divisor of the difference by which the estimate decreases when the task takes less time.
const FORGETTING: u32 = 16;

/// The time that a task may take next: the longest recent one.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cost(Duration);

impl Cost {
    /// Adds a measured time.
    pub fn add(&mut self, took: Duration) {
        self.0 = took.max(self.0.saturating_sub(self.0.saturating_sub(took) / FORGETTING));
    }

    /// Returns the time that the task may take next.
    pub fn expected(&self) -> Duration {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_at_once_and_shrinks_slowly() {
        let ms = Duration::from_millis;
        let mut cost = Cost::default();
        cost.add(ms(32));
        assert_eq!(cost.expected(), ms(32));
        cost.add(ms(16));
        assert_eq!(cost.expected(), ms(31));
        (0..100).for_each(|_| cost.add(ms(16)));
        assert!(cost.expected() < ms(16) + Duration::from_micros(50), "{cost:?}");
    }
}

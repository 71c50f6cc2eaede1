//! [`Pacer`]: keeps simulated time in step with the wall clock.

use super::follow::{NAP, stop_wanted};
use crate::server::Server;
use crate::server::post::Post;
use std::time::{Duration, Instant};

/// Largest lag that is caught up. Any larger lag is skipped, to avoid a burst of frames.
const GIVE_UP: Duration = Duration::from_millis(200);
/// Longest time by which the simulation runs ahead. Commands that arrive meanwhile take effect later by this time.
const LONGEST_LEAD: Duration = Duration::from_millis(50);
/// Added to the previous cost of physics and rendering, which may vary.
const MARGIN: Duration = Duration::from_millis(3);

/// Lets the simulation run ahead by the time that the next frames take to make, and holds the frames until they are
/// due, so that they arrive in the rhythm of their timestamps, however long each takes to render.
pub(super) struct Pacer<'a> {
    epoch: u64,
    /// A moment of the wall clock; `time_ns` is the simulated time at it.
    at: Instant,
    time_ns: u64,
    /// Holds frames until they are due. Without it, frames are not made ahead of time.
    post: Option<&'a Post>,
}

impl<'a> Pacer<'a> {
    pub(super) fn new(server: &Server<'_>, post: Option<&'a Post>) -> Self {
        Self { epoch: server.epoch(), at: Instant::now(), time_ns: server.time_ns(), post }
    }

    /// Waits until the next step has to be computed. Returns false if the user asked to stop.
    pub(super) fn wait_for_next(&mut self, server: &Server<'_>) -> bool {
        if self.epoch != server.epoch() {
            *self = Self::new(server, self.post);
        }
        let due = self.at + Duration::from_nanos(server.next_ns().saturating_sub(self.time_ns));
        let lead = self.post.map_or(Duration::ZERO, |post| {
            post.set_due(due);
            server.cost().saturating_add(MARGIN).min(LONGEST_LEAD)
        });
        loop {
            if stop_wanted() {
                return false;
            }
            let now = Instant::now();
            let wait = due.saturating_duration_since(now).saturating_sub(lead);
            if wait.is_zero() {
                let late = now.saturating_duration_since(due);
                if late > GIVE_UP {
                    self.at += late;
                }
                return true;
            }
            std::thread::sleep(NAP.min(wait));
        }
    }
}

//! Keeping simulated time to the clock on the wall.

use super::follow::{NAP, stop_wanted};
use crate::server::Server;
use crate::server::post::Post;
use std::time::{Duration, Instant};

/// Lag beyond which lost time is given up instead of being caught up with in a burst.
const GIVE_UP: Duration = Duration::from_millis(200);
/// Longest time by which simulation goes ahead. What comes to a robot meanwhile moves it so much later.
const LONGEST_LEAD: Duration = Duration::from_millis(50);
/// Added to what physics and rendering took before: they may take a little longer this time.
const MARGIN: Duration = Duration::from_millis(3);

/// Lets the simulation go ahead by the time that the next frames take to make, and holds them until they are due: they
/// arrive in the rhythm of their stamps, whatever each of them shows.
pub(super) struct Pacer<'a> {
    epoch: u64,
    /// A moment, and the simulated time that belongs to it.
    at: Instant,
    time_ns: u64,
    /// What holds frames; without it, they are not made ahead of their time.
    post: Option<&'a Post>,
}

impl<'a> Pacer<'a> {
    pub(super) fn new(server: &Server<'_>, post: Option<&'a Post>) -> Self {
        Self { epoch: server.epoch(), at: Instant::now(), time_ns: server.time_ns(), post }
    }

    /// Waits until it is time to make what is next; false when the user wants to stop.
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

//! Checks that two cores are idle.

use super::clock::Clock;

/// The duration of each check.
const LOOK_S: f64 = 0.03;
/// The number of checks, of which the best counts.
const LOOKS: usize = 10;

/// The number of idle cores that are needed to measure two threads.
const IDLE_CORES: f64 = 1.9;

/// Returns the reason why two threads cannot be measured, if there is one.
pub fn lacking() -> Option<String> {
    let cores = cores();
    (cores < IDLE_CORES).then(|| format!("only {cores:.1} cores are idle"))
}

/// Checks that the machine is idle: figures of a busy machine are wrong in either direction.
///
/// # Errors
/// If two cores are not idle.
pub fn require() -> Result<(), String> {
    let error =
        |why| format!("nothing is recorded on a busy machine, and {why}: end what else runs, and try again");
    lacking().map_or(Ok(()), |why| Err(error(why)))
}

/// Returns the number of cores that two busy threads got: 2 on an idle machine with two or more cores.
fn cores() -> f64 {
    (0..LOOKS).map(|_| look()).fold(0.0, f64::max)
}

fn look() -> f64 {
    let spin = || {
        let (start_s, cpu_s) = (Clock::Wall.now_s(), Clock::Thread.now_s());
        while Clock::Wall.now_s() - start_s < LOOK_S {}
        (Clock::Thread.now_s() - cpu_s) / (Clock::Wall.now_s() - start_s)
    };
    std::thread::scope(|scope| {
        let other = scope.spawn(spin);
        spin() + other.join().unwrap_or(0.0)
    })
}

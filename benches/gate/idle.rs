//! Whether two cores are ours to measure with.

use super::clock::Clock;

/// How long each look takes.
const LOOK_S: f64 = 0.03;
/// The best of so many looks counts.
const LOOKS: usize = 10;

/// A machine with less to spare says nothing about two threads.
const IDLE_CORES: f64 = 1.9;

/// Why nothing can be said about two threads, if so.
pub fn lacking() -> Option<String> {
    let cores = cores();
    (cores < IDLE_CORES).then(|| format!("only {cores:.1} cores are idle"))
}

/// A record that is measured on a busy machine would be too low, and a best too high.
///
/// # Errors
/// When two cores are not idle.
pub fn require() -> Result<(), String> {
    let error =
        |why| format!("nothing is recorded on a busy machine, and {why}: end what else runs, and try again");
    lacking().map_or(Ok(()), |why| Err(error(why)))
}

/// Cores that two threads got when they did nothing but work: 2 on an idle machine of two or more.
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

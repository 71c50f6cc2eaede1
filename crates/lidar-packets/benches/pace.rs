//! Checks the speed of encoding on one core: every layout must take less than four cycles per byte, which is 1 GB/s at
//! 4 GHz. The reference, measured in the same run, is FNV-1a: its multiplication and exclusive or for each byte depend
//! on those of the byte before, and take four cycles on every processor. The exit code is 1 if a layout is slower.

#[path = "../tests/packets/columns.rs"]
#[allow(dead_code, reason = "the tests use what the benchmark does not")]
mod columns;

use columns::{Columns, Encoder, OUSTER, VELODYNE};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;
use std::process::ExitCode;

/// The number of bytes that are hashed in a round, and the least number that are encoded.
const BYTES: usize = 1 << 18;
const ROUNDS: usize = 21;

fn main() -> ExitCode {
    let velodynes = VELODYNE.map(|(model, mode)| {
        let name = format!("{model:?} {mode:?}");
        (name, Encoder::velodyne(model, mode), model.lasers(), mode.returns())
    });
    let ousters =
        OUSTER.map(|(profile, returns)| (profile.name().to_owned(), Encoder::ouster(profile), 128, returns));
    let mut is_fast = true;
    println!("{:<28} {:>6} {:>18}", "layout", "GB/s", "times FNV-1a");
    for (name, mut encoder, lasers, returns) in velodynes.into_iter().chain(ousters) {
        let columns = Columns::any(64, lasers, returns);
        let mut number = 0;
        let [gigabytes_s, ratio] = pace(|| {
            (0..64).fold(0, |bytes, _| {
                number = (number + 1) % 1024;
                let packet = encoder.push(black_box(&columns.column(number))).expect("columns fit");
                bytes + packet.map_or(0, |packet| black_box(packet).len())
            })
        });
        let verdict = if ratio > 1.0 { "" } else { "  TOO SLOW" };
        println!("{name:<28} {gigabytes_s:>6.2} {ratio:>18.2}{verdict}");
        is_fast &= ratio > 1.0;
    }
    if is_fast { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Measures the speed of `encode`, which returns the number of bytes that it has encoded. Returns the speed in GB/s, and
/// as a multiple of the speed of FNV-1a. Both are measured alternately, in processor time of the thread. The best round
/// counts, because other threads on the same core can only slow it down.
fn pace(mut encode: impl FnMut() -> usize) -> [f64; 2] {
    let bytes = vec![7_u8; BYTES];
    let mut best = [0.0_f64; 2];
    for _ in 0..ROUNDS {
        let mut made = 0;
        let encoding_s = timed(|| {
            while made < BYTES {
                made += encode();
            }
        });
        let hashing_s = timed(|| {
            black_box(fnv_1a(black_box(&bytes)));
        });
        let rate = made as f64 / encoding_s;
        best = [best[0].max(rate * 1e-9), best[1].max(rate * hashing_s / BYTES as f64)];
    }
    best
}

fn fnv_1a(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3))
}

/// Returns the processor time of a call, in seconds.
fn timed(call: impl FnOnce()) -> f64 {
    let now_s = || {
        let now = clock_gettime(ClockId::ThreadCPUTime);
        now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
    };
    let started_s = now_s();
    call();
    now_s() - started_s
}

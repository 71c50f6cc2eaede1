//! For tests: how fast packets and clouds are encoded, beside a loop that takes as long on every processor.

use crate::description::load;
use crate::description::model::{Lidar, SensorKind};
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// Bytes that are hashed in a round, and at least encoded.
const BYTES: usize = 1 << 18;
const ROUNDS: usize = 21;

/// A lidar with a preset and whatever else stands beside that.
pub(super) fn lidar(own: &str) -> Lidar {
    let model = format!(
        "<sdf version='1.6'><model name='m'><link name='l'><sensor name='s' type='ray'>
         <plugin filename='belvedere'>{own}</plugin></sensor></link></model></sdf>"
    );
    let SensorKind::Ray(lidar) = load::model(&model).unwrap().sensors.remove(0).kind else { panic!() };
    lidar
}

/// Bytes a second that `encode` makes, which tells how many it has made, in GB/s and as a multiple of those that FNV-1a
/// hashes. That is a multiplication and an exclusive or a byte, one after the other: four cycles, 1 GB/s at 4 GHz. Of rounds
/// that take both in turns, in processor time of the thread, the best: other threads of the same core only slow it down.
#[cfg(not(debug_assertions))]
pub(super) fn pace(mut encode: impl FnMut() -> usize) -> [f64; 2] {
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

/// Seconds of the processor's time.
fn timed(call: impl FnOnce()) -> f64 {
    let now_s = || {
        let now = clock_gettime(ClockId::ThreadCPUTime);
        now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
    };
    let started_s = now_s();
    call();
    now_s() - started_s
}

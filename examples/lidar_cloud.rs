//! What the lidar of a robot measures while that stands in a world, for other programs to hold packets against: of each
//! firing that hits, time in s, x, y, z, ring, as f64, little-endian.
//!
//! `cargo run --example lidar_cloud -- ROBOT WORLD TOPIC FRAMES > cloud.bin`: frames of a tenth of a second, from time 0 on.

use belvedere::description::read;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, world, topic, frames] = &arguments[..] else {
        return Err("give ROBOT WORLD TOPIC FRAMES".into());
    };
    let mut simulation = Simulation::builder(read::world(world)?).seed(1).build()?;
    simulation.spawn(&read::robot(robot)?, SpawnOptions::default())?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut frame = FrameBuf::default();
    for number in 0..frames.parse::<u64>()? {
        simulation.run_until(number * 100_000_000);
        simulation.render(topic, &mut frame)?;
        let stamp_s = frame.header().stamp_ns as f64 * 1e-9;
        let view = frame.view();
        for point in view.numbers::<[u8; 22]>(view.rows()) {
            let float = |at: usize| {
                f64::from(f32::from_le_bytes([point[at], point[at + 1], point[at + 2], point[at + 3]]))
            };
            let ring = f64::from(u16::from_le_bytes([point[16], point[17]]));
            for value in [stamp_s + float(18), float(0), float(4), float(8), ring] {
                out.write_all(&value.to_le_bytes())?;
            }
        }
    }
    out.flush()?;
    Ok(())
}

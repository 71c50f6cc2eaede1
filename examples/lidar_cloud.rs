//! What the lidar of a robot measures while that stands in a world, for other programs to hold packets against: of each
//! point of its clouds time in s, x, y, z, ring, as f64, little-endian; then its intensity, of an Ouster's range in mm and
//! reflectivity, and after the points of a frame those of its second returns.
//!
//! `cargo run --example lidar_cloud -- ROBOT WORLD TOPIC FRAMES HZ > cloud.bin`: so many frames a second, from time 0 on.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::Encoding;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, world, topic, frames, rate_hz] = &arguments[..] else {
        return Err("give ROBOT WORLD TOPIC FRAMES HZ".into());
    };
    let hz = rate_hz.parse::<u64>()?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut frame = FrameBuf::default();
    // Ouster's have a cloud a return. Each is taken of a simulation of its own: what is asked for is always the next frame.
    let topics = [topic.clone(), format!("{topic}2")];
    let mut simulations = Vec::new();
    for topic in topics {
        let mut simulation = Simulation::builder(load::world(world)?).seed(1).build()?;
        simulation.spawn(&load::robot(robot)?, SpawnOptions::default())?;
        simulations.push((topic, simulation));
    }
    for number in 0..frames.parse::<u64>()? {
        for index in 0..simulations.len() {
            let (topic, simulation) = &mut simulations[index];
            simulation.run_until(number * 1_000_000_000 / hz);
            match simulation.render(topic, &mut frame) {
                Err(_) if index == 1 => drop(simulations.pop()),
                rendered => {
                    rendered?;
                    write(&frame, &mut out)?;
                }
            }
        }
    }
    out.flush()?;
    Ok(())
}

fn write(frame: &FrameBuf, out: &mut impl Write) -> std::io::Result<()> {
    let stamp_s = frame.header().stamp_ns as f64 * 1e-9;
    let view = frame.view();
    let mut write = |values: &[f64]| out.write_all(bytemuck::cast_slice(values));
    if view.header().encoding() == Some(Encoding::OusterPoint) {
        for point in view.numbers::<[u8; 48]>(view.rows()) {
            let [x, y, z] = place(&point);
            let (time_ns, reflectivity) = (at::<u32>(&point, 20), at::<u16>(&point, 24));
            let (ring, range) = (at::<u16>(&point, 26), at::<u32>(&point, 32));
            let time_s = (frame.header().stamp_ns + u64::from(time_ns)) as f64 * 1e-9;
            write(&[time_s, x, y, z, ring.into(), range.into(), reflectivity.into()])?;
        }
    } else {
        for point in view.numbers::<[u8; 22]>(view.rows()) {
            let [x, y, z] = place(&point);
            let time_s = stamp_s + f64::from(at::<f32>(&point, 18));
            write(&[time_s, x, y, z, at::<u16>(&point, 16).into(), at::<f32>(&point, 12).into()])?;
        }
    }
    Ok(())
}

/// A number in a point, at a byte of it.
fn at<T: bytemuck::AnyBitPattern>(point: &[u8], at: usize) -> T {
    bytemuck::pod_read_unaligned(&point[at..at + size_of::<T>()])
}

fn place(point: &[u8]) -> [f64; 3] {
    at::<[f32; 3]>(point, 0).map(f64::from)
}

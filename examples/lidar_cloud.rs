//! Writes the clouds of a robot's lidar while the robot stands still, so that other programs can compare packets with
//! them. Each point is written as little-endian f64: time in s, x, y, z, ring, intensity. A point of an Ouster has range
//! in mm and reflectivity instead of the intensity, and the points of a frame are followed by those of its second returns.
//!
//! `cargo run --example lidar_cloud -- ROBOT WORLD TOPIC FRAMES HZ > cloud.bin` writes FRAMES frames at a rate of HZ, from
//! time 0 on.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::Encoding;
use belvedere_bridge::point::{OusterPoint, XyzIrtPoint};
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, world, topic, frames, rate_hz] = &arguments[..] else {
        return Err("give ROBOT WORLD TOPIC FRAMES HZ".into());
    };
    let hz = rate_hz.parse::<u64>()?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut frame = FrameBuf::default();
    // An Ouster has one cloud for each return. Each is rendered in its own simulation, because every call of `render`
    // renders the next frame.
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
        for bytes in view.numbers(view.rows()) {
            let point = OusterPoint::from_bytes(&bytes);
            let [x, y, z] = point.xyz().map(f64::from);
            let time_s = (frame.header().stamp_ns + u64::from(point.t)) as f64 * 1e-9;
            write(&[time_s, x, y, z, point.ring.into(), point.range.into(), point.reflectivity.into()])?;
        }
    } else {
        for bytes in view.numbers(view.rows()) {
            let point = XyzIrtPoint::from_bytes(&bytes);
            let [x, y, z] = point.xyz().map(f64::from);
            let time_s = stamp_s + f64::from(point.time);
            write(&[time_s, x, y, z, point.ring.into(), point.intensity.into()])?;
        }
    }
    Ok(())
}

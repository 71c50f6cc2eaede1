//! Writes the readings of a robot's inertial unit while the robot stands still, so that other programs can compare
//! packets with them. Each message gives the time in ns, the specific force in m/s² and the angular velocity in rad/s, as
//! little-endian f64.
//!
//! `cargo run --example imu_readings -- ROBOT WORLD TOPIC MESSAGES HZ > imu.bin` writes MESSAGES messages at a rate of HZ,
//! from time 0 on.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::Imu;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, world, topic, messages, rate_hz] = &arguments[..] else {
        return Err("give ROBOT WORLD TOPIC MESSAGES HZ".into());
    };
    let hz = rate_hz.parse::<u64>()?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut frame = FrameBuf::default();
    let mut simulation = Simulation::builder(load::world(world)?).seed(1).build()?;
    simulation.spawn(&load::robot(robot)?, SpawnOptions::default())?;
    for number in 0..messages.parse::<u64>()? {
        simulation.run_until(number * 1_000_000_000 / hz);
        simulation.render(topic, &mut frame)?;
        let stamp_ns = frame.header().stamp_ns as f64;
        let [imu] = bytemuck::cast_slice::<u8, Imu>(frame.view().payload()) else {
            return Err(format!("{topic} has no message of an inertial unit").into());
        };
        let values = [&[stamp_ns][..], &imu.linear_acceleration, &imu.angular_velocity].concat();
        out.write_all(bytemuck::cast_slice(&values))?;
    }
    out.flush()?;
    Ok(())
}

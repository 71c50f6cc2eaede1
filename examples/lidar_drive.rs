//! Writes the clouds of a robot's lidar while the robot drives and turns, and its true poses, so that lidar odometry can be
//! compared with them. All numbers are little-endian f64.
//!
//! `cargo run --example lidar_drive -- ROBOT WORLD TOPIC SPEED TURN PERIOD SECONDS > drive.bin`
//!
//! The robot drives at SPEED m/s. It turns alternately to the left and to the right, at up to TURN rad/s, with a period of
//! PERIOD s. The first second, in which it accelerates, is left out. Each frame, 10 per second, has:
//!
//! 1. the number of physics steps since the previous frame, and the number of points;
//! 2. for each step: its time, and position and quaternion (x, y, z, w) of the robot;
//! 3. for each point: its time, and its position in the axes of the lidar at that time.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::point::XyzIrtPoint;
use std::f64::consts::TAU;
use std::io::{BufWriter, Write};

const FRAME_NS: u64 = 100_000_000;
/// The number of frames until the robot drives steadily.
const STARTING: u64 = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, world, topic, numbers @ ..] = &arguments[..] else {
        return Err("give ROBOT WORLD TOPIC SPEED TURN PERIOD SECONDS".into());
    };
    let numbers: Vec<f64> = numbers.iter().map(|number| number.parse()).collect::<Result<_, _>>()?;
    let [speed, turn, period, seconds] = numbers[..] else {
        return Err("give SPEED TURN PERIOD SECONDS".into());
    };
    let mut simulation = Simulation::builder(load::world(world)?).seed(1).build()?;
    let robot = simulation.spawn(&load::robot(robot)?, SpawnOptions::default())?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let (mut frame, mut steps) = (FrameBuf::default(), Vec::new());
    // From the first rendered frame on, physics keeps the history that later frames need.
    simulation.render(topic, &mut frame)?;
    let frames = (seconds * 1e9) as u64 / FRAME_NS;
    for number in 1..=STARTING + frames {
        while simulation.time_ns() < number * FRAME_NS {
            let share = simulation.time_ns() as f64 * 1e-9 / period;
            simulation.command(robot, Command::new(speed, turn * (TAU * share).cos()))?;
            simulation.step();
            let pose = simulation.pose(robot)?;
            let ([x, y, z], turn) = (pose.translation().to_array(), pose.rotation());
            steps.push([simulation.time_ns() as f64 * 1e-9, x, y, z, turn.x, turn.y, turn.z, turn.w]);
        }
        simulation.render(topic, &mut frame)?;
        let (view, stamp_s) = (frame.view(), frame.header().stamp_ns as f64 * 1e-9);
        if number <= STARTING {
            steps.clear();
            continue;
        }
        let points: Vec<[f64; 4]> = view
            .numbers(view.rows())
            .map(|bytes| {
                let point = XyzIrtPoint::from_bytes(&bytes);
                [stamp_s + f64::from(point.time), point.x.into(), point.y.into(), point.z.into()]
            })
            .collect();
        out.write_all(bytemuck::cast_slice(&[steps.len() as f64, points.len() as f64]))?;
        out.write_all(bytemuck::cast_slice(&steps))?;
        out.write_all(bytemuck::cast_slice(&points))?;
        steps.clear();
    }
    out.flush()?;
    Ok(())
}

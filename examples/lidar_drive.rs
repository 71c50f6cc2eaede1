//! What the lidar of a robot measures while that drives and turns, and where it was at each step of physics: for odometry by
//! lidar to be held against. Numbers are f64, little-endian.
//!
//! `cargo run --example lidar_drive -- ROBOT WORLD TOPIC SPEED TURN PERIOD SECONDS > drive.bin`: the robot drives at SPEED
//! m/s and turns to the left and to the right in PERIOD s, at up to TURN rad/s; its first second, in which it gets going, is
//! left out. Of each frame, 10 a second, there are the number of steps since the one before and the number of points; then
//! the steps' time, place and quaternion (x, y, z, w) of the robot; then time and place of each point, in the axes of the
//! lidar at that time.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{Simulation, SpawnOptions};
use std::f64::consts::TAU;
use std::io::{BufWriter, Write};

const FRAME_NS: u64 = 100_000_000;
/// Frames until it goes evenly.
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
    // From now on physics remembers.
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
            .numbers::<[u8; 22]>(view.rows())
            .map(|bytes| {
                let at = |at: usize| {
                    f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]))
                };
                [stamp_s + at(18), at(0), at(4), at(8)]
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

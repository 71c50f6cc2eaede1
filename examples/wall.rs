//! A robot drives at a wall and measures its distance: no other process, no shared memory, no clock.
//!
//! `cargo run --release --example wall`

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::robot::Command;
use belvedere::simulation::{Simulation, SpawnOptions};
use std::time::Duration;

const WALL: &str =
    "<sdf version='1.6'><model name='wall'><pose>2 0 0.5 0 0 0</pose><static>true</static><link name='l'>
  <collision name='c'><geometry><box><size>0.2 4 1</size></box></geometry></collision></link></model></sdf>";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::builder(load::world("empty")?).seed(1).build()?;
    simulation.spawn(&load::model(WALL)?, SpawnOptions::default())?;
    let robot = simulation.spawn(&load::robot("kobuki_nostack_rplidar")?, SpawnOptions::default())?;
    let mut scan = FrameBuf::default();
    for second in 0..=3 {
        simulation.render("/scan", &mut scan)?;
        let view = scan.view();
        let ranges: Vec<f32> = view.numbers(view.rows()).collect();
        // The middle beam points straight ahead, because the first one points backwards.
        let ahead = ranges[ranges.len() / 2];
        let x = simulation.pose(robot)?.translation().x;
        println!("{second} s: the robot is at {x:.2} m, the wall {ahead:.3} m in front of its lidar");
        // The face of the wall is at 1.9 m, and the lidar 0.1 m in front of the robot's centre.
        assert!(
            (f64::from(ahead) + x - 1.8).abs() < 0.03,
            "the scan is wrong by more than the lidar's noise"
        );
        for _ in 0..10 {
            simulation.command(robot, Command::new(0.3, 0.0))?;
            simulation.run_for(Duration::from_millis(100));
        }
    }
    Ok(())
}

//! Spawns and deletes models ten thousand times. It is a program of its own, because it measures the memory of its
//! process.

use belvedere::description::load;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SimulationError, SpawnOptions};

/// Deleted models leave nothing behind: their indices are reused, and memory does not grow.
#[test]
fn ten_thousand_models_come_and_go() {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let guest =
        || SpawnOptions { name: "guest".into(), namespace: "guest".into(), ..SpawnOptions::default() };
    let model = load::model(
        "<robot name='pillar'><link name='base'>
          <inertial><mass value='1'/><inertia ixx='.1' iyy='.1' izz='.1' ixy='0' ixz='0' iyz='0'/></inertial>
          <collision><geometry><box size='.2 .2 1'/></geometry></collision></link>
          <gazebo reference='base'><sensor type='ray' name='laser'><update_rate>10</update_rate>
            <ray><scan><horizontal><samples>16</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
              <range><min>.1</min><max>9</max></range></ray>
            <plugin name='laser' filename='libgazebo_ros_laser.so'><topicName>scan</topicName></plugin></sensor></gazebo></robot>",
    )
    .unwrap();
    let mut gone = None;
    let mut first_kib = 0;
    for round in 0..10_000 {
        let id = simulation.spawn(&model, guest()).unwrap();
        simulation.step();
        if round % 1000 == 0 {
            let mut scan = FrameBuf::default();
            simulation.render("/guest/scan", &mut scan).unwrap();
        }
        simulation.delete(id).unwrap();
        gone = Some(id);
        if round == 1000 {
            first_kib = resident_kib();
        }
    }
    let grown = resident_kib().saturating_sub(first_kib);
    println!("9,000 rounds: {grown} KiB more");
    assert!(grown < 1024, "{grown} KiB more");
    // Ids are not reused.
    let id = simulation.spawn(&model, guest()).unwrap();
    assert!(matches!(simulation.pose(gone.unwrap()), Err(SimulationError::Gone)));
    assert!(simulation.pose(id).is_ok());
}

fn resident_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").trim().parse().unwrap()
}

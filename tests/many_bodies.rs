//! The cost of many bodies: compared with physics when all move, and at the start and during the run when all sleep.

use belvedere::description::load;
use belvedere::description::model::World;
use belvedere::server::{Server, ServerOptions};
use belvedere::simulation::Simulation;
use belvedere_bridge::{Domain, Kind, Node, StreamSpec, Subscriber};
use belvedere_sensors::Execution;
use glam::DVec3;
use rustix::time::{ClockId, clock_gettime};
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Milliseconds of processor time of this thread, which does all the work, so other programs do not count.
fn milliseconds(work: impl FnOnce()) -> f64 {
    let now_ms = || {
        let now = clock_gettime(ClockId::ThreadCPUTime);
        now.tv_sec as f64 * 1e3 + now.tv_nsec as f64 * 1e-6
    };
    let before_ms = now_ms();
    work();
    now_ms() - before_ms
}

/// A world of alternating simple shapes on a plane, `spacing` apart in a square; and the text of the file.
fn shapes(count: usize, spacing: f64, more: &str) -> String {
    let mut text = format!("<sdf version='1.6'><world name='shapes'>{more}");
    let side = (count as f64).sqrt().ceil() as usize;
    for index in 0..count {
        let (x, y) = ((index % side) as f64 * spacing, (index / side) as f64 * spacing);
        let shape = [
            "<box><size>1 1 1</size></box>",
            "<sphere><radius>0.5</radius></sphere>",
            "<cylinder><radius>0.5</radius><length>1</length></cylinder>",
        ][index % 3];
        let _ = write!(
            text,
            "<model name='m{index}'><pose>{x} {y} 0.5 0 0 0</pose><link name='l'>
               <inertial><mass>1</mass><inertia><ixx>.16</ixx><iyy>.16</iyy><izz>.16</izz></inertia></inertial>
               <collision name='c'><geometry>{shape}</geometry></collision>
               <visual name='v'><geometry>{shape}</geometry></visual></link></model>"
        );
    }
    text + "</world></sdf>"
}

fn load(text: &str) -> World {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("shapes.sdf");
    std::fs::write(&file, text).unwrap();
    load::world(file.to_str().unwrap()).unwrap()
}

const GROUND: &str = "<model name='ground'><static>true</static><link name='l'>
    <collision name='c'><geometry><plane><normal>0 0 1</normal><size>200 200</size></plane></geometry></collision>
    </link></model>";
/// Large steps, so that physics does not hide the other costs.
const LIDAR: &str = "<physics type='ode'><max_step_size>0.01</max_step_size></physics><gravity>0 0 0</gravity><model name='eye'><static>true</static><pose>-3 -3 0.5 0 0 0.8</pose>
    <link name='l'><sensor name='laser' type='ray'><update_rate>30</update_rate>
    <ray><scan><horizontal><samples>16</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
    <range><min>.1</min><max>90</max></range></ray>
    <plugin name='laser' filename='libgazebo_ros_laser.so'><topicName>scan</topicName></plugin></sensor></link></model>";

/// The tests run one at a time, because they would compete for the same caches.
static ALONE: Mutex<()> = Mutex::new(());

fn simulation(world: World) -> Simulation {
    Simulation::builder(world).execution(Execution::default()).build().unwrap()
}

/// Copying poses from physics, updating the scene, rendering a sensor and publishing the states of all models and links
/// are compared with a simulation that only steps, because a slow machine is slow for both.
#[test]
fn five_hundred_moving_bodies_cost_a_sixth_of_their_physics() {
    const BODIES: usize = 500;
    const FRAMES: u32 = 60;
    /// The number of steps of 1 ms in a frame at 30 Hz, with Gazebo's default step.
    const STEPS: f64 = 100.0 / 3.0;
    /// The number of steps in a frame of this world.
    const STEPS_HERE: f64 = 10.0 / 3.0;
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let text = shapes(BODIES, 3.0, LIDAR);
    let moving = || {
        let mut moving = simulation(load(&text));
        let ids: Vec<_> = moving.entities().iter().map(|(id, _)| id).collect();
        for (index, id) in ids.into_iter().enumerate() {
            let velocity = DVec3::new(0.1, 0.0, 0.02 * (index % 7) as f64);
            let pose = moving.pose(id).unwrap();
            moving.place(id, &pose, velocity, DVec3::Z).unwrap();
        }
        moving
    };
    let (mut alone, mut served) = (moving(), moving());
    let domain = Domain::new(&format!("many-{}", std::process::id())).unwrap();
    let (node, reader) = (Node::open(&domain, "belvedere").unwrap(), Node::open(&domain, "reader").unwrap());
    let mut server = Server::attach(&mut served, &node, ServerOptions::default()).unwrap();
    let scan =
        reader.streams().unwrap().into_iter().find(|stream| stream.kind == Some(Kind::LaserScan)).unwrap();
    let topics = [StreamSpec::MODEL_STATES, StreamSpec::LINK_STATES, &scan.topic];
    let mut subscribers: Vec<Subscriber> = topics.map(|topic| reader.subscriber(topic).unwrap()).into();
    // A server finds its subscribers when it sends.
    for subscriber in &mut subscribers {
        assert!(subscriber.take().unwrap().is_none());
    }
    let mut received = [0; 3];
    let (mut with_ms, mut without_ms) = (Vec::new(), Vec::new());
    for frame in 0..=FRAMES {
        let until_ns = u64::from(frame) * 100_000_000 / 3;
        with_ms.push(milliseconds(|| {
            while server.time_ns() < until_ns || server.next_ns() <= until_ns {
                server.advance();
            }
        }));
        without_ms.push(milliseconds(|| {
            alone.run_until(until_ns);
        }));
        for (subscriber, received) in subscribers.iter_mut().zip(&mut received) {
            while let Some(frame) = subscriber.take().unwrap() {
                *received += 1;
                let expected = if subscriber.topic() == scan.topic { 1 } else { BODIES as u32 };
                assert!(frame.header().height >= expected, "{}", frame.header().height);
            }
        }
    }
    assert!(received.iter().all(|count| *count >= FRAMES - 1), "{received:?}");
    // Poses are copied in each step. Requesting all of them costs more, because they are interpolated.
    let poses = || alone.physics().moving_links().map(|(_, _, pose)| pose.translation()).sum::<DVec3>();
    let copy = || milliseconds(|| assert!((0..100).map(|_| poses()).sum::<DVec3>().is_finite())) / 100.0;
    // The least of several tries, because other load only adds to it.
    let copy_ms = (0..20).map(|_| copy()).fold(f64::INFINITY, f64::min);
    // Other load adds to some frames; the lower quartile is undisturbed.
    let quartile = |costs_ms: &mut [f64]| {
        costs_ms.sort_by(f64::total_cmp);
        costs_ms[costs_ms.len() / 4]
    };
    let without_ms = quartile(&mut without_ms);
    let frame_ms = quartile(&mut with_ms) - without_ms;
    let (added_ms, physics_ms) = (frame_ms + copy_ms * STEPS, without_ms / STEPS_HERE * STEPS);
    println!(
        "{frame_ms:.3} ms a frame, and {copy_ms:.4} ms at most in each of {STEPS:.0} steps: \
         {:.3} of the {physics_ms:.2} ms of physics",
        added_ms / physics_ms
    );
    assert!(added_ms < physics_ms / 6.0, "{added_ms} ms a frame beside {physics_ms} ms");
}

/// Like gz-sim's `3k_shapes.sdf`.
#[test]
fn three_thousand_sleeping_bodies_load_in_a_second_and_run_in_real_time() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let text = shapes(3000, 2.0, GROUND);
    let mut loaded = None;
    let load_ms = milliseconds(|| loaded = Some(simulation(load(&text))));
    let mut simulation = loaded.unwrap();
    // rapier's bodies sleep after two seconds at rest.
    let settling_ms = milliseconds(|| simulation.run_for(Duration::from_secs(3)));
    let asleep_ms = milliseconds(|| simulation.run_for(Duration::from_secs(2)));
    println!(
        "loaded in {load_ms:.0} ms; 3 s until they sleep take {settling_ms:.0} ms, 2 s asleep {asleep_ms:.0} ms"
    );
    for (id, entity) in simulation.entities().iter() {
        let height = simulation.pose(id).unwrap().translation().z;
        assert!(entity.name == "ground" || (height - 0.5).abs() < 0.01, "{}: {height}", entity.name);
    }
    assert!(load_ms < 1000.0, "{load_ms} ms");
    assert!(asleep_ms < 2000.0, "{asleep_ms} ms for 2 s");
}

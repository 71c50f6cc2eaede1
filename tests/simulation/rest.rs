//! Bodies at rest may sleep. Bodies that move slowly do not.

use crate::sdf::good;
use belvedere::description::model::World;
use belvedere::world::physics::Physics;
use glam::DVec3;
use std::f64::consts::TAU;

fn run(world: &World, seconds: f64) -> Physics {
    let mut physics = Physics::new(world).unwrap();
    (0..(seconds * 1e3) as usize).for_each(|_| physics.step());
    physics
}

const BALL: &str =
    "<inertial><mass>1</mass><inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial>
    <collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>";

fn ground(slope: f64) -> String {
    format!(
        "<model name='ground'><static>1</static><pose>0 0 0 0 {slope} 0</pose><link name='l'><collision name='c'>
         <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry></collision></link></model>"
    )
}

/// Small swings of a pendulum of 1 m: a point mass, so that T = 2π·√(l/g) = 2.007 s.
#[test]
fn a_pendulum_swings_on() {
    let content = "<model name='pendulum'><joint name='hang' type='revolute'><parent>world</parent><child>l</child>
         <axis><xyz>1 0 0</xyz></axis></joint><link name='l'><pose>0 0 3 0.1 0 0</pose>
         <inertial><pose>0 0 -1 0 0 0</pose><mass>1</mass>
         <inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial>
         <collision name='c'><pose>0 0 -1 0 0 0</pose><geometry><sphere><radius>.1</radius></sphere></geometry></collision>
         </link></model>";
    let world = good("1.7", content);
    let period_s = TAU * (1.004_f64 / 9.8).sqrt();
    for halves in 1..=9 {
        let physics = run(&world, period_s * 0.5 * f64::from(halves));
        let bob = physics.world_from_link(0, 0).transform_point(-DVec3::Z);
        let expected = if halves % 2 == 0 { 0.1 } else { -0.1 };
        assert!((bob.y - expected).abs() < 0.004, "{halves}: {bob}");
    }
}

/// It starts with 0.07 m/s², so that it is slower than rapier's own speed limit for half a second.
#[test]
fn a_ball_rolls_down_a_gentle_ramp() {
    const SLOPE: f64 = 0.01;
    let ball = format!("<model name='ball'><pose>0 0 0.1 0 0 0</pose><link name='l'>{BALL}</link></model>");
    let physics = run(&good("1.7", &(ground(SLOPE) + &ball)), 10.0);
    // A ball with 2/5·m·r²: a = 5/7·g·sin α.
    let expected = 0.5 * 5.0 / 7.0 * 9.8 * SLOPE * 100.0;
    let rolled = physics.world_from_model(1).translation().x;
    assert!((rolled / expected - 1.0).abs() < 0.02, "{rolled} instead of {expected}");
}

/// A crate falls from its edge onto its face. With SDF's default inertia, that of a cube of 2.4 m, it rocks for a minute
/// before it rests: each impact takes 2 % of its rate of turn. It does not sleep meanwhile.
#[test]
fn a_tilted_crate_falls_onto_its_face() {
    let own = "<inertial><mass>1</mass><inertia><ixx>.00667</ixx><iyy>.00667</iyy><izz>.00667</izz></inertia></inertial>";
    for (inertial, tilt, seconds) in [(own, 0.2, 3), (own, 0.02, 3), ("", 0.2, 100)] {
        let up = 0.1 * (f64::cos(tilt) + f64::sin(tilt));
        let crates = format!(
            "<model name='crate'><pose>0 0 {up} {tilt} 0 0</pose><link name='l'>{inertial}<collision name='c'>
             <geometry><box><size>.2 .2 .2</size></box></geometry></collision></link></model>"
        );
        let mut physics = Physics::new(&good("1.7", &(ground(0.0) + &crates))).unwrap();
        let lean = |physics: &Physics| {
            physics.world_from_model(1).transform_vector(DVec3::Z).angle_between(DVec3::Z)
        };
        for _ in 0..seconds * 10 {
            (0..100).for_each(|_| physics.step());
            assert!(!physics.sleeps(1) || lean(&physics) < 0.01, "{tilt}: {}", lean(&physics));
        }
        let height = physics.world_from_model(1).translation().z;
        assert!(
            lean(&physics) < 0.005 && (height - 0.1).abs() < 0.001,
            "{tilt}: {} {height}",
            lean(&physics)
        );
        assert!(physics.sleeps(1), "{tilt}");
    }
}

/// Bodies at rest sleep, and wake up when they are pushed. With `<allow_auto_disable>` false, they never sleep.
#[test]
fn a_body_at_rest_sleeps_and_wakes() {
    let model = |name: &str, x: f64, own: &str| {
        format!("<model name='{name}'>{own}<pose>{x} 0 0.1 0 0 0</pose><link name='l'>{BALL}</link></model>")
    };
    let awake = "<allow_auto_disable>false</allow_auto_disable>";
    let content = ground(0.0) + &model("rests", 0.0, "") + &model("watches", 3.0, awake);
    let world = good("1.7", &content);
    let mut physics = run(&world, 1.5);
    assert_eq!((physics.sleeps(1), physics.sleeps(2)), (true, false));
    // The other body pushes it.
    let pose = physics.world_from_model(2);
    physics.move_model(2, &pose, DVec3::X * -2.0, DVec3::Y * -20.0);
    (0..3000).for_each(|_| physics.step());
    let (first, second) =
        (physics.world_from_model(1).translation().x, physics.world_from_model(2).translation().x);
    assert!(first < -0.5 && second < 3.0, "{first} {second}");
    assert!(!physics.sleeps(1));
}

/// Boxes of 2 kg are put down from 2 mm, one on the other, and never sleep. They stay where they land, and none sinks into
/// the one below it.
#[test]
fn a_stack_of_boxes_rests_where_it_is_put() {
    let boxes = |count: usize| -> String {
        let model = |index: usize| {
            let height = 0.1 + 0.2 * index as f64 + 0.002 * (index + 1) as f64;
            format!(
                "<model name='box_{index}'><allow_auto_disable>false</allow_auto_disable><pose>0 0 {height} 0 0 0</pose>
                 <link name='l'><inertial><mass>2</mass><inertia><ixx>.0217</ixx><iyy>.0333</iyy><izz>.0417</izz></inertia>
                 </inertial><collision name='c'><geometry><box><size>.4 .3 .2</size></box></geometry></collision></link>
                 </model>"
            )
        };
        (0..count).map(model).collect()
    };
    for (count, step_s, sinks_by) in
        [(3, 0.001, 0.45e-3), (3, 0.01, 0.52e-3), (3, 0.05, 3e-3), (10, 0.001, 3.2e-3)]
    {
        let mut world = good("1.7", &(ground(0.0) + &boxes(count)));
        world.max_step_size_s = step_s;
        let mut physics = Physics::new(&world).unwrap();
        let places = |physics: &Physics| -> Vec<DVec3> {
            (1..=count).map(|model| physics.world_from_model(model).translation()).collect()
        };
        let run = |physics: &mut Physics, seconds: f64| {
            (0..(seconds / step_s).round() as usize).for_each(|_| physics.step());
        };
        run(&mut physics, 3.0);
        let rested = places(&physics);
        for (index, place) in rested.iter().enumerate() {
            let low = 0.1 + 0.2 * index as f64 - place.z;
            assert!((0.0..sinks_by).contains(&low), "{count} by {step_s} s: box {index} is {low} m too low");
            assert!(place.truncate().length() < 2e-3, "{count} by {step_s} s: box {index} moved to {place}");
        }
        run(&mut physics, 1.0);
        for (before, after) in rested.iter().zip(places(&physics)) {
            assert!((after - before).length() < 1e-5, "{count} by {step_s} s: {before} to {after}");
        }
    }
}

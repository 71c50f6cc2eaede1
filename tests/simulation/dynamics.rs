//! Resistance of joints, limits of their motors, and mimic joints, compared with values from mechanics. Surfaces.

use crate::robot_models::xyz;
use crate::sdf::{Folder, good};
use belvedere::description::model::World;
use belvedere::description::{Severity, load};
use belvedere::robot::placement;
use belvedere::world::physics::Physics;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::TAU;

/// A pendulum of 1 m and 1 kg, at an angle of `lean` rad if its joint is at 0; its inertia about the pivot is 1.004
/// kg·m².
fn pendulum(dynamics: &str, lean: f64) -> World {
    good(
        "1.7",
        &format!(
            "<model name='m'><joint name='j' type='revolute'><parent>world</parent><child>l</child>
             <axis><xyz>1 0 0</xyz>{dynamics}</axis></joint>
             <link name='l'><pose>0 0 3 {lean} 0 0</pose><inertial><pose>0 0 -1 0 0 0</pose><mass>1</mass>
             <inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial></link></model>"
        ),
    )
}

/// A horizontal rod of 1 m and 2 kg along x. It falls with a positive rotation about y: m·g·l/2 = 9.8 N·m, 0.667 kg·m².
fn rod(axis: &str, more: &str) -> World {
    good(
        "1.11",
        &format!(
            "<model name='m'><joint name='j' type='revolute'><parent>world</parent><child>l</child>
             <axis><xyz>0 1 0</xyz>{axis}</axis></joint>
             <link name='l'><pose>0 0 3 0 0 0</pose><inertial><pose>.5 0 0 0 0 0</pose><mass>2</mass>
             <inertia><ixx>.002</ixx><iyy>.167</iyy><izz>.167</izz></inertia></inertial></link>{more}</model>"
        ),
    )
}

fn run(world: &World, seconds: f64) -> Physics {
    let mut physics = Physics::new(world).unwrap();
    (0..(seconds * 1e3) as usize).for_each(|_| physics.step());
    physics
}

fn position(physics: &Physics) -> f64 {
    physics.joint_state(0, 0).unwrap().position
}

/// Returns the times in s and the positions at which the first joint reverses.
fn turns(world: &World, seconds: f64) -> Vec<(f64, f64)> {
    let mut physics = Physics::new(world).unwrap();
    let (mut found, mut last) = (Vec::new(), 0.0);
    for step in 1..=(seconds * 1e3) as usize {
        physics.step();
        let state = physics.joint_state(0, 0).unwrap();
        if last * state.velocity < 0.0 {
            found.push((step as f64 * 1e-3, state.position));
        }
        last = state.velocity;
    }
    found
}

/// Amplitudes fall with e^(−c·t/2I).
#[test]
fn a_damper_reduces_a_pendulums_swing() {
    let turns = turns(&pendulum("<dynamics><damping>0.2</damping></dynamics>", 0.2), 9.5);
    assert!(turns.len() == 9, "{turns:?}");
    for (seconds, position) in turns {
        let (amplitude, expected) = ((position + 0.2).abs(), 0.2 * f64::exp(-0.2 * seconds / (2.0 * 1.004)));
        assert!((amplitude / expected - 1.0).abs() < 0.01, "{seconds} s: {amplitude}, not {expected}");
    }
}

/// A spring together with gravity: T = 2π·√(I / (k + m·g·l)); with a damper it comes to rest at k·q = m·g·l/2·cos q.
#[test]
fn a_spring_swings_a_joint_about_its_reference() {
    let spring = "<dynamics><spring_stiffness>100</spring_stiffness><spring_reference>0.02</spring_reference></dynamics>";
    let turns = turns(&pendulum(spring, 0.0), 6.4);
    let period_s = 2.0 * (turns[20].0 - turns[0].0) / 20.0;
    let expected_s = TAU * f64::sqrt(1.004 / 109.8);
    assert!((period_s / expected_s - 1.0).abs() < 0.01, "{period_s} s, not {expected_s}");
    let damped = "<dynamics><damping>2</damping><spring_stiffness>200</spring_stiffness></dynamics>";
    let rest = position(&run(&rod(damped, ""), 10.0));
    assert!((200.0 * rest - 9.8 * rest.cos()).abs() < 0.02, "{rest}");
}

#[test]
fn dry_friction_holds_what_is_lighter_and_slows_what_is_heavier() {
    let friction = |torque: f64| rod(&format!("<dynamics><friction>{torque}</friction></dynamics>"), "");
    let held = position(&run(&friction(12.0), 3.0));
    assert!(held.abs() < 1e-3, "{held}");
    // The rest of the torque accelerates it.
    let (slid, expected) = (position(&run(&friction(8.0), 0.3)), 0.5 * (9.8 - 8.0) / 0.667 * 0.3 * 0.3);
    assert!((slid / expected - 1.0).abs() < 0.02, "{slid}, not {expected}");
    // The amplitude of each half swing is smaller by 2·F / (m·g·l).
    let swings = turns(&pendulum("<dynamics><friction>0.5</friction></dynamics>", 0.2), 1.5);
    let expected = -(0.4 - 2.0 * 0.5 / 9.8);
    assert!((swings[0].1 - expected).abs() < 0.003, "{swings:?}, not {expected}");
}

#[test]
fn a_motor_is_no_stronger_and_no_faster_than_its_limits() {
    let lifted = |effort: f64| {
        let limits = format!("<limit><lower>-1</lower><upper>1</upper><effort>{effort}</effort></limit>");
        let mut physics = Physics::new(&rod(&limits, "")).unwrap();
        physics.drive_joint(0, 0, -0.5, 100.0);
        (0..4000).for_each(|_| physics.step());
        position(&physics)
    };
    // 9.8 N·m lift the rod.
    assert!((lifted(5.0) - 1.0).abs() < 0.01, "{}", lifted(5.0));
    assert!((lifted(15.0) + 1.0).abs() < 0.01, "{}", lifted(15.0));
    // Below 0 and 1e16 are no limit.
    assert!((lifted(-1.0) + 1.0).abs() < 0.01 && (lifted(1e16) + 1.0).abs() < 0.01);
    let mut physics = Physics::new(&rod("<limit><velocity>0.3</velocity></limit>", "")).unwrap();
    physics.drive_joint(0, 0, -2.0, 100.0);
    (0..1000).for_each(|_| physics.step());
    assert!((position(&physics) + 0.3).abs() < 0.02, "{}", position(&physics));
}

#[test]
fn a_joint_begins_at_its_initial_position_and_stays_where_its_limits_are_one() {
    let fixed = rod("<limit><lower>0.3</lower><upper>0.3</upper></limit>", "");
    assert!((position(&run(&fixed, 2.0)) - 0.3).abs() < 1e-3);
    let held = "<initial_position>0.7</initial_position><dynamics><friction>100</friction></dynamics>";
    // Links that are attached to the link move with it: here by a joint that does not move by itself.
    let tip = "<link name='tip'><pose>1 0 3 0 0 0</pose><inertial><mass>.1</mass><inertia><ixx>.001</ixx><iyy>.001</iyy>
         <izz>.001</izz></inertia></inertial></link>
         <joint name='t' type='prismatic'><parent>l</parent><child>tip</child><axis><xyz>1 0 0</xyz>
         <dynamics><friction>50</friction></dynamics></axis></joint>";
    let world = rod(held, tip);
    let tip_at = |physics: &Physics| {
        let tip = world.models[0].link_named("tip").unwrap();
        physics.world_from_link(0, tip).translation()
    };
    let mut physics = Physics::new(&world).unwrap();
    let expected = DVec3::new(0.7_f64.cos(), 0.0, 3.0 - 0.7_f64.sin());
    assert!(tip_at(&physics).distance(expected) < 1e-6, "{} {expected}", tip_at(&physics));
    (0..500).for_each(|_| physics.step());
    assert!((position(&physics) - 0.7).abs() < 1e-3, "{}", position(&physics));
    // The same when the model is moved.
    physics.place_model(0, &xyz(0.0, 0.0, 1.0));
    assert!(tip_at(&physics).distance(expected + DVec3::Z) < 1e-6 && position(&physics) == 0.7);
    (0..500).for_each(|_| physics.step());
    assert!((position(&physics) - 0.7).abs() < 1e-3);
    assert!(tip_at(&physics).distance(expected + DVec3::Z) < 2e-3, "{}", tip_at(&physics));
}

/// A slide that follows the rod, as the rod falls.
#[test]
fn a_joint_follows_the_one_that_it_mimics() {
    let slide = |mimic: &str| {
        format!(
            "<joint name='slide' type='prismatic'><parent>l</parent><child>f</child><axis><xyz>1 0 0</xyz>{mimic}</axis></joint>
             <link name='f'><pose>1 0 3 0 0 0</pose><inertial><mass>0.1</mass>
             <inertia><ixx>.0001</ixx><iyy>.0001</iyy><izz>.0001</izz></inertia></inertial></link>"
        )
    };
    let mimic = "<mimic joint='j'><multiplier>0.1</multiplier><offset>0.05</offset><reference>0.2</reference></mimic>";
    let world = rod("<dynamics><damping>0.5</damping></dynamics>", &slide(mimic));
    let mut physics = Physics::new(&world).unwrap();
    let mut farthest: f64 = 0.0;
    for _ in 0..4000 {
        physics.step();
        let [leader, follower] = [0, 1].map(|joint| physics.joint_state(0, joint).unwrap().position);
        farthest = farthest.max(leader);
        let expected = 0.1 * (leader - 0.2) + 0.05;
        assert!((follower - expected).abs() < 1e-3, "{follower}, not {expected}");
    }
    assert!(farthest > 2.0, "{farthest}");
}

/// A slide of 1 kg on a spring of 1000 N/m with a damper of 20 N·s/m comes to rest at 0.1 − 9.8/1000 m.
#[test]
fn a_robots_spring_damper_and_mimic() {
    let text = "<robot name='r'><link name='world'/>
        <link name='a'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/></inertial></link>
        <link name='b'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/></inertial></link>
        <joint name='ja' type='prismatic'><parent link='world'/><child link='a'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/>
        <limit lower='-.5' upper='.5' effort='100' velocity='10'/><dynamics damping='20'/></joint>
        <joint name='jb' type='revolute'><parent link='world'/><child link='b'/><origin xyz='0 1 1'/><axis xyz='0 0 1'/>
        <limit lower='-3' upper='3' effort='100' velocity='10'/><mimic joint='ja' multiplier='-2' offset='0.3'/></joint>
        <gazebo reference='ja'><implicitSpringDamper>true</implicitSpringDamper><springStiffness>1000</springStiffness>
        <springReference>.1</springReference></gazebo></robot>";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("r.urdf");
    std::fs::write(&file, text).unwrap();
    let robot = load::robot(file.to_str().unwrap()).unwrap();
    let mut physics = Physics::new(&World::empty()).unwrap();
    let index = physics.insert_model(&placement(&robot, Pose::IDENTITY)).unwrap();
    (0..3000).for_each(|_| physics.step());
    let [slide, turn] = [0, 1].map(|joint| physics.joint_state(index, joint).unwrap().position);
    assert!((slide - 0.0902).abs() < 5e-4, "{slide}");
    assert!((turn - (0.3 - 2.0 * slide)).abs() < 1e-3, "{turn}");
}

const GROUND: &str = "<model name='ground'><static>1</static><link name='l'><collision name='c'>
    <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry><surface>SURFACE</surface></collision></link></model>";

fn ball(surface: &str, own: &str, height: f64) -> String {
    format!(
        "<model name='ball'><pose>0 0 {height} 0 0 0</pose><link name='l'>{own}<inertial><mass>1</mass>
         <inertia><ixx>.004</ixx><iyy>.004</iyy><izz>.004</izz></inertia></inertial>
         <collision name='c'><geometry><sphere><radius>.1</radius></sphere></geometry><surface>{surface}</surface></collision></link></model>"
    )
}

/// A ball that falls from 1 m bounces to e² of the height each time: 0.36 m, 0.1296 m. If two surfaces differ, the
/// smaller value applies.
#[test]
fn a_ball_bounces_by_its_restitution() {
    let bounce = |restitution: f64, threshold: &str| {
        format!(
            "<bounce><restitution_coefficient>{restitution}</restitution_coefficient>{threshold}</bounce>"
        )
    };
    let slow = "<threshold>0.01</threshold>";
    let tops = |on: &str, of: &str| {
        let world = good("1.7", &(GROUND.replace("SURFACE", on) + &ball(of, "", 1.1)));
        let mut physics = Physics::new(&world).unwrap();
        let (mut tops, mut top) = (Vec::new(), 0.0_f64);
        for _ in 0..1800 {
            physics.step();
            let height = physics.world_from_model(1).translation().z - 0.1;
            if height > 0.01 {
                top = top.max(height);
            } else if top > 0.0 {
                tops.push(std::mem::take(&mut top));
            }
        }
        tops
    };
    let found = tops(&bounce(0.9, slow), &bounce(0.6, slow));
    assert!((found[1] - 0.36).abs() < 0.004 && (found[2] - 0.1296).abs() < 0.004, "{found:?}");
    // It lands with 4.4 m/s.
    let five = "<threshold>5</threshold>";
    for (on, of) in [(String::new(), bounce(0.6, slow)), (bounce(0.6, five), bounce(0.6, five))] {
        assert_eq!(tops(&on, &of).len(), 1, "{on} {of}");
    }
}

#[test]
fn bitmasks_and_shapes_without_contact_let_things_through() {
    let height = |on: &str, of: &str| {
        let world = good("1.7", &(GROUND.replace("SURFACE", on) + &ball(of, "", 0.1)));
        run(&world, 1.0).world_from_model(1).translation().z
    };
    let mask = |bits: &str| format!("<contact><collide_bitmask>{bits}</collide_bitmask></contact>");
    assert!(height(&mask("0x01"), &mask("0x02")) < -4.0);
    assert!((height(&mask("0x03"), &mask("2")) - 0.1).abs() < 0.001);
    assert!((height("", &mask("0x02")) - 0.1).abs() < 0.001);
    assert!(height("", "<contact><collide_without_contact>true</collide_without_contact></contact>") < -4.0);
}

/// A kinematic link does not move, even if something falls onto it; a decay removes its share of the velocity in each
/// step.
#[test]
fn a_kinematic_link_stays_and_a_decay_slows_down() {
    let fixed =
        ball("", "<kinematic>true</kinematic>", 2.0) + &ball("", "", 3.0).replace("'ball'", "'other'");
    let physics = run(&good("1.7", &fixed), 1.0);
    assert_eq!(physics.world_from_model(0).translation(), DVec3::Z * 2.0);
    assert!(physics.world_from_model(1).translation().z > 2.19);
    let decay = "<gravity>false</gravity><velocity_decay><linear>0.001</linear><angular>0.002</angular></velocity_decay>";
    for step_s in [0.001, 0.01] {
        let physics_of = format!("<physics type='ode'><max_step_size>{step_s}</max_step_size></physics>");
        let mut physics = Physics::new(&good("1.7", &(physics_of + &ball("", decay, 0.0)))).unwrap();
        physics.move_model(0, &Pose::IDENTITY, DVec3::X, DVec3::Z);
        (0..1000).for_each(|_| physics.step());
        let (linear, angular) = physics.model_velocity(0);
        assert!((linear.x / 0.999_f64.powi(1000) - 1.0).abs() < 0.005, "{linear}");
        assert!((angular.z / 0.998_f64.powi(1000) - 1.0).abs() < 0.005, "{angular}");
    }
}

/// A box on a slope of 0.3 rad, whose tangent is 0.309: it slides below that friction, with g·(sin α − μ·cos α).
#[test]
fn a_box_slides_down_a_slope_by_coulombs_law() {
    let slid = |mu: f64| {
        let surface = format!("<friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction>");
        let ground = GROUND
            .replace("SURFACE", &surface)
            .replace("<static>1</static>", "<static>1</static><pose>0 0 0 0 0.3 0</pose>");
        let (x, z) = (0.1 * 0.3_f64.sin(), 0.1 * 0.3_f64.cos());
        let content = format!(
            "{ground}<model name='box'><pose>{x} 0 {z} 0 0.3 0</pose><link name='l'><inertial><mass>1</mass>
             <inertia><ixx>.00667</ixx><iyy>.00667</iyy><izz>.00667</izz></inertia></inertial><collision name='c'>
             <geometry><box><size>.2 .2 .2</size></box></geometry><surface>{surface}</surface></collision></link></model>"
        );
        let mut physics = Physics::new(&good("1.7", &content)).unwrap();
        [(); 2].map(|()| {
            (0..1000).for_each(|_| physics.step());
            physics.world_from_model(1).translation().distance(DVec3::new(x, 0.0, z))
        })
    };
    // It comes to rest on its way down onto the slope.
    let [first, second] = slid(0.315);
    assert!(first < 0.01 && (second - first).abs() < 1e-4, "{first} {second}");
    for mu in [0.1, 0.2, 0.3] {
        let ([_, slipped], braked) = (slid(mu), mu * 0.3_f64.cos());
        // What brakes it is within 2 % of the law.
        let with = |braked: f64| 0.5 * 9.8 * (0.3_f64.sin() - braked) * 4.0;
        assert!((with(1.02 * braked)..with(0.98 * braked)).contains(&slipped), "{mu}: {slipped}");
    }
}

/// Friction of points beside the centre of mass acts against the slip, too, in whatever direction it slips: each of the four
/// feet of a table, and the corners of a flat plate.
#[test]
fn feet_and_plates_brake_by_coulombs_law_in_every_direction() {
    let collision = |name: &str, at: &str, size: &str| {
        format!(
            "<collision name='{name}'><pose>{at} 0 0 0</pose><geometry><box><size>{size}</size></box></geometry>
             <surface><friction><ode><mu>.3</mu><mu2>.3</mu2></ode></friction></surface></collision>"
        )
    };
    let feet =
        ["-.3 -.3 .15", "-.3 .3 .15", ".3 -.3 .15", ".3 .3 .15"].map(|at| collision(at, at, ".06 .06 .3"));
    let (table, plate) = (feet.concat(), collision("plate", "0 0 .01", ".6 .6 .02"));
    for (shapes, heading) in [(&table, 0.0), (&table, 0.4), (&plate, 0.0), (&plate, 0.5)] {
        let world = good(
            "1.7",
            &format!(
                "{GROUND}<model name='m'><pose>0 0 0 0 0 {heading}</pose><link name='l'><inertial><pose>0 0 .02 0 0 0</pose>
                 <mass>1</mass><inertia><ixx>.03</ixx><iyy>.03</iyy><izz>.06</izz></inertia></inertial>{shapes}</link></model>"
            )
            .replace("SURFACE", ""),
        );
        let mut physics = Physics::new(&world).unwrap();
        let start = physics.world_from_model(1);
        physics.move_model(1, &start, DVec3::X * 2.0, DVec3::ZERO);
        (0..100).for_each(|_| physics.step());
        let (before, _) = physics.model_velocity(1);
        (0..300).for_each(|_| physics.step());
        let (after, turn) = physics.model_velocity(1);
        let share = (before.x - after.x) / (0.3 * 9.8 * 0.3);
        assert!((share - 1.0).abs() < 0.02, "{heading}: {share} of the law");
        assert!(
            after.y.abs() < 0.01 && turn.z.abs() < 0.02,
            "{heading}: goes straight on, not {after}, {turn}"
        );
    }
}

/// A box of 1 × 0.4 × 0.2 m with 500 kg/m³ weighs 40 kg; beside it a ball of 0.1 m with the link's 1000 kg/m³, 4.189 kg.
#[test]
fn an_automatic_inertia_is_that_of_the_collisions() {
    let link = |mass: &str| {
        let world = good(
            "1.11",
            &format!(
                "<model name='m'><link name='a'><inertial auto='true'><density>1000</density>{mass}</inertial>
                 <collision name='c'><density>500</density><geometry><box><size>1 .4 .2</size></box></geometry></collision>
                 <collision name='d'><pose>1 0 0 0 0 0</pose><geometry><sphere><radius>.1</radius></sphere></geometry></collision>
                 </link></model>"
            ),
        );
        world.models[0].links[0].inertial.unwrap()
    };
    let (found, ball_kg) = (link(""), 4.0 / 3.0 * std::f64::consts::PI);
    let (mass_kg, centre) = (40.0 + ball_kg, ball_kg / (40.0 + ball_kg));
    assert!((found.mass_kg - mass_kg).abs() < 1e-9, "{found:?}");
    assert!((found.link_from_inertial.translation() - DVec3::X * centre).length() < 1e-9, "{found:?}");
    let [ixx, iyy, ..] = found.inertia;
    let about_x = 40.0 * (0.16 + 0.04) / 12.0 + 0.4 * ball_kg * 0.01;
    assert!((ixx - about_x).abs() < 1e-9, "{found:?}");
    // Two bodies 1 m apart add their reduced mass.
    let about_y = 40.0 * (1.0 + 0.04) / 12.0 + 0.4 * ball_kg * 0.01 + 40.0 * ball_kg / mass_kg;
    assert!((iyy - about_y).abs() < 1e-9, "{found:?}");
    let scaled = link("<mass>2</mass>");
    assert!(
        (scaled.mass_kg - 2.0).abs() < 1e-12 && (scaled.inertia[0] - about_x * 2.0 / mass_kg).abs() < 1e-9
    );
}

#[test]
fn invalid_values_of_a_joint_or_a_surface_are_reported() {
    let joint = |name: &str, axis: &str| {
        format!(
            "<link name='{name}l'/><joint name='{name}' type='revolute'><parent>world</parent><child>{name}l</child>
             <axis><xyz>0 0 1</xyz>{axis}</axis></joint>"
        )
    };
    let told = |parts: &str| {
        let content = format!("<model name='m'>{parts}</model>");
        let (_, problems) = Folder::new().load("1.11", &content, false);
        let [problem] = &problems[..] else { panic!("{parts}: {problems:#?}") };
        (problem.severity, problem.to_string())
    };
    let mimics = |leader: &str| format!("<mimic joint='{leader}'><multiplier>1</multiplier></mimic>");
    let surface = |inner: &str| {
        format!(
            "<link name='s'><collision name='c'>{}<surface>{inner}</surface></collision></link>",
            crate::sdf::BOX
        )
    };
    let decay = "<link name='s'><velocity_decay><linear>-1</linear></velocity_decay></link>";
    for (parts, severity, expected) in [
        (joint("a", &mimics("b")), Severity::Error, "names the joint 'b', which does not exist"),
        (
            joint("a", &mimics("b")) + &joint("b", &mimics("a")),
            Severity::Error,
            "the joint 'a' follows itself by its <mimic>",
        ),
        (
            joint("a", "<dynamics><damping>-1</damping></dynamics>"),
            Severity::Warning,
            "<damping> is -1: it counts as 0",
        ),
        (
            surface("<contact><collide_bitmask>none</collide_bitmask></contact>"),
            Severity::Error,
            "<collide_bitmask> is 'none'",
        ),
        (
            surface("<bounce><restitution_coefficient>2</restitution_coefficient></bounce>"),
            Severity::Warning,
            "<restitution_coefficient> is 2: it counts as 1",
        ),
        (decay.to_owned(), Severity::Warning, "<linear> of <velocity_decay> is -1: it counts as 0"),
        (
            "<link name='s'><inertial auto='true'/></link>".to_owned(),
            Severity::Warning,
            "has no collision from which its mass could be computed",
        ),
    ] {
        let (found, text) = told(&parts);
        assert!(found == severity && text.contains(expected), "{text}");
    }
}

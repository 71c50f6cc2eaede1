//! Joints and masses in files, and their effect in physics.

use crate::sdf;

use crate::robot_models::{ground, kobuki, world, xyz};
use crate::sdf::{Folder, good};
use belvedere::description::Severity;
use belvedere::description::model::{Geometry, JointKind, Mesh, Model, World};
use belvedere::robot::{Kobuki, Robot, placement};
use belvedere::world::physics::Physics;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A weightless wheel or slide on a post, with its limits.
fn limited(kind: &str, limits: &str) -> World {
    good(
        "1.6",
        &format!(
            "<model name='m'><link name='post'/>
             <link name='moved'><pose>0 0 1 0 0 0</pose><gravity>false</gravity></link>
             <joint name='hold' type='fixed'><parent>world</parent><child>post</child></joint>
             <joint name='j' type='{kind}'><parent>post</parent><child>moved</child>
             <axis><xyz>0 0 1</xyz><limit>{limits}</limit></axis></joint></model>"
        ),
    )
}

/// The position that a joint reaches if its motor turns it for this time at 4 rad/s or m/s.
fn driven(world: &World, velocity: f64, seconds: f64) -> f64 {
    let mut physics = Physics::new(world).unwrap();
    let joint = world.models[0].joints.iter().position(|joint| joint.kind != JointKind::Fixed).unwrap();
    physics.drive_joint(0, joint, velocity, 20.0);
    (0..(seconds * 1000.0) as usize).for_each(|_| physics.step());
    physics.joint_state(0, joint).unwrap().position
}

#[test]
fn a_limit_holds_on_one_side_and_beyond_a_turn() {
    let turns = limited("revolute", &format!("<lower>{}</lower><upper>{}</upper>", -0.5, 1.5 * TAU));
    assert!((driven(&turns, 4.0, 4.0) - 1.5 * TAU).abs() < 0.05, "{}", driven(&turns, 4.0, 4.0));
    assert!((driven(&turns, -4.0, 2.0) + 0.5).abs() < 0.05, "{}", driven(&turns, -4.0, 2.0));
    for kind in ["revolute", "prismatic"] {
        let below = limited(kind, "<lower>-1.25</lower>");
        assert!((driven(&below, -4.0, 2.0) + 1.25).abs() < 0.05, "{kind}: {}", driven(&below, -4.0, 2.0));
        assert!(driven(&below, 4.0, 3.0) > 11.0, "{kind}: {}", driven(&below, 4.0, 3.0));
        let above = limited(kind, "<upper>0.75</upper>");
        assert!((driven(&above, 4.0, 2.0) - 0.75).abs() < 0.05, "{kind}: {}", driven(&above, 4.0, 2.0));
        assert!(driven(&above, -4.0, 3.0) < -11.0, "{kind}: {}", driven(&above, -4.0, 3.0));
    }
}

#[test]
fn an_impossible_inertia_is_reported_and_harmless() {
    let tumbling = |inertia: &str| {
        let content = format!(
            "<model name='m'><pose>0 0 0 0 0 0</pose><link name='l'><gravity>false</gravity><inertial><mass>1</mass><inertia>{inertia}</inertia></inertial>
             <collision name='c'>{}</collision></link></model>",
            sdf::BOX
        );
        let (world, problems) = Folder::new().load("1.6", &content, false);
        let world = world.unwrap();
        let mut physics = Physics::new(&world).unwrap();
        physics.move_model(0, &Pose::IDENTITY, DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        (0..2000).for_each(|_| physics.step());
        (problems, physics.model_velocity(0).1.length())
    };
    let (problems, speed) = tumbling("<ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0.2</ixy>");
    let [problem] = &problems[..] else { panic!("{problems:#?}") };
    assert_eq!(problem.severity, Severity::Warning);
    assert!(problem.to_string().contains("not positive definite"), "{problem}");
    assert!(speed < 10.0, "{speed}");
    // Thin bodies and points, as they occur in files.
    for good in ["<ixx>0</ixx><iyy>0</iyy><izz>0</izz>", "<ixx>0</ixx><iyy>0.1</iyy><izz>0.1</izz>"] {
        let (problems, speed) = tumbling(good);
        assert!(problems.is_empty(), "{problems:#?}");
        assert!(speed < 20.0, "{good}: {speed}");
    }
}

/// An arm with a gripper whose fingers' inertia is a guess, as in a public robot, swings and comes to rest.
#[test]
fn fingers_with_inertia_about_only_one_axis_stay_stable() {
    let finger = |name: &str, side: f64| {
        format!(
            "<link name='{name}'><pose>0.8 {} 1 0 0 0</pose><inertial><mass>0.08</mass><inertia><ixx>0.002</ixx><iyy>0</iyy><izz>0</izz></inertia></inertial></link>
             <joint name='{name}' type='prismatic'><parent>lower</parent><child>{name}</child><axis><xyz>0 1 0</xyz>
             <limit><lower>0</lower><upper>0.05</upper></limit></axis></joint>",
            side * 0.02
        )
    };
    let rod = |name: &str, x: f64, parent: &str| {
        format!(
            "<link name='{name}'><pose>{x} 0 1 0 0 0</pose><inertial><pose>0.2 0 0 0 0 0</pose><mass>1.5</mass><inertia><ixx>0.002</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia></inertial></link>
             <joint name='{name}' type='revolute'><parent>{parent}</parent><child>{name}</child><axis><xyz>0.3 1 0.2</xyz></axis></joint>"
        )
    };
    let world_file = format!(
        "<model name='m'>{}{}{}{}</model>",
        rod("upper", 0.0, "world"),
        rod("lower", 0.4, "upper"),
        finger("left", 1.0),
        finger("right", -1.0)
    );
    let (world, problems) = Folder::new().load("1.6", &world_file, false);
    assert!(problems.len() == 2 && problems[0].severity == Severity::Note, "{problems:#?}");
    let world = world.unwrap();
    let model = &world.models[0];
    let mut physics = Physics::new(&world).unwrap();
    let lower = model.link_named("lower").unwrap();
    let mut fastest: f64 = 0.0;
    for _ in 0..3000 {
        physics.step();
        fastest = fastest.max(physics.link_velocity(0, lower).0.length());
    }
    // From 0.4 m up it can fall with √(2·9.8·0.4) = 2.8 m/s; the other falling parts can make it somewhat faster.
    assert!(fastest < 8.0, "{fastest} m/s");
}

#[test]
fn links_of_a_model_collide_only_on_request_and_never_across_a_joint() {
    // A drop of 1 m onto a plate of the same model, and a knob on a joint within that plate.
    let fallen = |model: &str, link: &str| {
        let content = format!(
            "<model name='m'>{model}<link name='plate'><collision name='c'>{box}</collision></link>
             <joint name='hold' type='fixed'><parent>world</parent><child>plate</child></joint>
             <link name='drop'><pose>0 0 2 0 0 0</pose>{link}<collision name='c'>{box}</collision></link>
             <link name='knob'><pose>0 0 0.3 0 0 0</pose>{link}<collision name='c'>{box}</collision></link>
             <joint name='turn' type='revolute'><parent>plate</parent><child>knob</child><axis><xyz>0 0 1</xyz></axis></joint></model>",
            box = sdf::BOX
        );
        let (world, _) = Folder::new().load("1.6", &content, false);
        let world = world.unwrap();
        let mut physics = Physics::new(&world).unwrap();
        (0..1500).for_each(|_| physics.step());
        let at = |name: &str| {
            let link = world.models[0].link_named(name).unwrap();
            physics.world_from_link(0, link).translation()
        };
        (at("drop").z, at("knob").distance(DVec3::Z * 0.3))
    };
    let own = "<self_collide>true</self_collide>";
    // On the knob, whose top is at 0.8.
    for (drop, knob) in [fallen(own, ""), fallen("", own)] {
        assert!((drop - 1.3).abs() < 0.02 && knob < 1e-3, "{drop} {knob}");
    }
    let (drop, knob) = fallen("", "");
    assert!(drop < -5.0 && knob < 1e-3, "{drop} {knob}");
}

#[test]
fn a_ball_swings_about_its_pivot_in_all_directions() {
    let content = "<model name='m'><link name='bob'><pose>0.3 0.4 1 0 0 0</pose></link>
         <joint name='j' type='ball'><pose>-0.3 -0.4 1 0 0 0</pose><parent>world</parent><child>bob</child></joint></model>";
    let world = good("1.6", content);
    let mut physics = Physics::new(&world).unwrap();
    let bob = world.models[0].link_named("bob").unwrap();
    let mut lowest = DVec3::MAX;
    for _ in 0..3000 {
        physics.step();
        let at = physics.world_from_link(0, bob).translation();
        assert!((at.distance(DVec3::Z * 2.0) - 1.25_f64.sqrt()).abs() < 0.01, "{at}");
        lowest = if at.z < lowest.z { at } else { lowest };
    }
    // It swings through the bottom, below the pivot.
    assert!((lowest.z - (2.0 - 1.25_f64.sqrt())).abs() < 0.01, "{lowest}");
}

/// A Kobuki that stands only on its casters is pushed: the speed that friction leaves of 0.5 m/s after half a second.
fn glides(friction: Option<f64>) -> f64 {
    let mut robot = kobuki();
    for link in robot.links.iter_mut().filter(|link| link.name.contains("caster")) {
        link.model_from_link = xyz(0.0, 0.0, -0.03) * link.model_from_link;
        link.collisions[0].friction = friction;
    }
    for number in 0..robot.joints.len() {
        let (parent, child) = (robot.joints[number].parent, robot.joints[number].child);
        robot.joints[number].parent_from_child =
            robot.links[parent].model_from_link.inverse() * robot.links[child].model_from_link;
    }
    let start = xyz(0.0, 0.0, 0.03);
    let mut physics = Physics::new(&world(0.001, vec![ground()])).unwrap();
    let index = physics.insert_model(&placement(&robot, start)).unwrap();
    let mut base = Robot::new(&robot, "", index, &mut physics).0;
    let mut run = |steps: usize, physics: &mut Physics| {
        for _ in 0..steps {
            base.control(physics);
            physics.step();
            base.observe(physics);
        }
    };
    run(200, &mut physics);
    let at = physics.world_from_model(index);
    physics.move_model(index, &at, DVec3::X * 0.5, DVec3::ZERO);
    run(500, &mut physics);
    physics.model_velocity(index).0.x
}

#[test]
fn casters_have_the_friction_of_their_file() {
    assert!((glides(Some(0.0)) - 0.5).abs() < 0.02, "{}", glides(Some(0.0)));
    // μ = 0.05 takes 0.05 · 9.8 m/s² · 0.5 s.
    assert!((glides(Some(0.05)) - (0.5 - 0.245)).abs() < 0.02, "{}", glides(Some(0.05)));
    // SDF's default is 1.
    assert!(glides(None).abs() < 0.01, "{}", glides(None));
}

#[test]
fn the_radius_of_a_wheel_is_taken_from_its_triangles() {
    let ring = |radius: f32| -> Mesh {
        let corner = |number: u32, z: f32| {
            let (sin, cos) = (number as f32 * 0.1 * std::f32::consts::TAU / 2.0).sin_cos();
            [radius * cos, radius * sin, z]
        };
        let mut positions: Vec<[f32; 3]> = (0..20).map(|number| corner(number, -0.01)).collect();
        positions.extend((0..20).map(|number| corner(number, 0.01)));
        let triangles =
            (0..20).flat_map(|n| [[n, (n + 1) % 20, n + 20], [(n + 1) % 20, (n + 1) % 20 + 20, n + 20]]);
        Mesh {
            path: "ring.stl".into(),
            positions,
            uvs: Vec::new(),
            normals: Vec::new(),
            triangles: triangles.collect(),
            material: None,
        }
    };
    let with_wheels = |radius: f32| -> Model {
        let mut robot = kobuki();
        for link in robot.links.iter_mut().filter(|link| link.name.starts_with("wheel")) {
            link.collisions[0].geometry = Geometry::Mesh(Arc::new(ring(radius)));
        }
        robot
    };
    for radius in [0.034, 0.06] {
        let robot = with_wheels(radius);
        let mut physics = Physics::new(&world(0.001, vec![ground()])).unwrap();
        let index = physics.insert_model(&placement(&robot, xyz(0.0, 0.0, 0.1))).unwrap();
        let base = Robot::new(&robot, "", index, &mut physics).0;
        let found = base.base().and_then(|base| base.downcast_ref::<Kobuki>()).unwrap().radius_m();
        assert!((found - f64::from(radius)).abs() < 1e-6, "{found}");
    }
}

#[test]
fn the_pose_of_a_model_is_that_of_its_canonical_link() {
    let links = "<link name='falls'/><link name='stays'><gravity>false</gravity></link>";
    for (attribute, expected) in [("canonical_link='stays'", 5.0), ("", 5.0 - 0.5 * 9.8)] {
        let world =
            good("1.8", &format!("<model name='m' {attribute}><pose>0 0 5 0 0 0</pose>{links}</model>"));
        let mut physics = Physics::new(&world).unwrap();
        (0..1000).for_each(|_| physics.step());
        let z = physics.world_from_model(0).translation().z;
        assert!((z - expected).abs() < 0.01, "{attribute}: {z}");
    }
}

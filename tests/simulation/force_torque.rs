//! Force-torque sensors: what they read of known forces, in which direction, and in which axes.

use belvedere::description::diagnostics::{Diagnostics, Problem, Severity};
use belvedere::description::load;
use belvedere::description::model::{Model, World};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere::world::physics::{Physics, Placement};
use belvedere_bridge::payload::Wrench;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Duration;

const G: f64 = 9.8;

fn link(name: &str, pose: &str, mass_kg: f64, inside: &str) -> String {
    format!(
        "<link name='{name}'><pose>{pose}</pose><inertial><mass>{mass_kg}</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>
           <izz>0.01</izz></inertia></inertial>{inside}</link>"
    )
}

fn boxed(size: &str) -> String {
    format!("<collision name='c'><geometry><box><size>{size}</size></box></geometry></collision>")
}

fn sensor(inside: &str) -> String {
    format!(
        "<sensor name='ft' type='force_torque'><update_rate>100</update_rate><topic>ft</topic>
           <force_torque>{inside}</force_torque></sensor>"
    )
}

/// A joint between two links, with more inside.
fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent>{parent}</parent><child>{child}</child>{inside}</joint>"
    )
}

fn model(inside: &str) -> Model {
    load::model(&format!("<sdf version='1.7'><model name='m'>{inside}</model></sdf>")).unwrap()
}

/// A floor, and steps of 1 ms.
fn ground() -> World {
    World { max_step_size_s: 0.001, ..load::world("empty").unwrap() }
}

struct Bench {
    simulation: Simulation,
}

impl Bench {
    fn new(world: World, model: &Model, at: Pose) -> Self {
        let mut simulation = Simulation::builder(world).seed(4).build().unwrap();
        let options = SpawnOptions { world_from_model: at, ..SpawnOptions::default() };
        simulation.spawn(model, options).unwrap();
        Self { simulation }
    }

    fn read_from(&mut self, topic: &str) -> (Wrench, String) {
        let mut frame = FrameBuf::default();
        self.simulation.render(topic, &mut frame).unwrap();
        let frame_id = frame.header().frame_id.as_str().to_owned();
        (bytemuck::pod_read_unaligned(frame.payload()), frame_id)
    }

    fn read(&mut self) -> (Wrench, String) {
        self.read_from("ft")
    }

    /// The reading after some time, which is the mean of the last 100 ms of it.
    fn after(&mut self, milliseconds: u64) -> Wrench {
        self.simulation.run_for(Duration::from_millis(milliseconds - 100));
        self.read();
        self.simulation.run_for(Duration::from_millis(100));
        self.read().0
    }
}

fn at(z: f64) -> Pose {
    Pose::from_translation(DVec3::Z * z)
}

/// What such a model reads at rest, 2 m above the ground.
fn at_rest(inside: &str) -> Wrench {
    Bench::new(ground(), &model(inside), at(2.0)).after(400)
}

#[track_caller]
fn near(read: [f64; 3], expected: DVec3, within: f64) {
    assert!((DVec3::from(read) - expected).length() < within, "{read:?}, not {expected}");
}

/// A link that the world holds, and a weight of 1 kg below it on a joint at the link's origin.
fn hanging(kind: &str, force_torque: &str) -> String {
    let axis = if kind == "fixed" { "" } else { "<axis><xyz>0 1 0</xyz></axis>" };
    let inside = format!("<pose>0 0 0.5 0 0 0</pose>{axis}{}", sensor(force_torque));
    link("top", "0 0 0 0 0 0", 3.0, "")
        + &link("weight", "0 0 -0.5 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "top", "")
        + &joint("hinge", kind, "top", "weight", &inside)
}

/// The child pulls its parent down: Gazebo's own demo reads −196 N for 20 kg.
#[test]
fn a_weight_of_1_kg_pulls_its_parent_down() {
    for kind in ["fixed", "revolute", "ball"] {
        let read = at_rest(&hanging(kind, ""));
        near(read.force, DVec3::NEG_Z * G, 1e-3);
        near(read.torque, DVec3::ZERO, 1e-3);
        let read = at_rest(&hanging(kind, "<measure_direction>parent_to_child</measure_direction>"));
        near(read.force, DVec3::Z * G, 1e-3);
    }
}

#[test]
fn a_lever_makes_a_torque_about_the_joint() {
    let inside = link("wall", "0 0 0 0 0 0", 3.0, "")
        + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
        + &joint("held", "fixed", "world", "wall", "")
        + &joint("mount", "fixed", "wall", "arm", &format!("<pose>-0.5 0 0 0 0 0</pose>{}", sensor("")));
    let read = at_rest(&inside);
    near(read.force, DVec3::NEG_Z * (2.0 * G), 1e-3);
    // 0.5 m along x times 19.6 N down.
    near(read.torque, DVec3::Y * (0.5 * 2.0 * G), 1e-3);
}

/// What holds everything is a joint with the world.
#[test]
fn a_joint_with_the_world_carries_all_there_is() {
    let inside = link("wall", "0 0 0 0 0 0", 3.0, "")
        + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
        + &joint("held", "fixed", "world", "wall", &sensor(""))
        + &joint("mount", "fixed", "wall", "arm", "");
    let read = at_rest(&inside);
    near(read.force, DVec3::NEG_Z * (5.0 * G), 1e-3);
    near(read.torque, DVec3::Y * (0.5 * 2.0 * G), 1e-3);
}

/// Links and joint are rolled differently, so that each frame has its own down.
#[test]
fn frame_and_direction_are_those_of_the_file() {
    let (parent, child, of_joint, of_sensor) = (-0.3, 0.5, 0.2, 0.4);
    let model_of = |kind: &str, force_torque: &str| {
        let axis = "<axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>0</upper></limit></axis>";
        let axis = if kind == "fixed" { "" } else { axis };
        let sensor =
            sensor(force_torque).replace("<topic>", &format!("<pose>0 0 0 {of_sensor} 0 0</pose><topic>"));
        let inside = format!("<pose>0 0 0 {of_joint} 0 0</pose>{axis}{sensor}");
        link("top", &format!("0.1 0 0 {parent} 0 0"), 3.0, "")
            + &link("weight", &format!("0 0 -0.5 {child} 0 0"), 1.0, "")
            + &joint("held", "fixed", "world", "top", "")
            + &joint("hinge", kind, "top", "weight", &inside)
    };
    let down = |roll: f64| DVec3::new(0.0, -roll.sin(), -roll.cos()) * G;
    for kind in ["fixed", "revolute", "prismatic"] {
        for (frame, roll, frame_id) in [
            ("child", child, "weight"),
            ("parent", parent, "m/hinge/ft"),
            ("sensor", child + of_joint + of_sensor, "m/hinge/ft"),
        ] {
            let inside = format!("<frame>{frame}</frame>");
            let mut bench = Bench::new(ground(), &model(&model_of(kind, &inside)), at(2.0));
            near(bench.after(400).force, down(roll), 2e-3);
            assert_eq!(bench.read().1, frame_id, "{kind} {frame}");
            let other = inside + "<measure_direction>parent_to_child</measure_direction>";
            near(at_rest(&model_of(kind, &other)).force, -down(roll), 2e-3);
        }
    }
}

#[test]
fn a_torque_is_about_the_place_of_the_sensor() {
    let of = |pose: &str| {
        let sensor = sensor("").replace("<topic>", &format!("<pose>{pose}</pose><topic>"));
        at_rest(
            &(link("wall", "0 0 0 0 0 0", 3.0, "")
                + &link("arm", "0.5 0 0 0 0 0", 2.0, "")
                + &joint("held", "fixed", "world", "wall", "")
                + &joint("mount", "fixed", "wall", "arm", &sensor)),
        )
    };
    // At the centre of mass there is none.
    near(of("0 0 0 0 0 0").torque, DVec3::ZERO, 1e-3);
    near(of("-0.2 0 0 0 0 0").torque, DVec3::Y * (0.2 * 2.0 * G), 1e-3);
    near(of("0 0.3 0 0 0 0").torque, DVec3::X * (0.3 * 2.0 * G), 1e-3);
}

/// A slide of 2 kg on which 1 kg is mounted, 0.2 m above its sensor. Its motor gives 6 N.
#[test]
fn a_driven_slide_passes_on_what_accelerates_its_load() {
    let inside = link("rail", "0 0 0 0 0 0", 3.0, "")
        + &link("slide", "0 0 0 0 0 0", 2.0, "")
        + &link("load", "0 0 0.3 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "rail", "")
        + &joint(
            "drive",
            "prismatic",
            "rail",
            "slide",
            &format!("<axis><xyz>1 0 0</xyz></axis>{}", sensor("")),
        )
        + &joint("mount", "fixed", "slide", "load", &format!("<pose>0 0 -0.2 0 0 0</pose>{}", sensor("")));
    let model = model(&inside);
    let mut physics = Physics::new(&World::empty()).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model, Pose::IDENTITY)).unwrap();
    assert_eq!(physics.wrench(index, 0), None, "no step has been made");
    physics.drive_joint(index, 0, 100.0, 6.0);
    (0..200).for_each(|_| physics.step());
    // What the parent does to the child: 6 N for 3 kg are 2 m/s².
    let slide = physics.wrench(index, 0).unwrap();
    near(slide.force.to_array(), DVec3::new(6.0, 0.0, 3.0 * G), 5e-3);
    let load = physics.wrench(index, 1).unwrap();
    near(load.force.to_array(), DVec3::new(2.0, 0.0, G), 5e-3);
    near(load.torque.to_array(), DVec3::new(0.0, 0.2 * 2.0, 0.0), 5e-3);
}

#[test]
fn a_pendulum_pulls_hardest_at_the_bottom() {
    let inside = link("top", "0 0 0 0 0 0", 3.0, "")
        + &link("weight", "1 0 0 0 0 0", 1.0, "")
        + &joint("held", "fixed", "world", "top", "")
        + &joint(
            "hinge",
            "revolute",
            "top",
            "weight",
            &format!("<pose>-1 0 0 0 0 0</pose><axis><xyz>0 1 0</xyz></axis>{}", sensor("")),
        );
    let model = model(&inside);
    let mut physics = Physics::new(&World::empty()).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model, Pose::IDENTITY)).unwrap();
    let hardest = (0..1000)
        .map(|_| {
            physics.step();
            physics.wrench(index, 0).unwrap().force.x
        })
        .fold(0.0, f64::min);
    // Along the rod g + ω²·l, with half of I·ω² equal to m·g·l, and I = 1.01 kg·m².
    let expected = -(G + 2.0 * G / 1.01);
    assert!((hardest / expected - 1.0).abs() < 3e-3, "{hardest}, not {expected}");
}

/// Two halves of 1 kg turn about their middle in free space.
#[test]
fn what_holds_a_turning_body_together_is_measured() {
    let inside = link("left", "-0.5 0 0 0 0 0", 1.0, "")
        + &link("right", "0.5 0 0 0 0 0", 1.0, "")
        + &joint("between", "fixed", "left", "right", &sensor(""));
    let model = model(&inside);
    let mut world = World::empty();
    world.gravity = DVec3::ZERO;
    let mut physics = Physics::new(&world).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model, Pose::IDENTITY)).unwrap();
    physics.move_model(index, &Pose::IDENTITY, DVec3::ZERO, DVec3::Z * 2.0);
    (0..100).for_each(|_| physics.step());
    // m·ω²·r towards the middle.
    near(physics.wrench(index, 0).unwrap().force.to_array(), DVec3::NEG_X * 2.0, 0.01);
}

/// A body of 10 kg on a foot of 1 kg; its centre is 5 cm before the ankle.
fn standing(kind: &str) -> String {
    let axis = "<axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>0</upper></limit></axis>";
    let axis = if kind == "fixed" { "" } else { axis };
    let inertial = |pose: &str, mass_kg: f64| {
        format!(
            "<inertial><pose>{pose}</pose><mass>{mass_kg}</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.2</izz>
               </inertia></inertial>"
        )
    };
    format!(
        "<link name='body'><pose>0 0 0.1 0 0 0</pose>{}</link><link name='foot'><pose>0 0 0.1 0 0 0</pose>{}
           <collision name='c'><pose>0 0 -0.075 0 0 0</pose><geometry><box><size>0.4 0.3 0.05</size></box></geometry>
           </collision></link>{}",
        inertial("0.05 0 0.2 0 0 0", 10.0),
        inertial("0 0 -0.075 0 0 0", 1.0),
        joint("ankle", kind, "body", "foot", &format!("{axis}{}", sensor("")))
    )
}

#[test]
fn a_foot_on_the_ground_carries_the_bodys_weight() {
    for kind in ["fixed", "revolute"] {
        let mut bench = Bench::new(ground(), &model(&standing(kind)), Pose::IDENTITY);
        let read = bench.after(2000);
        near(read.force, DVec3::Z * (10.0 * G), 0.05);
        near(read.torque, DVec3::NEG_Y * (0.05 * 10.0 * G), 0.05);
    }
}

/// Gravity has a part along the ground, which friction holds.
#[test]
fn friction_of_a_foot_passes_through_its_ankle() {
    let mut world = ground();
    world.gravity = DVec3::new(1.5, -1.0, -G);
    let mut bench = Bench::new(world, &model(&standing("fixed")), Pose::IDENTITY);
    near(bench.after(2000).force, DVec3::new(-1.5, 1.0, G) * 10.0, 0.1);
}

/// Whatever the impact is like: from rest to rest, the joint has given what gravity has taken.
#[test]
fn an_impact_is_measured_as_a_whole() {
    for kind in ["fixed", "revolute"] {
        let model = model(&standing(kind));
        let mut physics = Physics::new(&ground()).unwrap();
        let index = physics.insert_model(&Placement::of_thing(&model, at(0.2))).unwrap();
        (0..3000).for_each(|_| physics.step());
        assert_eq!(physics.time_ns(), 3_000_000_000);
        let passed = physics.passed_at(index, 0, physics.time_ns()).unwrap();
        near((passed.force / (10.0 * G * 3.0)).to_array(), DVec3::NEG_Z, 2e-3);
    }
}

/// What the sensor reads of the foot is what accelerates the body, in each step.
#[test]
fn each_step_is_measured_exactly() {
    for kind in ["fixed", "revolute"] {
        let model = model(&standing(kind));
        let mut world = ground();
        world.gravity = DVec3::new(0.8, -0.5, -G);
        let mut physics = Physics::new(&world).unwrap();
        let index = physics.insert_model(&Placement::of_thing(&model, at(0.05))).unwrap();
        // The centre of the body.
        let velocity = |physics: &Physics| {
            let (linear, turn) = physics.link_velocity(index, 0);
            let arm = physics.world_from_link(index, 0).transform_vector(DVec3::new(0.05, 0.0, 0.2));
            linear + turn.cross(arm)
        };
        let mut before = velocity(&physics);
        let mut worst = 0.0_f64;
        for _ in 0..1000 {
            physics.step();
            let after = velocity(&physics);
            let expected = ((after - before) / physics.step_s() - physics.gravity()) * 10.0;
            before = after;
            let read = physics.wrench(index, 0).unwrap().force;
            let read = physics.world_from_link(index, 1).transform_vector(read);
            worst = worst.max((read + expected).length() / (1.0 + expected.length()));
        }
        assert!(worst < 0.01, "{kind}: {worst}");
    }
}

/// The air takes momentum from a link that loses velocity; what it takes does not pass through the joint.
#[test]
fn velocity_that_decays_is_no_force_of_the_joint() {
    let decay = "<velocity_decay><linear>0.001</linear><angular>0.001</angular></velocity_decay>";
    let inside = link("body", "0 0 0 0 0 0", 1.0, decay)
        + &link("load", "0 0 1 0 0 0", 1.0, decay)
        + &joint("mount", "fixed", "body", "load", &sensor(""));
    let model = model(&inside);
    let mut physics = Physics::new(&World::empty()).unwrap();
    let index = physics.insert_model(&Placement::of_thing(&model, Pose::IDENTITY)).unwrap();
    (0..1000).for_each(|_| physics.step());
    let read = physics.wrench(index, 0).unwrap();
    near(read.force.to_array(), DVec3::ZERO, 0.01);
}

#[test]
fn noise_has_its_deviation_and_is_the_same_again() {
    let noise =
        |stddev: f64| format!("<noise type='gaussian'><mean>0</mean><stddev>{stddev}</stddev></noise>");
    let inside = format!(
        "<force><x>{}</x><z>{}</z></force><torque><y>{}</y></torque>",
        noise(0.5),
        noise(2.0),
        noise(0.1)
    );
    let readings = || -> Vec<[f64; 6]> {
        let mut bench = Bench::new(ground(), &model(&hanging("fixed", &inside)), at(2.0));
        let mut read = || {
            bench.simulation.run_for(Duration::from_millis(10));
            let wrench = bench.read().0;
            let ([x, y, z], [a, b, c]) = (wrench.force, wrench.torque);
            [x, y, z, a, b, c]
        };
        (0..1000).map(|_| read()).collect()
    };
    let found = readings();
    assert_eq!(found, readings());
    for (axis, (mean, stddev)) in
        [(0.0, 0.5), (0.0, 0.0), (-G, 2.0), (0.0, 0.0), (0.0, 0.1), (0.0, 0.0)].into_iter().enumerate()
    {
        let average = found.iter().map(|wrench| wrench[axis]).sum::<f64>() / 1000.0;
        let variance = found.iter().map(|wrench| (wrench[axis] - mean).powi(2)).sum::<f64>() / 1000.0;
        // Three standard errors from 1000 samples.
        assert!((average - mean).abs() < 0.1 * stddev + 1e-3, "{axis}: {average}, not {mean}");
        assert!((variance.sqrt() - stddev).abs() < 0.07 * stddev + 1e-3, "{axis}: {variance}");
    }
}

/// A robot as in the files of iCub, with more inside.
fn robot(inside: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/>
               </inertial></link>"
        )
    };
    format!(
        "<robot name='r'><link name='world'/>{}{}<joint name='stand' type='fixed'><parent link='world'/>
           <child link='base'/></joint><joint name='ankle' type='fixed'><parent link='base'/><child link='foot'/>
           <origin xyz='0 0 -1'/></joint>\n{inside}</robot>",
        link("base"),
        link("foot")
    )
}

fn loaded(text: &str, gazebo_compat: bool) -> (Option<Model>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let rules = belvedere::description::Rules { gazebo_compat, ..Default::default() };
    let packages = belvedere::description::models::package_path([], None);
    let model = load::load_model_text(text, "text", &packages, rules, &mut diagnostics);
    (model, diagnostics.problems().to_vec())
}

#[test]
fn a_urdf_has_them_on_its_joints() {
    let on = |what: &str| format!("<gazebo reference='ankle'>{what}</gazebo>");
    let (model, problems) = loaded(&robot(&on("<sensor name='ft' type='force_torque'/>")), false);
    assert!(problems.is_empty(), "{problems:?}");
    let mut bench = Bench::new(ground(), &model.unwrap(), at(2.0));
    let topic = "/world/empty/model/r/joint/ankle/sensor/ft/forcetorque";
    assert!(
        bench.simulation.topics().unwrap().contains(&topic.to_owned()),
        "{:?}",
        bench.simulation.topics()
    );
    bench.simulation.run_for(Duration::from_millis(100));
    let (read, frame_id) = bench.read_from(topic);
    near(read.force, DVec3::NEG_Z * G, 1e-3);
    assert_eq!(frame_id, "foot");

    // What only links have is left out of a joint, and what only joints have of a link.
    let link = "<gazebo reference='foot'><sensor name='ft' type='force_torque'/></gazebo>".to_owned();
    for (file, what) in [
        (on("<sensor name='s' type='imu'/>"), "'s' of type 'imu' is on the joint 'ankle': it is left out"),
        (on("<sensor name='s' type='nonsense'/>"), "of type 'nonsense' is on the joint 'ankle'"),
        (link, "'ft' of type 'force_torque' is on a link: it is left out"),
    ] {
        let (model, problems) = loaded(&robot(&file), false);
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        assert!(problem.severity == Severity::Warning && problem.what.contains(what), "{problem}");
        let mut bench = Bench::new(ground(), &model.unwrap(), at(2.0));
        bench.simulation.run_for(Duration::from_millis(10));
        assert!(bench.simulation.topics().unwrap().iter().all(|topic| !topic.contains("sensor")));
    }
}

#[test]
fn what_is_written_wrong_is_one_error() {
    for (inside, what) in [
        ("<frame>world</frame>", "<frame> of sensor 'ft' is 'world'; write child or parent or sensor"),
        ("<measure_direction>up</measure_direction>", "<measure_direction> of sensor 'ft' is 'up'"),
        (
            "<force><x><noise type='gaussian'><stddev>-1</stddev></noise></x></force>",
            "<stddev> of sensor 'ft' is -1",
        ),
    ] {
        let text = format!("<sdf version='1.7'><model name='m'>{}</model></sdf>", hanging("fixed", inside));
        let (_, problems) = loaded(&text, false);
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        let told = problem.to_string();
        assert!(problem.severity == Severity::Error && told.contains(what), "{told}");
    }
}

#[test]
fn the_plugins_of_ros_publish_a_joint() {
    let plugin = |inside: &str| {
        format!("<gazebo><plugin name='p' filename='libgazebo_ros_ft_sensor.so'>{inside}</plugin></gazebo>")
    };
    for (inside, topic, rate_hz) in [
        (
            "<jointName>ankle</jointName><topicName>foot/wrench</topicName><robotNamespace>r</robotNamespace>
             <updateRate>50</updateRate>",
            "/r/foot/wrench",
            50.0,
        ),
        (
            "<ros><namespace>ns</namespace><remapping>wrench:=foot_ft</remapping></ros><joint_name>ankle</joint_name>
             <update_rate>25</update_rate>",
            "/ns/foot_ft",
            25.0,
        ),
    ] {
        let (model, problems) = loaded(&robot(&plugin(inside)), false);
        assert!(problems.is_empty(), "{problems:?}");
        let model = model.unwrap();
        assert_eq!(model.sensors[0].effective_rate_hz(), Some(rate_hz));
        let mut bench = Bench::new(ground(), &model, at(2.0));
        bench.simulation.run_for(Duration::from_millis(100));
        let (read, frame_id) = bench.read_from(topic);
        near(read.force, DVec3::NEG_Z * G, 1e-3);
        assert_eq!(frame_id, "foot");
    }
    for (inside, what) in [
        ("<jointName>ankel</jointName>", "'ankel', and there is no such joint"),
        ("<topicName>t</topicName>", "plugin 'p' has no <jointName>"),
        ("<body_name>foot</body_name>", "measures the forces on a link, which is not simulated"),
    ] {
        let told = |gazebo_compat: bool| {
            let (_, problems) = loaded(&robot(&plugin(inside)), gazebo_compat);
            let [problem] = &problems[..] else { panic!("{problems:?}") };
            assert!(problem.what.contains(what), "{problem}");
            problem.severity
        };
        assert_eq!([told(false), told(true)], [Severity::Error, Severity::Warning]);
    }
    let noisy =
        plugin("<jointName>ankle</jointName><topicName>t</topicName><gaussianNoise>0.5</gaussianNoise>");
    let mut bench = Bench::new(ground(), &loaded(&robot(&noisy), false).0.unwrap(), at(2.0));
    bench.simulation.run_for(Duration::from_millis(100));
    let off = DVec3::from(bench.read_from("t").0.force) + DVec3::Z * G;
    assert!((1e-3..3.0).contains(&off.length()), "{off}");
}

/// The joint of a nested model keeps its sensor, whatever comes before it.
#[test]
fn a_nested_model_keeps_its_sensor() {
    let inside = link("first", "0 0 0 0 0 0", 1.0, "")
        + &link("second", "0 0 0 0 0 0", 1.0, "")
        + &joint("other", "fixed", "first", "second", "");
    let nested = format!("{inside}<model name='in'>{}</model>", hanging("revolute", ""));
    let text = nested.replace("<topic>ft</topic>", "");
    let mut bench = Bench::new(ground(), &model(&text), at(2.0));
    bench.simulation.run_for(Duration::from_millis(50));
    let topic = "/world/empty/model/m/model/in/joint/hinge/sensor/ft/forcetorque";
    near(bench.read_from(topic).0.force, DVec3::NEG_Z * G, 1e-3);
}

#[test]
fn a_joint_that_cannot_be_measured_is_told() {
    let loop_of_joints = link("a", "0 0 0 0 0 0", 1.0, "")
        + &link("b", "1 0 0 0 0 0", 1.0, "")
        + &link("c", "0 1 0 0 0 0", 1.0, "")
        + &joint("ab", "revolute", "a", "b", &format!("<axis><xyz>0 0 1</xyz></axis>{}", sensor("")))
        + &joint("bc", "revolute", "b", "c", "<axis><xyz>0 0 1</xyz></axis>")
        + &joint("ca", "revolute", "c", "a", "<axis><xyz>0 0 1</xyz></axis>");
    let standing = "<static>true</static>".to_owned()
        + &link("a", "0 0 0 0 0 0", 1.0, "")
        + &link("b", "1 0 0 0 0 0", 1.0, "")
        + &joint("ab", "fixed", "a", "b", &sensor(""));
    let wheel = link("base", "0 0 0.1 0 0 0", 5.0, &boxed("0.4 0.2 0.1"))
        + &["left", "right"]
            .map(|side| {
                let y = if side == "left" { 0.2 } else { -0.2 };
                let shape = "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>";
                let of_sensor = if side == "left" { sensor("") } else { String::new() };
                link(side, &format!("0 {y} 0.1 0 0 0"), 1.0, shape)
                    + &joint(
                        &format!("{side}_joint"),
                        "revolute",
                        "base",
                        side,
                        &format!("<axis><xyz>0 1 0</xyz></axis>{of_sensor}"),
                    )
            })
            .concat()
        + "<plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>left_joint</leftJoint>
           <rightJoint>right_joint</rightJoint><wheelSeparation>0.4</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
           <robotBaseFrame>base</robotBaseFrame></plugin>";
    for (inside, what) in [
        (loop_of_joints, "cannot measure the joint 'ab': it is part of a loop of joints"),
        (standing, "cannot measure the joint 'ab': both of its sides stand still"),
        (wheel, "cannot measure the joint 'left_joint': it is that of a wheel"),
    ] {
        let mut bench = Bench::new(ground(), &model(&inside), at(0.5));
        let notes: Vec<String> = bench.simulation.notes().iter().map(Problem::to_string).collect();
        assert_eq!(notes.iter().filter(|note| note.contains(what)).count(), 1, "{what}: {notes:#?}");
        bench.simulation.run_for(Duration::from_millis(50));
        assert!(bench.simulation.topics().unwrap().iter().all(|topic| topic != "/ft"));
    }
}

//! Contact sensors: what they report of known contacts, under which names, and what is told of those that hear nothing.

use belvedere::description::diagnostics::{Diagnostics, Problem, Severity};
use belvedere::description::model::{Model, World};
use belvedere::description::{Rules, load, models};
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::Kind;
use belvedere_bridge::payload::Contact;
use belvedere_sensors::Pose;
use glam::DVec3;
use std::time::Duration;

const G: f64 = 9.8;
const FLOOR: &str = "ground_plane::link::collision";

fn loaded(text: &str) -> (Option<Model>, Vec<Problem>) {
    let mut diagnostics = Diagnostics::default();
    let packages = models::package_path([], None);
    let model = load::load_model_text(text, "text", &packages, Rules::default(), &mut diagnostics);
    (model, diagnostics.problems().to_vec())
}

fn accepted(text: &str) -> Model {
    let (model, problems) = loaded(text);
    assert!(problems.is_empty(), "{problems:?}");
    model.unwrap()
}

fn sensor(collisions: &[&str], inside: &str) -> String {
    let named: Vec<String> = collisions.iter().map(|name| format!("<collision>{name}</collision>")).collect();
    let named = named.concat();
    format!(
        "<sensor name='touch' type='contact'><update_rate>50</update_rate>
           <contact>{named}<topic>touch</topic></contact>{inside}</sensor>"
    )
}

/// A cube of 1 kg, with a head above it and more inside.
fn cube(inside: &str) -> String {
    format!(
        "<sdf version='1.7'><model name='cube'><link name='body'><inertial><mass>1</mass><inertia><ixx>0.0067</ixx>
           <iyy>0.0067</iyy><izz>0.0067</izz></inertia></inertial><collision name='box'><geometry><box>
           <size>0.2 0.2 0.2</size></box></geometry></collision><collision name='head'><pose>0 0 0.2 0 0 0</pose>
           <geometry><sphere><radius>0.05</radius></sphere></geometry></collision>\n{inside}</link></model></sdf>"
    )
}

fn at(z: f64) -> Pose {
    Pose::from_translation(DVec3::new(1.0, 2.0, z))
}

/// A model in a world with a floor.
struct Bench(Simulation);

impl Bench {
    fn new(model: &Model, world_from_model: Pose, gazebo_compat: bool) -> Self {
        let world = World { max_step_size_s: 0.001, ..load::world("empty").unwrap() };
        let mut simulation = Simulation::builder(world).gazebo_compat(gazebo_compat).build().unwrap();
        simulation.spawn(model, SpawnOptions { world_from_model, ..SpawnOptions::default() }).unwrap();
        Self(simulation)
    }

    fn run(&mut self, milliseconds: u64) -> &mut Self {
        self.0.run_for(Duration::from_millis(milliseconds));
        self
    }

    fn read_from(&mut self, topic: &str) -> (Vec<Contact>, String) {
        let mut frame = FrameBuf::default();
        self.0.render(topic, &mut frame).unwrap();
        let header = frame.header();
        assert_eq!(header.kind(), Some(Kind::Contacts));
        assert_eq!(frame.payload().len(), header.height as usize * size_of::<Contact>());
        (bytemuck::pod_collect_to_vec(frame.payload()), header.frame_id.as_str().to_owned())
    }

    fn read(&mut self) -> Vec<Contact> {
        self.read_from("touch").0
    }
}

fn total(contacts: &[Contact], of: fn(&Contact) -> [f64; 3]) -> DVec3 {
    contacts.iter().map(|contact| DVec3::from(of(contact))).sum()
}

fn force(contacts: &[Contact]) -> DVec3 {
    total(contacts, |contact| contact.force)
}

#[track_caller]
fn near(read: DVec3, expected: DVec3, within: f64) {
    assert!((read - expected).length() < within, "{read}, not {expected}");
}

/// Also when it has slept for long.
#[test]
fn a_cube_at_rest_presses_with_its_weight_on_its_four_corners() {
    let mut bench = Bench::new(&accepted(&cube(&sensor(&["box"], ""))), at(0.1), false);
    for milliseconds in [1000, 20, 5000, 20] {
        bench.run(milliseconds);
        let (contacts, frame_id) = bench.read_from("touch");
        assert_eq!((contacts.len(), frame_id.as_str()), (4, "world"));
        near(force(&contacts), DVec3::Z * G, 0.01 * G);
        near(total(&contacts, |contact| contact.torque), DVec3::ZERO, 1e-3);
        for contact in &contacts {
            assert_eq!(contact.collision1.as_str(), "cube::body::box");
            assert_eq!(contact.collision2.as_str(), FLOOR);
            near(contact.normal.into(), DVec3::Z, 1e-6);
            let [x, y, z] = contact.position;
            let corner = [(x - 1.0).abs(), (y - 2.0).abs()].map(|off| (off - 0.1).abs());
            assert!(corner.into_iter().all(|off| off < 1e-3) && z.abs() < 1e-3, "{contact:?}");
            assert!((0.0..1e-3).contains(&contact.depth), "{contact:?}");
        }
        near(total(&contacts, |contact| contact.position) / 4.0, DVec3::new(1.0, 2.0, 0.0), 1e-3);
    }
}

#[test]
fn without_contact_a_message_is_empty_and_a_sensor_hears_only_what_it_names() {
    for (named, hears) in [(&["head"][..], 0), (&["head", "box"], 4), (&["box", "box"], 4)] {
        let mut bench = Bench::new(&accepted(&cube(&sensor(named, ""))), at(0.1), false);
        assert_eq!(bench.run(500).read().len(), hears, "{named:?}");
    }
    let mut bench = Bench::new(&accepted(&cube(&sensor(&["box"], ""))), at(3.0), false);
    let rig = bench.0.streams(false).unwrap();
    let outlet = rig.outlets().into_iter().find(|outlet| outlet.topic() == "/touch").unwrap();
    assert_eq!(outlet.rate_hz(), Some(50.0));
    assert!(bench.run(100).read().is_empty());
}

/// From rest to rest, the floor gives what gravity takes. No impact between two messages is lost.
#[test]
fn a_fall_is_measured_as_a_whole_and_a_bounce_between_two_messages_is_heard() {
    let model = accepted(&cube(&sensor(&["box"], "")));
    let mut bench = Bench::new(&model, at(0.3), false);
    bench.read();
    let (mut passed, mut frames) = (DVec3::ZERO, 0);
    for _ in 0..100 {
        let contacts = bench.run(20).read();
        passed += force(&contacts) * 0.02;
        frames += usize::from(!contacts.is_empty());
    }
    near(passed, DVec3::Z * (G * 2.0), 2e-2);
    assert!(frames < 100);

    let bouncy = cube(&sensor(&["box"], "")).replace(
        "</geometry></collision><collision name='head'>",
        "</geometry><surface><bounce><restitution_coefficient>0.8</restitution_coefficient><threshold>0</threshold>
           </bounce></surface></collision><collision name='head'>",
    );
    let elastic = "<sdf version='1.7'><world name='w'><model name='ground_plane'><static>1</static><link name='link'>
        <collision name='collision'><geometry><plane/></geometry><surface><bounce><restitution_coefficient>1
        </restitution_coefficient><threshold>0</threshold></bounce></surface></collision></link></model></world></sdf>";
    let mut diagnostics = Diagnostics::default();
    let packages = models::package_path([], None);
    let world =
        load::load_world_text(elastic, "text", &packages, Rules::default(), &mut diagnostics).unwrap();
    let mut simulation = Simulation::builder(world).build().unwrap();
    let options = SpawnOptions { world_from_model: at(0.3), ..SpawnOptions::default() };
    simulation.spawn(&accepted(&bouncy), options).unwrap();
    let mut bench = Bench(simulation);
    bench.read();
    // It falls for 0.2 s, and is in the air again after 0.3 s.
    let contacts = bench.run(300).read();
    assert!(force(&contacts).z * 0.3 > 1.5 * G * 0.2, "{contacts:?}");
    assert!(bench.run(20).read().is_empty());
}

#[test]
fn a_shape_that_only_detects_is_heard_without_force() {
    let ghost = cube(&sensor(&["box"], "")).replace(
        "</box></geometry></collision>",
        "</box></geometry><surface><contact><collide_without_contact>true</collide_without_contact></contact>
           </surface></collision>",
    );
    // It falls through the floor until its head is there.
    let mut bench = Bench::new(&accepted(&ghost), at(0.15), false);
    assert!(bench.run(50).read().is_empty());
    let contacts = bench.run(100).read();
    assert!(!contacts.is_empty());
    assert_eq!(force(&contacts), DVec3::ZERO);
    assert!(contacts.iter().all(|contact| contact.depth > 0.01 && contact.normal[2] > 0.99), "{contacts:?}");
}

#[test]
fn a_name_that_is_not_there_is_one_warning_with_those_that_are() {
    for (inside, line, what) in [
        (
            "<sensor name='touch' type='contact'>\n<contact>\n<collision>bax</collision><topic>touch</topic></contact></sensor>",
            "text:7",
            "<collision> of sensor 'touch' is 'bax', and its link has no such collision: the sensor does not watch it; did \
             you mean 'box'? there are: box, head",
        ),
        (
            "<sensor name='touch' type='contact'><topic>touch</topic></sensor>",
            "text:5",
            "sensor 'touch' names no collision, so it reports no contacts; write <contact><collision>NAME</collision>\
             </contact>; there are: box, head",
        ),
    ] {
        let (model, problems) = loaded(&cube(inside));
        let [problem] = &problems[..] else { panic!("{problems:?}") };
        let told = problem.to_string();
        assert!(
            problem.severity == Severity::Warning && told.starts_with(line) && told.contains(what),
            "{told}"
        );
        assert!(Bench::new(&model.unwrap(), at(0.1), false).run(300).read().is_empty());
    }
}

/// A base with an arm that turns, and a bumper that is fixed to it. Gazebo lumps the bumper into the base.
fn robot(gazebo: &str) -> String {
    let link = |name: &str, collisions: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/>
               </inertial>{collisions}</link>"
        )
    };
    let foot = |x: f64| {
        format!(
            "<collision><origin xyz='{x} 0 -0.1'/><geometry><box size='0.1 0.4 0.2'/></geometry></collision>"
        )
    };
    let joint = |name: &str, kind: &str, child: &str| {
        format!(
            "<joint name='{name}' type='{kind}'><parent link='base'/><child link='{child}'/><axis xyz='0 0 1'/></joint>"
        )
    };
    format!(
        "<robot name='r'>{}{}{}{}{}{gazebo}</robot>",
        link("base", &(foot(0.0) + &foot(0.2).replace("<collision>", "<collision name='toe'>"))),
        link("bumper", &foot(-0.2)),
        link(
            "arm",
            "<collision><origin xyz='0 0 0.5'/><geometry><sphere radius='0.1'/></geometry></collision>"
        ),
        joint("mount", "fixed", "bumper"),
        joint("turn", "continuous", "arm"),
    )
}

#[test]
fn a_urdf_has_the_names_of_gazebos_conversion() {
    let all = [
        "base_collision",
        "base_fixed_joint_lump__toe_collision_1",
        "base_fixed_joint_lump__bumper_collision_2",
    ];
    let on = |link: &str, collisions: &[&str]| {
        format!("<gazebo reference='{link}'>{}</gazebo>", sensor(collisions, ""))
    };
    for (link, named, expected) in [
        ("base", &all[..], &all[..]),
        ("base", &all[2..], &all[2..]),
        // Before links are lumped, it has the name of its own link.
        ("bumper", &["bumper_collision"], &all[2..]),
    ] {
        let mut bench = Bench::new(&accepted(&robot(&on(link, named))), at(0.2), false);
        let mut names: Vec<String> =
            bench.run(500).read().iter().map(|contact| contact.collision1.as_str().to_owned()).collect();
        names.dedup();
        names.sort_unstable();
        let mut expected: Vec<String> = expected.iter().map(|name| format!("r::base::{name}")).collect();
        expected.sort_unstable();
        assert_eq!(names, expected);
    }
    // A joint that is preserved keeps its links apart.
    let kept = "<gazebo reference='mount'><preserveFixedJoint>true</preserveFixedJoint></gazebo>";
    let model = accepted(&robot(&(on("bumper", &["bumper_collision"]) + kept)));
    let bumper = model.link_named("bumper").unwrap();
    assert_eq!(model.collision_name(bumper, 0), "bumper::bumper_collision");
    let (_, problems) = loaded(&robot(&on("base", &["arm_collision"])));
    assert!(
        problems.len() == 1 && problems[0].remedy.contains(&format!("there are: {}", all.join(", "))),
        "{problems:?}"
    );
}

#[test]
fn the_plugins_of_ros_have_their_topics_and_frames() {
    let turned = Pose::from_xyz_rpy(DVec3::new(1.0, 2.0, 0.1), DVec3::Z * std::f64::consts::FRAC_PI_2);
    for (plugin, topic, frame) in [
        (
            "<bumperTopicName>bump</bumperTopicName><alwaysOn>true</alwaysOn><updateRate>9</updateRate>",
            "/bump",
            "world",
        ),
        ("<robotNamespace>r</robotNamespace><frameName>body</frameName>", "/r/bumper_states", "body"),
        ("<ros><namespace>n</namespace><remapping>bumper_states:=hit</remapping></ros>", "/n/hit", "world"),
        ("<frame_name>body</frame_name>", "/bumper_states", "body"),
    ] {
        let plugin = format!("<plugin name='p' filename='libgazebo_ros_bumper.so'>{plugin}</plugin>");
        let model = accepted(&cube(&sensor(&["box"], &plugin)));
        assert_eq!(model.sensors[0].effective_rate_hz(), Some(50.0));
        for gazebo_compat in [false, true] {
            let mut bench = Bench::new(&model, turned, gazebo_compat);
            let (contacts, frame_id) = bench.run(500).read_from(topic);
            assert_eq!(frame_id, frame);
            near(force(&contacts), DVec3::Z * G, 0.1);
            // Gazebo names the frame, but gives the points in the world.
            let in_link = frame == "body" && !gazebo_compat;
            let middle = if in_link { DVec3::NEG_Z * 0.1 } else { DVec3::new(1.0, 2.0, 0.0) };
            near(total(&contacts, |contact| contact.position) / 4.0, middle, 1e-3);
        }
    }
    let plugin = "<plugin name='p' filename='libgazebo_ros_bumper.so'><frameName>bdoy</frameName></plugin>";
    let mut bench = Bench::new(&accepted(&cube(&sensor(&["box"], plugin))), turned, false);
    let (_, frame_id) = bench.run(100).read_from("/bumper_states");
    let notes: Vec<String> = bench.0.notes().iter().map(Problem::to_string).collect();
    let told =
        notes.iter().filter(|note| note.contains("are in the frame 'bdoy', which is no link of its model"));
    assert_eq!((told.count(), frame_id.as_str()), (1, "world"), "{notes:?}");
}

/// gz-sim's name, the name of a nested link, and both sides of a contact.
#[test]
fn two_models_feel_each_other() {
    let sensor = sensor(&["box"], "").replace("<topic>touch</topic>", "");
    let nested = cube(&sensor)
        .replace("<model name='cube'>", "<model name='outer'><model name='cube'>")
        .replace("</model>", "</model></model>");
    let mut bench = Bench::new(&accepted(&nested), at(0.1), false);
    let upper = accepted(&cube(&sensor).replace("'cube'", "'upper'").replace("0 0 0.2 0 0 0", "0 0 0 0 0 0"));
    let lower = accepted(&cube(&sensor).replace("'cube'", "'lower'").replace("0 0 0.2 0 0 0", "0 0 0 0 0 0"));
    for (model, z) in [(&lower, 0.1), (&upper, 0.3)] {
        let world_from_model = Pose::from_translation(DVec3::new(-2.0, 0.0, z));
        bench.0.spawn(model, SpawnOptions { world_from_model, ..SpawnOptions::default() }).unwrap();
    }
    bench.run(1000);
    let topic = |model: &str| format!("/world/empty/model/{model}/link/body/sensor/touch/contact");
    let (contacts, _) = bench.read_from(&topic("outer/model/cube"));
    assert_eq!(contacts[0].collision1.as_str(), "outer::cube::body::box");
    let read = |bench: &mut Bench, model: &str, other: &str| {
        let (mut contacts, _) = bench.read_from(&topic(model));
        contacts.retain(|contact| contact.collision2.as_str() == other);
        force(&contacts)
    };
    near(read(&mut bench, "upper", "lower::body::box"), DVec3::Z * G, 0.1);
    near(read(&mut bench, "lower", "upper::body::box"), DVec3::NEG_Z * G, 0.1);
    near(read(&mut bench, "lower", FLOOR), DVec3::Z * (2.0 * G), 0.2);
}

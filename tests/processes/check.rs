//! The report of `check` agrees with the behaviour of `run`.

use crate::live::{output, own_domain};
use belvedere::description::load::{Described, LoadOptions, load, load_world, robot_names, world_names};
use belvedere::description::models::package_path;
use belvedere::description::{Diagnostics, Rules};
use belvedere::server::{Server, ServerOptions};
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::{Domain, Kind, Node};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Kind, rate in Hz and frame of streams by their topics.
type Streams = BTreeMap<String, (String, Option<String>, String)>;

/// Options for a world without an added robot.
const NO_ROBOT: [&str; 2] = ["--robot", "none"];
const NO_WORLD: [&str; 2] = ["--world", "empty"];
/// A robot in addition to the models of a world.
const BESIDE: [&str; 4] = ["--robot", "kobuki_nostack_rplidar", "--pose", "50,50"];

fn checked(file: &str, options: &[&str]) -> (String, Option<i32>) {
    let done = output(&[&["check", file][..], options].concat());
    let said = [done.stdout, done.stderr].concat();
    (String::from_utf8(said).unwrap(), done.status.code())
}

/// The streams that `check` reports: `publishes TOPIC: KIND [ENCODING], RATE Hz, frame FRAME`.
fn reported(said: &str) -> Streams {
    let lines = said.lines().filter_map(|line| line.trim_start().strip_prefix("publishes "));
    let stream = |line: &str| {
        let (topic, rest) = line.trim_start().split_once(": ")?;
        let mut parts = rest.split(", ");
        let kind = parts.next()?.split(' ').next()?.to_owned();
        let rate = parts.next()?.strip_suffix(" Hz").map(str::to_owned);
        let frame = parts.next().and_then(|part| part.strip_prefix("frame ")).unwrap_or_default();
        Some((topic.to_owned(), (kind, rate, frame.to_owned())))
    };
    lines.filter_map(stream).collect()
}

/// Returns the streams that a server of a world, or of a robot in the empty world, publishes, as listed by `belvedere
/// list`.
fn published(described: Option<Described>) -> Streams {
    let mut simulation = match described {
        Some(Described::World(world)) => Simulation::builder(world).build().unwrap(),
        other => {
            let packages = package_path([], None);
            let empty =
                load_world("empty", &packages, Rules::default(), &mut Diagnostics::default()).unwrap();
            let mut simulation = Simulation::builder(empty).build().unwrap();
            if let Some(Described::Model(robot)) = other {
                let options = SpawnOptions { is_robot: Some(true), ..SpawnOptions::default() };
                simulation.spawn(&robot, options).unwrap();
            }
            simulation
        }
    };
    let node = Node::open(&Domain::new(&own_domain()).unwrap(), "belvedere").unwrap();
    let _server = Server::attach(&mut simulation, &node, ServerOptions::default()).unwrap();
    let streams = node.streams().unwrap().into_iter().filter(|stream| stream.publishers > 0);
    let stream = |stream: belvedere_bridge::StreamInfo| {
        // Formatted like in `check`, with at most seven decimals.
        let rate = stream.rate_hz.map(|hz| {
            let text = format!("{hz:.7}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        });
        (
            format!("/{}", stream.topic),
            (stream.kind.map(Kind::as_str).unwrap().to_owned(), rate, stream.frame_id),
        )
    };
    streams.map(stream).collect()
}

#[test]
fn check_reports_the_published_streams() {
    let packages = package_path([], None);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of_tests = [
        "tests/instruments.urdf",
        "tests/rangefinders.urdf",
        "tests/lenses.urdf",
        "tests/lidars/hall.world",
        "tests/dataset/eyes.sdf",
        "tests/zurich.world",
    ];
    let of_tests = of_tests.map(|path| root.join(path).to_str().unwrap().to_owned());
    let folder = TempDir::new().unwrap();
    let moving = moving_things(&folder).to_str().unwrap().to_owned();
    let files = robot_names(&packages).into_iter().chain(world_names(&packages)).chain(of_tests);
    let own = published(None);
    let options = LoadOptions { packages, rules: Rules::default(), xacro_args: Vec::new() };
    let mut count = 0;
    for file in files.chain([moving]) {
        let mut diagnostics = Diagnostics::default();
        let described = load(&file, &options, &mut diagnostics).unwrap();
        let alone = if matches!(described, Described::World(_)) { NO_ROBOT } else { NO_WORLD };
        let mut streams = published(Some(described));
        streams.retain(|topic, _| !own.contains_key(topic));
        let (said, code) = checked(&file, &alone);
        assert_eq!(code, Some(0), "{file}: {said}");
        assert_eq!(reported(&said), streams, "{file}:\n{said}");
        count += streams.len();
    }
    assert!(count > 100, "{count}");
}

/// A world with moving models that report, and sensors of gz-sim, one of them under a name that is taken.
fn moving_things(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("moving.world");
    let planar = |name: &str, x: u32| {
        format!(
            "<model name='{name}'><pose>{x} 0 0 0 0 0</pose><link name='base_link'/>
             <plugin name='move' filename='libgazebo_ros_planar_move.so'><odometryTopic>{name}/odom</odometryTopic></plugin>
             <plugin name='pose' filename='libgazebo_ros_p3d.so'><bodyName>base_link</bodyName>
               <topicName>{name}/truth</topicName><updateRate>7</updateRate></plugin></model>"
        )
    };
    let text = format!(
        "<sdf version='1.6'><world name='w'>{}{}{}</world></sdf>",
        planar("one", 0),
        planar("two", 5),
        cameras("left", "right")
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// Two cameras as in gz-sim's demos, whose camera infos have the same topic.
fn cameras(one: &str, other: &str) -> String {
    let sensor = |topic: &str| {
        format!(
            "<sensor name='eye_{topic}' type='camera'>\n<topic>{topic}</topic><update_rate>10</update_rate>
             <camera><image><width>32</width><height>24</height></image></camera></sensor>"
        )
    };
    format!(
        "<model name='eyes'><static>true</static><link name='link'>{}{}</link></model>",
        sensor(one),
        sensor(other)
    )
}

fn world(folder: &TempDir, inside: &str) -> String {
    let path = folder.path().join("w.world");
    std::fs::write(&path, format!("<sdf version='1.6'><world name='w'>\n{inside}\n</world></sdf>")).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The output of `run` for a world, and the published topics.
fn run(world: &str, options: &[&str]) -> (String, Option<i32>, Vec<String>) {
    run_of(&[&["--world", world][..], &BESIDE, options].concat())
}

/// The output of `run` with these options, and the published topics.
fn run_of(options: &[&str]) -> (String, Option<i32>, Vec<String>) {
    let domain = own_domain();
    let start = ["run", "--domain", &domain, "--rate", "max", "--duration", "0.001", "--hash"];
    let done = output(&[&start[..], options].concat());
    let topics = String::from_utf8(done.stdout).unwrap();
    let topics = topics.lines().filter_map(|line| line.split_whitespace().nth(1));
    let topics = topics.filter(|topic| topic.starts_with('/')).map(str::to_owned).collect();
    (String::from_utf8(done.stderr).unwrap(), done.status.code(), topics)
}

/// The robot that is added to a world, several robots with namespaces, and ground truth are checked as they are run.
#[test]
fn check_and_run_accept_the_same_arguments() {
    let folder = TempDir::new().unwrap();
    let file = world(&folder, &cameras("left", "right"));
    let robots = ["--robot", "kobuki_nostack_rplidar", "--robot", "kobuki_hexagons_kinect"];
    let names = ["--world", "empty", "--name", "b", "--name", "a"];
    let (_, _, own) = run_of(&[NO_ROBOT, NO_WORLD].concat());
    let run = |options: &[&str]| {
        let (warned, code, mut topics) = run_of(options);
        assert_eq!(code, Some(0), "{warned}");
        topics.retain(|topic| !own.contains(topic));
        topics
    };
    let two = [&robots[..], &names].concat();
    for (given, options) in [
        (&[][..], &[][..]) as (&[&str], &[&str]),
        (&[file.as_str()], &["--world", &file]),
        (&[&file, "--robot", "none"], &["--world", &file, "--robot", "none"]),
        (&["kobuki_nostack_camera", "--truth"], &["--robot", "kobuki_nostack_camera", "--truth"]),
        (&two, &two),
    ] {
        let done = output(&[&["check"][..], given].concat());
        let said = String::from_utf8(done.stdout).unwrap();
        assert!(done.status.success(), "{given:?}: {}", String::from_utf8_lossy(&done.stderr));
        let mut topics = run(options);
        topics.sort();
        assert!(topics.len() > 3, "{topics:?}");
        assert_eq!(reported(&said).into_keys().collect::<Vec<_>>(), topics, "{given:?}:\n{said}");
    }
    // `check` refuses the same input as `run`, with the same message.
    let robot = "<model name='kobuki_nostack_camera'><static>true</static><link name='l'/></model>";
    let taken = world(&folder, &robot.replace("kobuki_nostack_camera", "turtlebot"));
    let (said, code) = checked(&taken, &[]);
    let (refused, run_code, _) = run_of(&["--world", &taken]);
    assert_eq!((code, run_code), (Some(1), Some(1)), "{said}\n{refused}");
    let words = "a model of the world is called 'turtlebot'";
    assert!(said.contains(words) && refused.contains(words), "{said}\n{refused}");
    for (file, option) in [("playground", "--world"), ("kobuki_nostack_camera", "--robot")] {
        let (said, code) = checked(file, &[option, file]);
        assert_eq!(code, Some(1), "{said}");
        assert!(said.contains(&format!("'{file}' is given together with {option}")), "{said}");
    }
}

#[test]
fn two_streams_with_one_name_are_an_error_in_check_and_run() {
    let folder = TempDir::new().unwrap();
    let model = |name: &str, inside: &str| {
        format!("<model name='{name}'><static>true</static><link name='link'>{inside}</link></model>\n")
    };
    let lidar = "<sensor name='scanner' type='gpu_lidar'><topic>taken</topic><lidar><range><max>9</max></range></lidar></sensor>";
    let camera = "<sensor name='eye' type='camera'><topic>taken</topic></sensor>";
    let file = world(&folder, &[model("one", lidar), model("other", camera)].concat());
    let words = [
        "w.world:3: error: two streams are called /taken",
        "that of sensor 'eye' of model 'other'",
        "that of sensor 'scanner' of model 'one' (",
        "w.world:2)",
        "give one of them another topic",
    ];
    let (said, code) = checked(&file, &BESIDE);
    let (refused, run_code, _) = run(&file, &[]);
    assert_eq!((code, run_code), (Some(1), Some(1)), "{said}\n{refused}");
    for words in words {
        assert!(said.contains(words) && refused.contains(words), "{words}:\n{said}\n{refused}");
    }
    // In Gazebo mode it continues with another name.
    let compat = ["--gazebo-compat"];
    let (said, code) = checked(&file, &[&BESIDE[..], &compat].concat());
    let (warned, run_code, topics) = run(&file, &compat);
    assert_eq!((code, run_code), (Some(0), Some(0)), "{said}\n{warned}");
    let words = "sensor 'eye' of model 'other' has the topic /taken, which is that of sensor 'scanner' of model 'one'";
    assert!(said.contains(words) && warned.contains(words), "{said}\n{warned}");
    assert!(said.contains("publishes    /taken_2: image"), "{said}");
    assert!(
        ["/taken", "/taken_2"].iter().all(|topic| topics.iter().any(|there| there == topic)),
        "{topics:?}"
    );
    // The same for plugins.
    let planar = |name: &str, y: u32| {
        format!(
            "<model name='{name}'><pose>0 {y} 0 0 0 0</pose><link name='l'/>
             <plugin name='p' filename='libgazebo_ros_planar_move.so'/></model>\n"
        )
    };
    let file = world(&folder, &[planar("a", 0), planar("b", 9)].concat());
    let (said, code) = checked(&file, &BESIDE);
    assert_eq!(code, Some(1), "{said}");
    let words = "two streams are called /odom: that of the planar move base of model 'b' and, before it, that of the planar \
                 move base of model 'a' (";
    assert!(said.contains(words) && said.contains("namespace"), "{said}");
}

#[test]
fn a_second_camera_info_is_renamed_after_its_picture() {
    let folder = TempDir::new().unwrap();
    let file = world(&folder, &cameras("left", "right"));
    for options in [&[][..], &["--gazebo-compat"]] {
        let (said, code) = checked(&file, &[&BESIDE[..], options].concat());
        let (warned, run_code, topics) = run(&file, options);
        assert_eq!((code, run_code), (Some(0), Some(0)), "{said}\n{warned}");
        let words = "warning: sensor 'eye_right' of model 'eyes' has the topic /camera_info, which is that of sensor 'eye_left'";
        assert!(said.contains(words), "{said}");
        for text in [&said, &warned] {
            assert!(text.contains("it is published as /right/camera_info"), "{text}");
        }
        for topic in ["/left", "/right", "/camera_info", "/right/camera_info"] {
            assert!(topics.iter().any(|there| there == topic), "{topic}: {topics:?}");
        }
    }
    // In separate folders, each keeps its own name.
    let file = world(&folder, &cameras("left/image", "right/image"));
    let (said, _) = checked(&file, &BESIDE);
    assert!(!said.contains("which is that of") && said.contains("publishes    /right/camera_info"), "{said}");
}

fn sensor(folder: &TempDir, kind: &str, inside: &str) -> String {
    let path = folder.path().join("s.sdf");
    let text = format!(
        "<sdf version='1.6'><model name='m'><static>true</static><link name='link'><sensor name='s' type='{kind}'>
         <topic>t</topic>{inside}</sensor></link></model></sdf>"
    );
    std::fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn check_reports_the_settings_of_sensors() {
    let folder = TempDir::new().unwrap();
    let own = |inside: &str| format!("<plugin name='p' filename='belvedere'>{inside}</plugin>");
    let line = |said: &str, name: &str| {
        let mut lines = said.lines().map(str::trim_start);
        let line =
            lines.find_map(|line| line.strip_prefix(name)).unwrap_or_else(|| panic!("no {name}:\n{said}"));
        line.trim_start().to_owned()
    };
    let of = |kind: &str, inside: &str| checked(&sensor(&folder, kind, inside), &NO_WORLD).0;
    // The noise of a preset.
    let noise = |preset: &str| line(&of("gpu_lidar", &own(&format!("<preset>{preset}</preset>"))), "noise ");
    assert_eq!(noise("rplidar_a1"), "stddev 0.00033·r² m, r the range in m, rounded to 0.00025 m");
    let of_lms = noise("lms511");
    assert!(
        of_lms.starts_with("stddev 0.006 m, stddev 0.008 m from 10 m on, stddev 0.014 m from 20 m on, bias"),
        "{of_lms}"
    );
    assert!(noise("vlp16").starts_with("gaussian, mean 0, stddev 0.0"), "{}", noise("vlp16"));
    for preset in ["kinect_v1", "d435"] {
        let said = of("rgbd_camera", &own(&format!("<preset>{preset}</preset>")));
        let noise = line(&said, "depth noise ");
        assert!(noise.starts_with("stddev ") && noise.contains(" mm at "), "{noise}");
    }
    // For scanners, all settings that are not reported elsewhere.
    let said = of(
        "gpu_lidar",
        &own(
            "<preset>vlp16</preset><returns>dual</returns><intensity>power</intensity><receiver_reach>90</receiver_reach>\
             <rain_rate>12</rain_rate><crosstalk>0.01</crosstalk><beam_halo>0.02 0.01</beam_halo>",
        ),
    );
    for (name, words) in [
        ("returns ", "dual"),
        ("intensity ", "power"),
        ("receiver ", "reach 90 m"),
        ("weather ", "rain of 12 mm/h"),
        ("crosstalk ", "0.01 of the firings"),
        ("halo ", "0.02 of the light within 0.01 rad"),
        ("packets ", "Velodyne's"),
    ] {
        assert!(line(&said, name).contains(words), "{name}{words}:\n{said}");
    }
    let said = of("gpu_lidar", &own("<preset>os1_32</preset><returns>dual</returns>"));
    assert!(line(&said, "packets ").contains("RNG19_RFL8_SIG16_NIR16_DUAL"), "{said}");
    assert!(said.contains("publishes    /t/points2: "), "{said}");
    // The lens that is rendered, and anti-aliasing.
    let distortion = "<camera><image><anti_aliasing>4</anti_aliasing></image><distortion><k1>-0.2</k1></distortion></camera>";
    let plugin =
        "<plugin name='p' filename='libgazebo_ros_camera.so'><distortionK1>-0.1</distortionK1></plugin>";
    let file = sensor(&folder, "camera", &format!("{distortion}{plugin}"));
    let (said, _) = checked(&file, &NO_WORLD);
    assert!(line(&said, "lens ").contains("= -0.1,"), "{said}");
    assert!(line(&said, "edges ").contains("smoothed"), "{said}");
    let (said, _) = checked(&file, &["--gazebo-compat", "--world", "empty"]);
    assert!(line(&said, "lens ").contains("= -0.2"), "{said}");
    assert!(line(&said, "camera_info ").contains("= -0.1,"), "{said}");
    assert!(said.contains("apply to camera_info only: the picture has those in <distortion>"), "{said}");
    // A device has its own noise.
    let said = of("camera", &own("<preset>webcam</preset>"));
    assert!(line(&said, "device ").contains("read noise") && !said.contains("noise        none"), "{said}");
    // Without a topic, it has gz-sim's.
    sensor(&folder, "camera", "");
    let path = folder.path().join("s.sdf");
    std::fs::write(&path, std::fs::read_to_string(&path).unwrap().replace("<topic>t</topic>", "")).unwrap();
    let (said, _) = checked(path.to_str().unwrap(), &NO_WORLD);
    assert!(said.contains("publishes    /world/empty/model/m/link/link/sensor/s/image: "), "{said}");
}

#[test]
fn check_counts_tags_and_reports_ignored_lights_and_numbers() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("r.urdf");
    let robot = |family: &str, id: u32| {
        let text = format!(
            "<robot name='r'><link name='base'><visual><geometry><box size='1 1 1'/></geometry></visual></link>
<gazebo reference='base'><visual><fiducial><family>{family}</family><id>{id}</id><size>0.1</size></fiducial></visual>
<light name='lamp' type='point'/></gazebo><gazebo><light name='other' type='point'/></gazebo></robot>"
        );
        std::fs::write(&path, text).unwrap();
        checked(path.to_str().unwrap(), &NO_WORLD).0
    };
    let said = robot("tag36h11", 7);
    assert!(said.contains("\nfiducials: tag36h11\n"), "{said}");
    for light in
        ["r.urdf:3: warning: the light 'lamp' of a robot is left out", "the light 'other' of a robot"]
    {
        assert!(said.contains(light), "{said}");
    }
    assert!(robot("tag36h11", 587).contains("<id> of a <fiducial> is 587, and tag36h11 has 587 tags"));
    assert!(robot("tag99h1", 0).contains("'tag99h1', which is not one of AprilTag's; these are: tag16h5,"));
    assert!(!robot("aruco", 9999).contains("fiducial>"));
    let model = |pose: &str| {
        let text =
            format!("<sdf version='1.6'><model name='m'><pose>{pose}</pose><link name='l'/></model></sdf>");
        let path = folder.path().join("m.sdf");
        std::fs::write(&path, text).unwrap();
        checked(path.to_str().unwrap(), &["--gazebo-compat", "--world", "empty"]).0
    };
    assert!(model("1 2 3 4 5").contains("which has 5 numbers: those that are missing are taken as 0"));
    assert!(model("1 2 3 4 5 6 7").contains("which has 7 numbers: only the first 6 are read"));
}

#[test]
fn elements_that_are_not_simulated_are_counted_and_errors_if_strict() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("door.world");
    let world = "<sdf version='1.8'><world name='w'><model name='m'><link name='a'/><link name='b'/>\n\
                 <joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>\
                 </axis><sensor name='s' type='imu'/><physics><ode/></physics></joint></model></world></sdf>";
    std::fs::write(&file, world).unwrap();
    let file = file.to_str().unwrap();
    let warning =
        format!("{file}:2: warning: the sensor 's' of type 'imu' is on the joint 'j': it is left out");
    let checked = output(&["check", file, "--robot", "none"]);
    let text = String::from_utf8_lossy(&checked.stdout);
    assert!(checked.status.success() && text.contains(&warning), "{text}");
    assert!(text.ends_with("no errors, 1 warning and 1 note\n"), "{text}");
    for command in [
        &["check", file, "--robot", "none", "--strict"][..],
        &["run", "--world", file, "--robot", "none", "--strict"],
    ] {
        let checked = output(command);
        let text = String::from_utf8_lossy(&checked.stderr);
        assert_eq!(checked.status.code(), Some(1), "{command:?}: {text}");
        assert!(text.contains(&warning.replace("warning", "error")), "{command:?}: {text}");
    }
}

//! A running simulator as seen by another process: names, camera infos, rates from the description, and no files
//! afterwards. Rates by the clock are tested in `real_time.rs`.

use crate::live;

use crate::live::{Simulator, files_of, next_frame, output, own_domain};
use belvedere_bridge::payload::{CameraInfo, Odometry, VelocityCommand};
use belvedere_bridge::{DistortionModel, Encoding, StreamSpec};
use std::time::Instant;

fn camera_info(arguments: &[&str]) -> CameraInfo {
    let simulator = Simulator::start(arguments);
    let mut subscriber = simulator.subscribe("/camera_info");
    let frame = next_frame(&mut subscriber);
    frame.message().unwrap()
}

#[test]
fn the_ceiling_cameras_info_matches_the_article() {
    for (arguments, centre) in
        [(&["--drive", "still"][..], [319.5, 239.5]), (&["--gazebo-compat"], [320.5, 240.5])]
    {
        let info = camera_info(arguments);
        assert_eq!([info.width, info.height], [640, 480]);
        assert!((info.k[0] - 381.361_15).abs() < 1e-4, "fx is {}", info.k[0]);
        assert_eq!(info.k, [info.k[0], 0.0, centre[0], 0.0, info.k[0], centre[1], 0.0, 0.0, 1.0]);
        assert_eq!(info.distortion_model.as_str(), "plumb_bob");
        assert_eq!(&info.d[..info.d_len as usize], [0.0; 5]);
        assert_eq!(info.p[3], -info.k[0] * 0.07);
        assert_eq!(
            [info.p[0], info.p[2], info.p[5], info.p[6]],
            [info.k[0], centre[0], info.k[0], centre[1]]
        );
    }
}

#[test]
fn pictures_and_infos_describe_the_lens() {
    const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/lenses.urdf");
    let simulator = Simulator::start(&["--robot", ROBOT, "--drive", "still"]);
    let all = [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.009, 0.01, 0.011, 0.012, 0.013, 0.014];
    for (camera, model, parameters, p) in [
        // As in the file.
        ("tilted", DistortionModel::RationalPolynomial, &all[..], [150.0, 151.0]),
        // 80 over the radius at 1.2: 1.2 + 0.05·1.2³ − 0.01·1.2⁵ + 0.002·1.2⁷ + 0.0001·1.2⁹
        ("fisheye", DistortionModel::Equidistant, &[0.05, -0.01, 0.002, 0.0001], [63.031_874; 2]),
        // 80 over the radius at 1.2, over 1 − 0.2: with w = cos 1.2 − 0.2, sin 1.2 / (0.6·√(sin² + w²) + 0.4·w)
        ("spheres", DistortionModel::DoubleSphere, &[-0.2, 0.6], [67.871_379; 2]),
    ] {
        let picture = next_frame(&mut simulator.subscribe(&format!("/{camera}/image_raw")));
        let lens = *picture.header().intrinsics().unwrap();
        assert_eq!((lens.model(), lens.parameters()), (Some(model), parameters), "{camera}");
        let info: CameraInfo =
            next_frame(&mut simulator.subscribe(&format!("/{camera}/camera_info"))).message().unwrap();
        assert_eq!(info.distortion_model.as_str(), model.as_str());
        assert_eq!(&info.d[..info.d_len as usize], parameters, "{camera}");
        assert_eq!(info.k, [lens.fx, lens.skew, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0]);
        assert!((info.p[0] - p[0]).abs() < 1e-5 && (info.p[5] - p[1]).abs() < 1e-5, "{camera}: {:?}", info.p);
    }
}

#[test]
fn ground_truth_is_published_on_request() {
    let simulator = Simulator::start(&["--truth", "--drive", "still"]);
    let take = |channel: &str, encoding: Encoding| -> Vec<u8> {
        let frame = next_frame(&mut simulator.subscribe(&format!("/image_raw/truth/{channel}")));
        assert_eq!(frame.header().encoding(), Some(encoding), "{channel}");
        assert_eq!([frame.header().width, frame.header().height], [640, 480], "{channel}");
        frame.payload().to_vec()
    };
    let floats = |channel, encoding| -> Vec<f32> {
        let bytes = take(channel, encoding);
        bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
    };
    let numbers = |channel| -> Vec<i32> {
        let bytes = take(channel, Encoding::I32C1);
        bytes.as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect()
    };
    let [depth, range, incidence] =
        ["depth", "range", "incidence"].map(|channel| floats(channel, Encoding::F32C1));
    let (normal, flow) = (floats("normal", Encoding::F32C3), floats("flow_back", Encoding::F32C2));
    let (instance, class) = (numbers("instance"), numbers("class"));
    // The camera looks up at the ceiling, which is parallel to the picture.
    let (mut ceiling, mut wrong) = (0, 0);
    for pixel in 0..640 * 480 {
        assert_eq!(instance[pixel] < 0, depth[pixel].is_infinite());
        assert_eq!(instance[pixel] < 0, class[pixel] == 0);
        if normal[3 * pixel + 2] < -0.999 && (depth[pixel] - depth[240 * 640 + 320]).abs() < 1e-3 {
            ceiling += 1;
            let off = incidence[pixel].cos() - depth[pixel] / range[pixel];
            let flows = flow[2 * pixel].abs() > 1e-2 || flow[2 * pixel + 1].abs() > 1e-2;
            wrong += u32::from(off.abs() > 2e-3 || flows);
        }
    }
    // These are from several frames, between which the robot comes to rest, so edges move by some pixels.
    println!("{ceiling} pixels of the ceiling, {wrong} of them at edges that moved");
    assert!(1000 * wrong < ceiling, "{wrong} of {ceiling}");
    // More than half of the picture; the rest are lamps, and tags in front of the ceiling.
    assert!(2 * ceiling > 640 * 480, "{ceiling} pixels of the ceiling");
}

#[test]
fn the_kinect_publishes_at_the_lower_of_both_rates() {
    let simulator = Simulator::start(&["--robot", "kobuki_hexagons_kinect", "--drive", "still"]);
    let node = simulator.node();
    let topics = [
        ("camera/rgb/image_raw", 640 * 480 * 3),
        ("camera/rgb/camera_info", 400),
        ("camera/depth/image_raw", 640 * 480 * 4),
        ("camera/depth/camera_info", 400),
        ("camera/depth/points", 640 * 480 * 32),
    ];
    let mut subscribers: Vec<_> = topics.iter().map(|(topic, _)| node.subscriber(topic).unwrap()).collect();
    let mut stamps: Vec<Vec<u64>> = vec![Vec::new(); topics.len()];
    for (index, subscriber) in subscribers.iter_mut().enumerate() {
        for _ in 0..3 {
            let frame = next_frame(subscriber);
            assert_eq!(frame.payload().len(), topics[index].1, "{}", topics[index].0);
            assert_eq!(frame.header().frame_id.as_str(), "camera_depth_optical_frame");
            stamps[index].push(frame.header().stamp_ns);
        }
    }
    for stamps in stamps {
        // The sensor has 20 Hz, the plugin 10 Hz: both pictures and infos come every 0.1 s.
        assert!(stamps.iter().all(|stamp| stamp % 100_000_000 == 0), "{stamps:?}");
    }
    assert!(
        node.streams()
            .unwrap()
            .iter()
            .filter(|stream| stream.topic.starts_with("camera/"))
            .all(|stream| stream.rate_hz == Some(10.0))
    );
}

/// Commands from another process drive the robot; it stands 0.6 s after the last one.
#[test]
fn velocity_commands_drive_the_robot() {
    let simulator = Simulator::start(&["--drive", "still"]);
    let node = simulator.node();
    let mut odometry = node.subscriber("/odom").unwrap();
    let x_m = |frame: &belvedere_bridge::Frame| frame.message::<Odometry>().unwrap().position[0];
    let start = x_m(&next_frame(&mut odometry));
    let commands = node.publisher(&StreamSpec::velocity_command("/cmd_vel")).unwrap();
    let forward = VelocityCommand { linear: [0.3, 0.0, 0.0], angular: [0.0; 3] };
    let started = Instant::now();
    let (mut farthest, mut last_sent_ns) = (start, 0);
    while farthest < start + 0.2 {
        assert!(started.elapsed() < live::PATIENCE, "the robot does not move");
        commands.send_structs(0, &[forward]).unwrap();
        let frame = next_frame(&mut odometry);
        (farthest, last_sent_ns) = (x_m(&frame), frame.header().stamp_ns);
    }
    // The command is valid for 0.6 s and may have been taken 20 ms later; stopping from 0.3 m/s takes 0.3 s at 1 m/s².
    let at_rest = std::iter::repeat_with(|| next_frame(&mut odometry))
        .find(|frame| frame.header().stamp_ns > last_sent_ns + 1_200_000_000)
        .unwrap();
    let odometry: Odometry = at_rest.message().unwrap();
    assert_eq!(odometry.linear, [0.0; 3], "it stands");
    let rolled_on = odometry.position[0] - farthest;
    assert!((0.1..0.3).contains(&rolled_on), "it rolled on for {rolled_on} m");
}

#[test]
fn ctrl_c_ends_it_and_leaves_nothing() {
    let simulator = Simulator::start(&[]);
    let mut subscriber = simulator.subscribe("/image_raw");
    next_frame(&mut subscriber);
    let domain = simulator.domain().to_owned();
    assert!(!files_of(&domain).is_empty());
    drop(subscriber);
    assert!(simulator.interrupt().success());
    assert_eq!(files_of(&domain), Vec::<String>::new());
}

/// SIGKILL during a run, and a new start: the existing subscriber continues without doing anything.
#[test]
fn a_subscriber_outlives_a_killed_simulator() {
    let simulator = Simulator::start(&[]);
    let mut subscriber = simulator.subscribe("/image_raw");
    let first = next_frame(&mut subscriber).header().session;
    let domain = simulator.kill();
    let simulator = Simulator::start_in(domain.clone(), &[]);
    let started = Instant::now();
    loop {
        let frame = next_frame(&mut subscriber);
        if frame.header().session != first {
            assert!(frame.restarted());
            break;
        }
        assert!(started.elapsed() < live::PATIENCE, "the old simulator's frames do not end");
    }
    drop(subscriber);
    assert!(simulator.interrupt().success());
    assert_eq!(files_of(&domain), Vec::<String>::new(), "the killed run's files are gone too");
}

#[test]
fn a_domain_holds_one_simulator() {
    let simulator = Simulator::start(&["--drive", "still"]);
    next_frame(&mut simulator.subscribe("/clock"));
    let second = output(&["run", "--domain", simulator.domain(), "--duration", "1"]);
    let said = String::from_utf8_lossy(&second.stderr);
    assert!(!second.status.success());
    assert!(said.contains("--domain") && said.contains(simulator.domain()), "{said}");
    let other = output(&["run", "--domain", &own_domain(), "--duration", "0.1", "--rate", "max"]);
    assert!(other.status.success(), "{}", String::from_utf8_lossy(&other.stderr));
}

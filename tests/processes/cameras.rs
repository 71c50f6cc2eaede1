//! Cameras of robot files as seen by other processes: the output of `check`, classes, rolling shutters, motion blur,
//! automatic exposure.

use crate::live::control::{done, done_with, named, step};
use crate::live::{Simulator, follow, next_frame, output};
use belvedere_bridge::payload::SimulationCommand;
use belvedere_bridge::{Frame, Operation, SimulationControl, Subscriber};
use glam::DQuat;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A standing robot with sensors on its mast, in its own file.
fn robot(folder: &TempDir, extensions: &str) -> PathBuf {
    let path = folder.path().join("robot.urdf");
    let text = format!(
        "<robot name='robot'>
  <link name='base_link'>
    <inertial><mass value='5'/><inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial>
    <collision><geometry><box size='0.2 0.2 0.1'/></geometry></collision>
    <visual><geometry><box size='0.2 0.2 0.1'/></geometry></visual>
  </link>
  <link name='mast'><visual><geometry><box size='0.02 0.02 0.02'/></geometry></visual></link>
  <joint name='mount' type='fixed'>
    <parent link='base_link'/><child link='mast'/><origin xyz='0 0 0.5'/>
  </joint>
{extensions}
</robot>"
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// A camera on the mast, which publishes under its name.
fn camera(name: &str, sensor: &str, inside: &str) -> String {
    format!(
        "<gazebo reference='mast'><sensor type='camera' name='{name}'>{sensor}<camera>{inside}</camera>
<plugin name='{name}' filename='libgazebo_ros_camera.so'><cameraName>{name}</cameraName></plugin>
</sensor></gazebo>"
    )
}

fn check(path: &Path) -> String {
    let output = output(&["check", path.to_str().unwrap(), "--world", "empty"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn check_reports_the_share_of_a_picture_that_a_lens_maps() {
    let image = "<image><width>200</width><height>200</height></image>";
    let folder = TempDir::new().unwrap();
    // Up to 1 rad from the axis, at 50 pixels a radian: a disc of radius 50 in a square of 200, 19.6 %.
    let disc = "<horizontal_fov>4</horizontal_fov><lens><type>equidistant</type><cutoff_angle>1</cutoff_angle></lens>";
    let sensors = [
        camera("all", "", image),
        camera("bent", "", &format!("{image}<distortion><k1>-0.02</k1></distortion>")),
        camera("disc", "", &format!("{image}{disc}")),
    ];
    let said = check(&robot(&folder, &sensors.concat()));
    let maps: Vec<&str> = said.lines().filter(|line| line.trim_start().starts_with("maps")).collect();
    let [of_disc] = maps[..] else { panic!("{said}") };
    let share: f64 = of_disc.split_whitespace().nth(1).unwrap().parse().unwrap();
    let exact = 100.0 * std::f64::consts::PI * 50.0 * 50.0 / (200.0 * 200.0);
    assert!((share - exact).abs() < 0.3, "{of_disc}: {exact}");
    assert!(of_disc.ends_with(" % of the pixels, the others are black"), "{of_disc}");
}

#[test]
fn labels_of_a_robots_links_are_classes() {
    let folder = TempDir::new().unwrap();
    // Down onto the base, past the mast: the base fills the middle, the ground the rest.
    let looks_down = camera(
        "down",
        "<pose>0 0 -0.05 0 1.5707963 0</pose>",
        "<image><width>64</width><height>64</height></image>",
    );
    let label =
        "<plugin filename='gz-sim-label-system' name='gz::sim::systems::Label'><label>77</label></plugin>";
    let path = robot(&folder, &format!("{looks_down}<gazebo reference='base_link'>{label}</gazebo>"));
    let simulator = Simulator::start(&[
        "--robot",
        path.to_str().unwrap(),
        "--world",
        "empty",
        "--drive",
        "still",
        "--truth",
    ]);
    let frame = next_frame(&mut simulator.subscribe("/down/image_raw/truth/class"));
    let classes: Vec<i32> =
        frame.payload().as_chunks().0.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect();
    let (labelled, others) = classes.iter().partition::<Vec<i32>, _>(|class| **class == 77);
    assert_eq!(classes[32 * 64 + 32], 77);
    // 0.2 m at a distance of 0.4 m, in a picture that is 0.4617 m wide there.
    let side = 64.0 * 0.2 / (2.0 * 0.4 * (0.5 * 1.047_f64).tan());
    assert!((labelled.len() as f64).sqrt() - side < 1.0 && (labelled.len() as f64).sqrt() - side > -1.0);
    assert!(others.iter().all(|class| (0..77).contains(class)), "{others:?}");
}

/// The angular rate of the robot in rad/s.
const TURN_RAD_S: f64 = 2.0;
/// The focal length of its cameras, and the size of their pictures, in pixels.
const FOCAL_PX: f64 = 500.0;
const SIZE: [usize; 2] = [640, 480];
/// Chosen so that the shift from four rows to the next is not a round fraction of a pixel: otherwise rounding to whole
/// pixels would be the same in many rows.
const READOUT_S: f64 = 0.0233;

/// A dark world without gravity, in which a glowing wall ends at the plane y = 0, 10 m ahead.
fn wall(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("wall.world");
    let dark = "0 0 0 1";
    let text = format!(
        "<sdf version='1.6'><world name='wall'><gravity>0 0 0</gravity>
<physics type='ode'><max_step_size>0.005</max_step_size></physics>
<scene><ambient>{dark}</ambient><background>{dark}</background></scene>
<model name='wall'><static>true</static><pose>10.05 -10 0 0 0 0</pose><link name='l'><visual name='v'>
<geometry><box><size>0.1 20 60</size></box></geometry>
<material><ambient>{dark}</ambient><diffuse>{dark}</diffuse><emissive>1 1 1 1</emissive></material>
</visual></link></model></world></sdf>"
    );
    std::fs::write(&path, text).unwrap();
    path
}

/// A grey camera at 30 Hz with the given device.
fn device_camera(name: &str, device: &str) -> String {
    let [width, height] = SIZE;
    let image = format!("<image><width>{width}</width><height>{height}</height><format>L8</format></image>");
    let lens = format!("<lens><intrinsics><fx>{FOCAL_PX}</fx></intrinsics></lens>");
    let inside = format!("{image}{lens}<device>{device}</device>");
    camera(name, "<update_rate>30</update_rate>", &inside)
}

/// A simulator that is paused at time 0 in front of the wall, and waits for the test's streams.
fn before_the_wall(
    folder: &TempDir,
    cameras: &str,
    topics: &[&str],
    truth: bool,
) -> (Simulator, SimulationControl, Vec<Subscriber>) {
    let (robot, world) = (robot(folder, cameras), wall(folder));
    let waited = format!("test={}", topics.len());
    let mut arguments = vec!["--robot", robot.to_str().unwrap(), "--world", world.to_str().unwrap()];
    arguments.extend(["--paused", "--rate", "max", "--drive", "still", "--wait-for", &waited]);
    arguments.extend(truth.then_some("--truth"));
    let simulator = Simulator::start(&arguments);
    let subscribers = follow(simulator.domain(), "test", topics);
    let control = simulator.control();
    (simulator, control, subscribers)
}

/// Turns the robot from −0.35 rad, across the edge of the wall.
fn turn(control: &mut SimulationControl) {
    let half = 0.5 * -0.35_f64;
    let command = SimulationCommand {
        orientation: [0.0, 0.0, half.sin(), half.cos()],
        angular: [0.0, 0.0, TURN_RAD_S],
        ..named(Operation::SetModelState, "robot")
    };
    done_with(control, &command, "");
}

/// The recorded data of a frame.
#[derive(Clone, PartialEq)]
struct Shot {
    stamp_ns: u64,
    yaw: f64,
    pixels: Vec<u8>,
}

impl Shot {
    fn of(frame: &Frame) -> Self {
        let [x, y, z, w] = frame.header().orientation.map(f64::from);
        let yaw = DQuat::from_xyzw(x, y, z, w).normalize().to_euler(glam::EulerRot::ZYX).0;
        Self { stamp_ns: frame.header().stamp_ns, yaw, pixels: frame.payload().to_vec() }
    }
}

/// The frames of this many steps of 5 ms.
fn shots(control: &mut SimulationControl, steps: u64, subscribers: &mut [Subscriber]) -> Vec<Vec<Shot>> {
    let mut shots = vec![Vec::new(); subscribers.len()];
    for _ in 0..steps {
        step(control, 1);
        for (subscriber, shots) in subscribers.iter_mut().zip(&mut shots) {
            shots.extend(std::iter::from_fn(|| subscriber.take().unwrap()).map(|frame| Shot::of(&frame)));
        }
    }
    shots
}

/// The column at which the wall begins in each row, from the light in the row.
fn edges(shot: &Shot) -> Vec<f64> {
    let rows = shot.pixels.chunks_exact(SIZE[0]);
    rows.map(|row| {
        let bright = row[SIZE[0] - 20..].iter().map(|&value| f64::from(value)).sum::<f64>() / 20.0;
        SIZE[0] as f64 - 0.5 - row.iter().map(|&value| f64::from(value)).sum::<f64>() / bright
    })
    .collect()
}

/// The edge in each row by closed form: at the yaw at which the row was read, `before_s` earlier.
fn expected(shot: &Shot, before_s: f64) -> Vec<f64> {
    let (stamped, rows) = (shot.yaw, SIZE[1]);
    let column = |row: usize| {
        let read_s = READOUT_S * (rows - 1 - row) as f64 / (rows - 1) as f64 + before_s;
        0.5 * (SIZE[0] as f64 - 1.0) + FOCAL_PX * (stamped - TURN_RAD_S * read_s).tan()
    };
    (0..rows).map(column).collect()
}

/// The mean of the differences, their slope from the first row to the last, and the largest difference.
fn off(found: &[f64], expected: &[f64]) -> [f64; 3] {
    let count = found.len() as f64;
    let (mut mean, mut slope, mut squares, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
    for (row, (found, expected)) in found.iter().zip(expected).enumerate() {
        let place = row as f64 / (count - 1.0) - 0.5;
        let off = found - expected;
        mean += off / count;
        slope += off * place;
        squares += place * place;
        largest = largest.max(off.abs());
    }
    [mean, slope / squares, largest]
}

#[test]
fn rows_of_a_turning_camera_agree_with_the_closed_form() {
    const EXPOSURE_S: f64 = 0.008;
    let folder = TempDir::new().unwrap();
    // With so many electrons, shot noise is negligible.
    let readout = format!(
        "<readout_time_s>{READOUT_S}</readout_time_s><exposure_time_s>{EXPOSURE_S}</exposure_time_s>\
         <white_radiance_w_m2_sr>100</white_radiance_w_m2_sr><full_well_e>4000000</full_well_e>\
         <dn_per_electron>0.001</dn_per_electron>"
    );
    let cameras = [
        device_camera("rolling", &readout),
        device_camera("blurred", &format!("{readout}<motion_blur_samples>32</motion_blur_samples>")),
    ];
    let topics = ["rolling/image_raw", "blurred/image_raw"];
    let (_simulator, mut control, mut subscribers) =
        before_the_wall(&folder, &cameras.concat(), &topics, false);
    turn(&mut control);
    let first = shots(&mut control, 54, &mut subscribers);
    for (name, shots, before_s, [mean, slope, largest]) in [
        // Edges are sharp, so there are whole pixels, and rows in groups of four.
        ("rolling", &first[0], 0.0, [0.05, 0.1, 0.6]),
        ("blurred", &first[1], 0.5 * EXPOSURE_S, [0.05, 0.1, 0.3]),
    ] {
        // The first frame is at time 0, before which nothing has moved.
        let turning: Vec<_> = shots.iter().filter(|shot| shot.yaw > -0.25 && shot.yaw < 0.2).collect();
        assert!(turning.len() >= 5, "{} of {} frames of {name}", turning.len(), shots.len());
        for pair in turning.windows(2) {
            let rate = (pair[1].yaw - pair[0].yaw) / (pair[1].stamp_ns - pair[0].stamp_ns) as f64 * 1e9;
            assert!((rate - TURN_RAD_S).abs() < 1e-3, "it turns by {rate} rad/s");
        }
        for shot in turning {
            let (found, expected) = (edges(shot), expected(shot, before_s));
            let slanted = expected[479] - expected[0];
            assert!(
                slanted > FOCAL_PX * TURN_RAD_S * READOUT_S,
                "{slanted} px from the first row to the last"
            );
            let off = off(&found, &expected);
            println!("{name} at {:.3} rad: {slanted:.2} px; off by {off:.3?}", shot.yaw);
            assert!(off[0].abs() < mean && off[1].abs() < slope && off[2] < largest, "{name}: {off:?}");
        }
    }
    // After a reset, the bytes are the same.
    done(&mut control, Operation::ResetSimulation);
    turn(&mut control);
    let again = shots(&mut control, 54, &mut subscribers);
    assert!(first == again, "other bytes after a reset");
}

#[test]
fn automatic_exposure_does_not_depend_on_subscribers_and_is_reset() {
    // A hundred times too dark at first. The frames are of the time in which the wall fills the right half.
    let device = "<exposure_time_s>0.00004</exposure_time_s><read_noise_e>3</read_noise_e>\
                  <auto_exposure><target>0.2</target><tolerance>0.03</tolerance></auto_exposure>";
    let folder = TempDir::new().unwrap();
    let cameras = device_camera("eye", device);
    let (_simulator, mut control, mut subscribers) =
        before_the_wall(&folder, &cameras, &["eye/image_raw"], false);
    let watched = shots(&mut control, 80, &mut subscribers).remove(0);
    assert_eq!(watched.len(), 13);
    // As a fraction of the full well: 4000 of 4095 DN are saturated, and the 8-bit picture ends at 255.
    let mean = |shot: &Shot| {
        let sum: f64 = shot.pixels.iter().map(|&value| f64::from(value)).sum();
        sum / shot.pixels.len() as f64 / (255.0 * 4000.0 / 4095.0)
    };
    let means: Vec<_> = watched.iter().map(mean).collect();
    println!("means of the frames: {means:.4?}");
    assert!(means[0] < 0.01, "{means:?}");
    assert!(means[9..].iter().all(|mean| (mean - 0.2).abs() < 0.03 * 0.2 + 0.002), "{means:?}");
    done(&mut control, Operation::ResetSimulation);
    let again = shots(&mut control, 80, &mut subscribers).remove(0);
    assert!(watched == again, "other bytes after a reset");

    // A late subscriber sees the same frames as an early one.
    let (simulator, mut control, _infos) = before_the_wall(&folder, &cameras, &["eye/camera_info"], false);
    step(&mut control, 40);
    let mut late = follow(simulator.domain(), "late", &["eye/image_raw"]);
    let seen = shots(&mut control, 40, &mut late).remove(0);
    assert!(seen.len() >= 5, "{} frames", seen.len());
    assert!(seen.iter().all(|shot| watched.contains(shot)), "a late subscriber gets other bytes");
}

#[test]
fn forward_flow_is_stamped_with_the_frame_that_it_starts_from() {
    let folder = TempDir::new().unwrap();
    let device = format!("<readout_time_s>{READOUT_S}</readout_time_s>");
    let topics = ["eye/image_raw", "eye/image_raw/truth/flow_forward", "eye/image_raw/truth/flow_back"];
    let (_simulator, mut control, mut subscribers) =
        before_the_wall(&folder, &device_camera("eye", &device), &topics, true);
    turn(&mut control);
    let frames = shots(&mut control, 54, &mut subscribers);
    let [pictures, forward, back] = &frames[..] else { unreachable!() };
    // The flow of the last frame is not known yet, and the first frame has no backward flow.
    let stamps = |shots: &[Shot]| shots.iter().map(|shot| shot.stamp_ns).collect::<Vec<_>>();
    assert_eq!(stamps(forward), stamps(&pictures[..pictures.len() - 1]));
    assert_eq!(stamps(back), stamps(&pictures[1..]));
    let (mut seen, mut largest) = (0, 0.0_f64);
    let (middle, row) = (0.5 * (SIZE[0] as f64 - 1.0), SIZE[1] / 2);
    for (pair, forward, back) in (0..forward.len()).map(|at| (&pictures[at..at + 2], &forward[at], &back[at]))
    {
        // The first frame is at time 0, before which nothing has moved, so its rows have other times than those of
        // later frames.
        if pair[0].yaw < -0.3 || pair[1].yaw > 0.3 {
            continue;
        }
        assert_eq!((forward.yaw, back.yaw), (pair[0].yaw, pair[1].yaw));
        let turned = pair[1].yaw - pair[0].yaw;
        for (shot, turned) in [(forward, turned), (back, -turned)] {
            let flow = shot.pixels.as_chunks::<4>().0[2 * row * SIZE[0]..].as_chunks::<2>().0;
            for (column, [x, y]) in flow[..SIZE[0]].iter().enumerate() {
                let [x, y] = [x, y].map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
                if x.is_nan() {
                    continue;
                }
                // Half a pixel off the axis, a point hardly leaves its row.
                let angle = ((column as f64 - middle) / FOCAL_PX).atan();
                let expected = FOCAL_PX * (angle + turned).tan() - (column as f64 - middle);
                seen += 1;
                largest = largest.max((x - expected).abs());
                assert!(y.abs() < 0.1, "column {column}: {y}");
            }
        }
    }
    println!("{seen} flows, at most {largest:.4} px off");
    assert!(seen > 2000 && largest < 0.01, "{seen} flows, at most {largest} px off");
}

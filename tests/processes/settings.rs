//! Settings of sensors that another process changes while they run.

use crate::live::{PATIENCE, Simulator, follow, next_frame, output};
use belvedere_bridge::payload::{SensorSettings, Setting, SimulationCommand};
use belvedere_bridge::{Operation, SimulationControl, StreamSpec, Subscriber, Text};
use xxhash_rust::xxh3::xxh3_128;

const CAMERA: &str = "camera1";
const LIDAR: &str = "laser";
const PAUSED: [&str; 6] = ["--paused", "--rate", "max", "--seed", "5", "--drive"];

/// The time at which the command was done, or the reason of its refusal.
fn call(control: &mut SimulationControl, command: &SimulationCommand, text: &str) -> Result<u64, String> {
    let result = control.call(command, text, PATIENCE).unwrap().expect("the simulator answers");
    if result.done == 1 { Ok(result.time_ns) } else { Err(result.reason.as_str().to_owned()) }
}

fn configure(control: &mut SimulationControl, sensor: &str, text: &str) -> Result<u64, String> {
    let name = Text::new(sensor).unwrap();
    call(control, &SimulationCommand { name, ..SimulationCommand::new(Operation::Configure) }, text)
}

/// Runs this many hundredths of a second: two steps each in this world.
fn step(control: &mut SimulationControl, hundredths: u64) -> u64 {
    let steps = 2 * hundredths;
    call(control, &SimulationCommand { steps, ..SimulationCommand::new(Operation::Step) }, "").unwrap()
}

fn reset(control: &mut SimulationControl) {
    call(control, &SimulationCommand::new(Operation::ResetSimulation), "").unwrap();
}

/// A simulator that is paused at time 0 and waits for the test's streams; and subscribers of these topics.
fn start(topics: &[&str]) -> (Simulator, SimulationControl, Vec<Subscriber>) {
    let waited = format!("test={}", topics.len());
    let simulator = Simulator::start(&[&PAUSED[..], &["still", "--wait-for", &waited]].concat());
    let subscribers = follow(simulator.domain(), "test", topics);
    let control = simulator.control();
    (simulator, control, subscribers)
}

/// The frames that have arrived: timestamp and hash of the payload.
fn taken(subscriber: &mut Subscriber) -> Vec<(u64, u128)> {
    std::iter::from_fn(|| subscriber.take().unwrap())
        .map(|frame| (frame.header().stamp_ns, xxh3_128(frame.payload())))
        .collect()
}

fn stamps_ms(subscriber: &mut Subscriber) -> Vec<f64> {
    taken(subscriber).iter().map(|(stamp_ns, _)| (*stamp_ns as f64 / 1e4).round() / 100.0).collect()
}

/// All frames of this many hundredths of a second, taken one by one, because the simulator waits for full buffers.
fn run(
    control: &mut SimulationControl,
    hundredths: u64,
    subscribers: &mut [Subscriber],
) -> Vec<Vec<(u64, u128)>> {
    let mut frames = vec![Vec::new(); subscribers.len()];
    for _ in 0..hundredths {
        step(control, 1);
        for (subscriber, frames) in subscribers.iter_mut().zip(&mut frames) {
            frames.extend(taken(subscriber));
        }
    }
    frames
}

fn newest(subscriber: &mut Subscriber) -> Vec<SensorSettings> {
    let mut frame = next_frame(subscriber);
    while let Some(newer) = subscriber.take().unwrap() {
        frame = newer;
    }
    frame.view().structs().unwrap().collect()
}

fn of<'a>(sensors: &'a [SensorSettings], name: &str) -> &'a SensorSettings {
    sensors.iter().find(|sensor| sensor.name.as_str() == name).expect("the sensor is listed")
}

#[test]
fn settings_are_published_at_the_start_after_changes_and_to_late_subscribers() {
    let (simulator, mut control, mut subscribers) = start(&["simulation/sensor_settings"]);
    let told = newest(&mut subscribers[0]);
    assert_eq!(told.len(), 2);
    let (camera, lidar) = (of(&told, CAMERA), of(&told, LIDAR));
    assert_eq!(camera.topics().collect::<Vec<_>>(), ["image_raw", "camera_info"]);
    assert_eq!(lidar.topics().collect::<Vec<_>>(), ["scan"]);
    assert_eq!(camera.update_rate, Setting { value: 30.0, min: 0.01, max: 1000.0 });
    assert_eq!(camera.noise_stddev, Setting { value: 0.007, min: 0.0, max: 1.0 });
    assert_eq!(camera.exposure, Setting { value: 1.0, min: 0.01, max: 100.0 });
    assert_eq!(lidar.noise_mean, Setting { value: 0.0, min: -6.0, max: 6.0 });
    assert_eq!((lidar.update_rate.value, lidar.noise_stddev.value), (5.5, 0.01));
    assert!(
        [lidar.exposure.value, lidar.exposure.min, lidar.exposure.max].iter().all(|value| value.is_nan())
    );

    step(&mut control, 7);
    let done_ns = configure(&mut control, "/scan", "update_rate=8 noise_mean=0.5").unwrap();
    let changed = next_frame(&mut subscribers[0]);
    assert_eq!(changed.header().stamp_ns, done_ns);
    drop(changed);
    // A subscriber that comes later, while the simulation is paused.
    let late = newest(&mut simulator.subscribe(StreamSpec::SENSOR_SETTINGS));
    let lidar = of(&late, LIDAR);
    assert_eq!((lidar.update_rate.value, lidar.noise_mean.value, lidar.noise_stddev.value), (8.0, 0.5, 0.01));
    assert_eq!(of(&late, CAMERA), camera);
    reset(&mut control);
    assert_eq!(of(&newest(&mut subscribers[0]), LIDAR).update_rate.value, 5.5);
}

#[test]
fn a_new_rate_continues_from_the_last_frame_with_exact_stamps() {
    let (_simulator, mut control, mut subscribers) = start(&["scan", "camera_info"]);
    let [scan, infos] = &mut subscribers[..] else { unreachable!() };
    assert_eq!(step(&mut control, 40), 400_000_000);
    assert_eq!(stamps_ms(scan), [0.0, 181.82, 363.64]);
    assert_eq!(stamps_ms(infos).len(), 13);
    // 50 ms after the last one, and so on.
    configure(&mut control, LIDAR, "update_rate=20").unwrap();
    step(&mut control, 20);
    assert_eq!(stamps_ms(scan), [413.64, 463.64, 513.64, 563.64]);
    // Setting the current value changes nothing.
    configure(&mut control, LIDAR, "update_rate=20 noise_stddev=0").unwrap();
    step(&mut control, 5);
    assert_eq!(stamps_ms(scan), [613.64]);
    // Slower, and then changed again before the next frame is due.
    configure(&mut control, LIDAR, "update_rate=2").unwrap();
    step(&mut control, 10);
    configure(&mut control, LIDAR, "update_rate=30").unwrap();
    step(&mut control, 10);
    // It would have been due at 646.97, so it comes now, at 750.
    assert_eq!(stamps_ms(scan), [750.0, 783.33, 816.67, 850.0]);
    // All streams of the other sensor kept theirs.
    assert_eq!(stamps_ms(infos).last(), Some(&833.33));
    configure(&mut control, "camera_info", "update_rate=10").unwrap();
    step(&mut control, 25);
    assert_eq!(stamps_ms(infos), [933.33, 1033.33]);
}

#[test]
fn noise_and_exposure_change_with_the_next_frame_and_are_reset() {
    let (_simulator, mut control, mut subscribers) = start(&["image_raw", "scan", "camera_info"]);
    let fresh = run(&mut control, 40, &mut subscribers);
    assert!(fresh[0].len() == 13 && fresh[1].len() == 3, "{fresh:?}");

    let mut changed = || {
        reset(&mut control);
        let before = run(&mut control, 20, &mut subscribers);
        configure(&mut control, CAMERA, "exposure=2.5 noise_stddev=0.1 update_rate=12").unwrap();
        configure(&mut control, LIDAR, "noise_stddev=0.2").unwrap();
        (before, run(&mut control, 40, &mut subscribers))
    };
    let (before, after) = changed();
    assert!(
        before.iter().zip(&fresh).all(|(before, fresh)| fresh.starts_with(before)),
        "until then the same"
    );
    assert!(after[0].iter().all(|frame| !fresh[0].contains(frame)));
    assert!(after[1].iter().all(|frame| !fresh[1].contains(frame)));
    // The same commands at the same times give the same bytes.
    assert_eq!(changed(), (before, after));
    reset(&mut control);
    assert_eq!(run(&mut control, 40, &mut subscribers), fresh);
}

#[test]
fn colours_are_proportional_to_exposure_until_they_saturate() {
    let (_simulator, mut control, mut subscribers) = start(&["image_raw"]);
    let mut picture = |exposure: &str| {
        reset(&mut control);
        configure(&mut control, CAMERA, &format!("noise_stddev=0 exposure={exposure}")).unwrap();
        step(&mut control, 1);
        next_frame(&mut subscribers[0]).payload().to_vec()
    };
    let described = picture("1");
    for (exposure, factor) in [("0.5", 0.5), ("2", 2.0), ("100", 100.0)] {
        let exposed = picture(exposure);
        for (index, (&found, &byte)) in exposed.iter().zip(&described).enumerate() {
            // The byte represents an interval of half a step to either side.
            let least = ((f64::from(byte) - 0.5) * factor - 0.51).clamp(0.0, 255.0);
            let most = ((f64::from(byte) + 0.5) * factor + 0.51).clamp(0.0, 255.0);
            let value = f64::from(found);
            assert!(
                (least - 0.01..=most + 0.01).contains(&value),
                "{exposure}: byte {index}: {byte}, {found}"
            );
        }
    }
    assert_eq!(picture("1"), described);
}

#[test]
fn invalid_settings_are_refused_with_a_reason_and_change_nothing() {
    let (simulator, mut control, mut subscribers) = start(&["simulation/sensor_settings"]);
    let told = newest(&mut subscribers[0]);
    for (sensor, text, says) in [
        (
            "lazer",
            "update_rate=5",
            "there is no sensor 'lazer', and no sensor with such a topic; did you mean 'laser'? there are: ",
        ),
        ("scan", "exposure=2", "this sensor has no exposure; it has update_rate (0.01 to 1000)"),
        ("scan", "update_rate=8 noise_stddev=7", "noise_stddev is '7'; it must be a number from 0 to 6"),
        ("image_raw", "gain=2", "gain is not a setting; "),
        ("image_raw", "exposure=1e9", "exposure is '1e9'; it must be a number from 0.01 to 100"),
        ("image_raw", "", "no setting is given; write NAME=VALUE for one of "),
    ] {
        let reason = configure(&mut control, sensor, text).unwrap_err();
        assert!(reason.starts_with(says), "{sensor} {text}: {reason}");
    }
    // Nothing was sent, because nothing has changed.
    assert!(subscribers[0].take().unwrap().is_none());
    let late = newest(&mut simulator.subscribe(StreamSpec::SENSOR_SETTINGS));
    assert_eq!(of(&late, CAMERA), of(&told, CAMERA));
    assert_eq!(of(&late, LIDAR).update_rate, of(&told, LIDAR).update_rate);
}

#[test]
fn the_command_line_changes_and_lists_settings() {
    let (simulator, _control, mut subscribers) = start(&["simulation/sensor_settings"]);
    newest(&mut subscribers[0]);
    let run = |arguments: &[&str]| {
        let output = output(&[arguments, &["--domain", simulator.domain()]].concat());
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, listed, _) = run(&["control", "settings"]);
    assert_eq!(code, Some(0));
    assert!(listed.contains("laser    noise_stddev       0.01          0          6\n"), "{listed}");
    assert!(!listed.contains("laser    exposure") && listed.contains("camera1  exposure"), "{listed}");
    let (code, said, _) = run(&["control", "configure", "scan", "update_rate=8", "noise_mean=-0.25"]);
    assert_eq!((code, said.starts_with("configure: done at ")), (Some(0), true), "{said}");
    let (_, json, _) = run(&["control", "settings", "--json"]);
    let sensors: Vec<serde_json::Value> =
        json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let lidar = sensors.iter().find(|sensor| sensor["name"] == "laser").unwrap();
    assert_eq!(
        (&lidar["update_rate"]["value"], &lidar["noise_mean"]["value"]),
        (&8.0.into(), &(-0.25).into())
    );
    let (_, list, _) = run(&["list"]);
    let line = list.lines().find(|line| line.starts_with("/scan ")).unwrap();
    assert!(line.contains(" 8 Hz "), "{line}");
    let (_, echoed, _) = run(&["echo", "simulation/sensor_settings", "--count", "1"]);
    assert!(
        echoed.contains("- name: \"laser\"\n  topics: [\"scan\"]\n  update_rate:\n    value: 8.0\n"),
        "{echoed}"
    );
    let (code, _, error) = run(&["control", "configure", "scan", "update_rate=fast"]);
    assert_eq!(code, Some(1));
    assert!(error.contains("update_rate is 'fast'; it must be a number from 0.01 to 1000"), "{error}");
}

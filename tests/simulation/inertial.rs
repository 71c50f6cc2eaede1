//! Inertial units in the simulator: their readings for known motions, and the effect of the files' parameters.

use belvedere::description::load;
use belvedere::description::model::{Model, SensorKind};
use belvedere::entities::EntityId;
use belvedere::rig::FrameBuf;
use belvedere::simulation::{Simulation, SpawnOptions};
use belvedere_bridge::payload::Imu;
use belvedere_sensors::Pose;
use belvedere_sensors::imu::presets;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::time::Duration;

const GRAVITY: f64 = 9.8;

/// A box of 1 kg with this content in its link, or beside it.
fn carrier(in_link: &str, beside: &str) -> Model {
    load::model(&format!(
        "<sdf version='1.6'><model name='box'><link name='body'>
           <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
           <collision name='c'><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision>{in_link}</link>{beside}
         </model></sdf>"
    ))
    .unwrap()
}

fn sensor(pose: &str, rate: u32, inside: &str) -> String {
    format!(
        "<sensor name='imu' type='imu'><pose>{pose}</pose><update_rate>{rate}</update_rate><topic>imu</topic>
           <imu>{inside}</imu></sensor>"
    )
}

struct Bench {
    simulation: Simulation,
    carrier: EntityId,
}

impl Bench {
    fn new(model: &Model, at: Pose) -> Self {
        let mut simulation = Simulation::builder(load::world("empty").unwrap()).seed(4).build().unwrap();
        let options = SpawnOptions { world_from_model: at, ..SpawnOptions::default() };
        let carrier = simulation.spawn(model, options).unwrap();
        Self { simulation, carrier }
    }

    fn read(&mut self, topic: &str) -> (Imu, FrameBuf) {
        let mut frame = FrameBuf::default();
        self.simulation.render(topic, &mut frame).unwrap();
        (bytemuck::pod_read_unaligned(frame.payload()), frame)
    }

    /// The mean since the previous reading, after this many ms.
    fn after(&mut self, milliseconds: u64) -> Imu {
        self.simulation.run_for(Duration::from_millis(milliseconds));
        self.read("imu").0
    }
}

fn near(read: [f64; 3], expected: DVec3, within: f64) {
    assert!((DVec3::from(read) - expected).length() < within, "{read:?}, not {expected}");
}

#[test]
fn at_rest_it_measures_the_floors_force_in_its_own_axes() {
    let floor = Pose::from_translation(DVec3::Z * 0.1);
    let mut upright = Bench::new(&carrier(&sensor("0.1 0 0 0 0 0", 100, ""), ""), floor);
    upright.after(500);
    let rest = upright.after(500);
    near(rest.linear_acceleration, DVec3::Z * GRAVITY, 1e-3);
    near(rest.angular_velocity, DVec3::ZERO, 1e-4);
    // Rolled by a quarter turn, so that its y points up.
    let mut rolled = Bench::new(&carrier(&sensor(&format!("0 0 0 {FRAC_PI_2} 0 0"), 100, ""), ""), floor);
    rolled.after(500);
    near(rolled.after(500).linear_acceleration, DVec3::Y * GRAVITY, 1e-3);
    // Without noise, its covariance is zero.
    assert_eq!(rest.angular_velocity_covariance, [0.0; 9]);
}

#[test]
fn in_free_fall_it_measures_nothing() {
    let at = Pose::from_xyz_rpy(DVec3::Z * 60.0, DVec3::new(0.3, -0.5, 1.0));
    let mut bench = Bench::new(&carrier(&sensor("0.1 0.2 0.3 1 2 3", 100, ""), ""), at);
    bench.after(100);
    near(bench.after(2000).linear_acceleration, DVec3::ZERO, 1e-3);
}

#[test]
fn off_the_axis_it_measures_the_centripetal_force() {
    let planar = "<plugin name='p' filename='libgazebo_ros_planar_move.so'/>";
    let model = carrier(&sensor("0.5 0 0 0 0 0.3", 200, ""), planar);
    let mut bench = Bench::new(&model, Pose::from_translation(DVec3::Z * 0.1));
    let turn = belvedere::robot::Command::new(0.0, 1.5);
    for _ in 0..10 {
        bench.simulation.command(bench.carrier, turn).unwrap();
        bench.after(50);
    }
    let read = bench.after(5);
    near(read.angular_velocity, DVec3::Z * 1.5, 1e-3);
    // ω²r towards the axis, in axes that are rotated by 0.3 rad.
    let towards = DQuat::from_rotation_z(-0.3) * DVec3::NEG_X;
    near(read.linear_acceleration, towards * (1.5 * 1.5 * 0.5) + DVec3::Z * GRAVITY, 0.02);
}

#[test]
fn orientations_are_relative_to_the_frame_of_the_file() {
    let tilted = DVec3::new(0.0, 0.0, 1.0);
    let at = Pose::from_xyz_rpy(DVec3::Z * 0.1, tilted);
    let turned = |yaw: f64| DQuat::from_rotation_z(yaw);
    let frame = |text: &str| format!("<orientation_reference_frame>{text}</orientation_reference_frame>");
    let localization = |name: &str| frame(&format!("<localization>{name}</localization>"));
    // For a unit whose x is 1 rad to the left of the world's, which is east.
    let north_west_up = turned(1.0 - FRAC_PI_2);
    let half =
        DQuat::from_array([std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0]);
    for (inside, expected) in [
        (String::new(), DQuat::IDENTITY),
        (localization("ENU"), turned(1.0)),
        (localization("NWU"), north_west_up),
        // Half a turn about the axis between north and east swaps the two, and turns up to down.
        (localization("NED"), half * turned(1.0)),
        (frame("<custom_rpy parent_frame='world'>0 0 0.25</custom_rpy>"), turned(0.75)),
        (frame("<custom_rpy>0 0 0.25</custom_rpy>"), turned(-0.25)),
    ] {
        let mut bench = Bench::new(&carrier(&sensor("0 0 0 0 0 0", 100, &inside), ""), at);
        // Relative to the start, not to the first reading.
        let first = bench.read("imu").0;
        let pose = Pose::from_xyz_rpy(DVec3::new(2.0, 0.0, 0.1), tilted);
        bench.simulation.place(bench.carrier, &pose, DVec3::ZERO, DVec3::ZERO).unwrap();
        let moved = bench.after(100);
        near(moved.linear_acceleration, DVec3::Z * GRAVITY, 0.01);
        for read in [first, moved] {
            let alike = DQuat::from_array(read.orientation).dot(expected).abs();
            assert!(alike > 1.0 - 1e-6, "{inside}: {:?}, not {expected}", read.orientation);
        }
    }
    let none = sensor("0 0 0 0 0 0", 100, "<enable_orientation>false</enable_orientation>");
    let read = Bench::new(&carrier(&none, ""), at).after(100);
    assert_eq!((read.orientation, read.orientation_covariance[0]), ([0.0, 0.0, 0.0, 1.0], -1.0));
}

#[test]
fn noise_follows_the_file_axis_by_axis() {
    let noise = |inside: &str| format!("<noise type='gaussian'>{inside}</noise>");
    let inside = format!(
        "<angular_velocity><x>{}</x><z>{}</z></angular_velocity>
         <linear_acceleration><y>{}</y></linear_acceleration>",
        noise("<mean>0.5</mean><stddev>0.02</stddev>"),
        noise("<bias_mean>2</bias_mean><bias_stddev>0.001</bias_stddev>"),
        noise(
            "<dynamic_bias_stddev>0.1</dynamic_bias_stddev><dynamic_bias_correlation_time>40</dynamic_bias_correlation_time>"
        ),
    );
    let model = carrier(&sensor("0 0 0 0 0 0", 1000, &inside), "<static>true</static>");
    let mut bench = Bench::new(&model, Pose::from_translation(DVec3::Z * 0.1));
    bench.after(500);
    let reads: Vec<Imu> = (0..2000).map(|_| bench.after(10)).collect();
    let of = |value: fn(&Imu) -> f64| {
        let mean = reads.iter().map(value).sum::<f64>() / 2000.0;
        let variance = reads.iter().map(|read| (value(read) - mean).powi(2)).sum::<f64>() / 2000.0;
        (mean, variance.sqrt())
    };
    let (mean, stddev) = of(|read| read.angular_velocity[0]);
    assert!((mean - 0.5).abs() < 0.002 && (stddev - 0.02).abs() < 0.001, "{mean} {stddev}");
    let (mean, stddev) = of(|read| read.angular_velocity[2]);
    assert!((mean.abs() - 2.0).abs() < 0.005 && stddev < 1e-5, "{mean} {stddev}");
    assert!(of(|read| read.angular_velocity[1]).1 < 1e-5);
    // A walk of 0.1 m/s² in a second, whose steps have this deviation.
    let steps: Vec<f64> =
        reads.windows(2).map(|two| two[1].linear_acceleration[1] - two[0].linear_acceleration[1]).collect();
    let step = (steps.iter().map(|step| step * step).sum::<f64>() / steps.len() as f64).sqrt();
    assert!((step / (0.1 * 0.01_f64.sqrt()) - 1.0).abs() < 0.06, "{step}");
    let last = reads.last().unwrap();
    assert!(
        (last.angular_velocity_covariance[0] - 4e-4).abs() < 1e-12
            && last.angular_velocity_covariance[4] == 0.0
    );

    // The same bytes after a reset.
    let again = |bench: &mut Bench| {
        bench.simulation.reset().unwrap();
        (0..50).map(|_| bench.after(10)).map(|read| bytemuck::bytes_of(&read).to_vec()).collect::<Vec<_>>()
    };
    assert_eq!(again(&mut bench), again(&mut bench));
}

/// As in descriptions of real robots: names, frames, rates and figures of the plugins.
#[test]
fn plugins_have_their_own_names_and_defaults() {
    let in_sensor = |parameters: &str| {
        format!(
            "<sensor name='imu_sensor' type='imu'><always_on>true</always_on><update_rate>100</update_rate>
               <plugin name='imu_plugin' filename='libgazebo_ros_imu_sensor.so'>{parameters}</plugin></sensor>"
        )
    };
    let ros1 = "<topicName>imu</topicName><bodyName>body</bodyName><updateRateHZ>10.0</updateRateHZ>
                <gaussianNoise>0.01</gaussianNoise><xyzOffset>0 0 0</xyzOffset><rpyOffset>0 0 0</rpyOffset>
                <frameName>imu_link</frameName>";
    let ros2 = "<ros><namespace>/demo</namespace><remapping>~/out:=imu</remapping></ros>";
    let hector = "<plugin name='imu_controller' filename='libhector_gazebo_ros_imu.so'><robotNamespace>/</robotNamespace>
        <updateRate>50.0</updateRate><bodyName>body</bodyName><topicName>imu/data</topicName>
        <accelDrift>0.005 0.005 0.005</accelDrift><accelGaussianNoise>0.005 0.005 0.005</accelGaussianNoise>
        <rateDrift>0.005 0.005 0.005</rateDrift><rateGaussianNoise>0.005 0.005 0.005</rateGaussianNoise>
        <yawDrift>0.005</yawDrift><yawGaussianNoise>0.005</yawGaussianNoise></plugin>";
    let rotors = "<plugin name='rotors' filename='librotors_gazebo_imu_plugin.so'><robotNamespace>firefly</robotNamespace>
        <linkName>body</linkName><imuTopic>imu</imuTopic><gyroscopeNoiseDensity>0.0004</gyroscopeNoiseDensity></plugin>";
    for (in_link, beside, topic, frame_id, rate_hz) in [
        (in_sensor(ros1), "", "/box/imu", "imu_link", 10.0),
        (in_sensor("<frameName>f</frameName>"), "", "/box/imu_data", "f", 1.0),
        (
            in_sensor("<robotNamespace>ns</robotNamespace><frameName>f</frameName>"),
            "",
            "/ns/imu_data",
            "f",
            1.0,
        ),
        (in_sensor(ros2), "", "/demo/imu", "body", 100.0),
        (in_sensor("<frame_name>f</frame_name>"), "", "/imu_plugin/out", "f", 100.0),
        (String::new(), hector, "/imu/data", "body", 50.0),
        (String::new(), rotors, "/firefly/imu", "body", 1000.0),
    ] {
        let model = carrier(&in_link, beside);
        let rate = model.sensors[0].effective_rate_hz().unwrap_or(1000.0);
        assert!((rate - rate_hz).abs() < 1e-9, "{topic}: {rate}");
        let mut bench = Bench::new(&model, Pose::from_translation(DVec3::Z * 0.1));
        bench.simulation.run_for(Duration::from_millis(300));
        let (read, frame) = bench.read(topic);
        assert_eq!(frame.header().frame_id.as_str(), frame_id, "{topic}");
        assert!((DVec3::from(read.linear_acceleration) - DVec3::Z * GRAVITY).length() < 1.0, "{read:?}");
        assert!(DQuat::from_array(read.orientation).dot(DQuat::IDENTITY).abs() > 0.99);
    }
    // With a namespace, that replaces the name of the model.
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let options = SpawnOptions { namespace: "anna".into(), ..SpawnOptions::default() };
    simulation.spawn(&carrier(&in_sensor(ros1), ""), options).unwrap();
    assert!(simulation.topics().unwrap().iter().any(|topic| topic == "/anna/imu"));

    let unit = |model: &Model| match &model.sensors[0].kind {
        SensorKind::Imu(unit) => unit.clone(),
        other => panic!("{other:?}"),
    };
    let read = unit(&carrier("", hector));
    assert_eq!((read.config.gyro.stddev, read.heading.stddev), ([0.005; 3], [0.005]));
    // Its correlation frequency is 1/3600 Hz, and its variance tends to 0.005²: q²τ/2.
    let (drift, time_s) = (read.config.accelerometer.drift[0], read.config.accelerometer.drift_time_s[0]);
    assert!((time_s - 3600.0).abs() < 1e-6 && (drift * drift * time_s / 2.0 - 0.005 * 0.005).abs() < 1e-12);
    let read = unit(&carrier("", rotors));
    assert_eq!(
        (read.config.gyro.density, read.config.gyro.drift),
        ([4e-4; 3], presets::adis16448().gyro.drift)
    );
}

#[test]
fn our_plugin_gives_figures_that_sdf_lacks() {
    let unit = |inside: &str| {
        let text = format!(
            "<sensor name='u' type='imu'><topic>imu</topic><plugin name='b' filename='belvedere'>{inside}</plugin></sensor>"
        );
        load::model(&format!(
            "<sdf version='1.6'><model name='m'><link name='l'>\n{text}</link></model></sdf>"
        ))
    };
    let config = |inside: &str| match &unit(inside).unwrap().sensors[0].kind {
        SensorKind::Imu(unit) => unit.config,
        other => panic!("{other:?}"),
    };
    assert_eq!(config("<preset>adis16448</preset>"), presets::adis16448());
    let read = config(
        "<preset>adis16448</preset><gyroscope_noise_density>0.001</gyroscope_noise_density>
         <accelerometer_scale_error>0.01 0 -0.01</accelerometer_scale_error>
         <accelerometer_misalignment>0.001 0.002 0.003 0.004 0.005 0.006</accelerometer_misalignment>",
    );
    assert_eq!((read.gyro.density, read.gyro.drift), ([0.001; 3], presets::adis16448().gyro.drift));
    assert_eq!(
        read.accelerometer.sensitivity,
        [[1.01, 0.001, 0.002], [0.003, 1.0, 0.004], [0.005, 0.006, 0.99]]
    );
    for (inside, expected) in [
        (
            "<preset>adis16449</preset>",
            "<preset> of sensor 'u' is 'adis16449', which does not exist; did you mean 'adis16448'?",
        ),
        (
            "<gyroscope_noise_density>-1</gyroscope_noise_density>",
            "<gyroscope_noise_density> of sensor 'u' is -1; write 0",
        ),
        (
            "<gyroscope_random_walk>1 2</gyroscope_random_walk>",
            "<gyroscope_random_walk> of sensor 'u' is '1 2': too few",
        ),
    ] {
        let errors = unit(inside).unwrap_err().to_string();
        assert!(errors.contains(expected) && errors.contains(":2: "), "{errors}");
    }
}

/// A unit on a model of the world reports too; if it is moved by a command, it measures no acceleration.
#[test]
fn a_unit_of_the_world_reports_too() {
    let model = carrier(&sensor("0 0 0 0 0 0", 100, ""), "<static>true</static><pose>1 2 3 0 0 0</pose>");
    let mut world = load::world("empty").unwrap();
    world.models.push(Model { is_static: true, ..model });
    let mut simulation = Simulation::builder(world).build().unwrap();
    simulation.run_for(Duration::from_millis(100));
    let mut frame = FrameBuf::default();
    simulation.render("imu", &mut frame).unwrap();
    let read: Imu = bytemuck::pod_read_unaligned(frame.payload());
    near(read.linear_acceleration, DVec3::Z * GRAVITY, 1e-6);
    let other = simulation.find("box").unwrap();
    let far = Pose::from_xyz_rpy(DVec3::X * 50.0, DVec3::new(0.0, 0.0, PI));
    simulation.place(other, &far, DVec3::ZERO, DVec3::ZERO).unwrap();
    simulation.run_for(Duration::from_millis(10));
    simulation.render("imu", &mut frame).unwrap();
    let read: Imu = bytemuck::pod_read_unaligned(frame.payload());
    near(read.linear_acceleration, DVec3::Z * GRAVITY, 1e-6);
}

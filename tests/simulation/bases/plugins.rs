//! The messages of bases and their plugins, and the errors for invalid ones.

use super::*;

/// gz-sim's plugins have other parameters, and topics under the name of the model.
#[test]
fn gz_sims_bases_have_its_names() {
    let size = SIZES[1];
    let plugin = format!(
        "<plugin name='gz::sim::systems::DiffDrive' filename='gz-sim-diff-drive-system'><left_joint>l_joint</left_joint>
           <right_joint>r_joint</right_joint><wheel_separation>{}</wheel_separation><wheel_radius>{}</wheel_radius></plugin>",
        size.separation_m, size.radius_m
    );
    let mut bench = Bench::new(&two_wheels(size, ["l", "r"], &plugin));
    let apart_m = circle(&mut bench, 0.3, 0.5);
    assert!(apart_m < 0.02, "{apart_m}");
    let (_, frame) = bench.newest::<Odometry>("/model/bot/odometry");
    assert_eq!(frame.header().frame_id.as_str(), "bot/odom");
    let plugin = format!(
        "<plugin name='gz::sim::systems::AckermannSteering' filename='libignition-gazebo-ackermann-steering-system.so'>
           <left_joint>front_left_joint</left_joint><left_joint>rear_left_joint</left_joint>
           <right_joint>front_right_joint</right_joint><right_joint>rear_right_joint</right_joint>
           <left_steering_joint>left_steering_joint</left_steering_joint>
           <right_steering_joint>right_steering_joint</right_steering_joint>
           <wheel_base>{}</wheel_base><wheel_radius>{}</wheel_radius><steer_p_gain>10</steer_p_gain></plugin>",
        size.length_m, size.radius_m
    );
    let mut bench = Bench::new(&car(size, &plugin));
    bench.drive(Command::new(0.5, 0.25), 3.0);
    let told = bench.odometry("/model/bot/odometry");
    assert!((told.angular[2] - 0.25).abs() < 0.005 && (told.linear[0] - 0.5).abs() < 0.01, "{told:?}");
}

/// The base of TurtleBot 1 drives by its own plugin, and has no features that only a Kobuki has.
#[test]
fn a_create_has_no_features_of_a_kobuki() {
    let create = load::robot("create_circles_kinect").unwrap();
    let mut bench = Bench::new(&create);
    let topics: Vec<String> = bench.simulation.topics().unwrap();
    assert!(!topics.iter().any(|topic| topic.contains("mobile_base")), "{topics:?}");
    // Every listed topic can be rendered; flow since the previous frame only from the second frame on.
    for topic in topics.iter().chain(&topics) {
        if topic.ends_with("/flow_back") {
            let _ = bench.simulation.render(topic, &mut FrameBuf::default());
            bench.simulation.step();
        }
        bench.simulation.render(topic, &mut FrameBuf::default()).unwrap();
    }
    bench.drive(Command::new(0.2, 0.0), 0.5);
    assert!((bench.odometry("odom").linear[0] - 0.2).abs() < 0.005);
    // Its driver stops when commands stop.
    bench.simulation.run_for(Duration::from_secs(1));
    assert!(bench.odometry("odom").linear[0].abs() < 0.005);
}

#[test]
fn plugins_report_true_values() {
    let size = SIZES[1];
    let plugins = format!(
        "<plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>l_joint</leftJoint><rightJoint>r_joint</rightJoint>
           {}</plugin>
         <plugin name='i' filename='libgazebo_ros_imu.so'><bodyName>chassis</bodyName><topicName>imu</topicName>
           <updateRate>100</updateRate></plugin>
         <plugin name='p' filename='libgazebo_ros_p3d.so'><bodyName>chassis</bodyName><topicName>/truth</topicName>
           <frameName>world</frameName><updateRate>50</updateRate></plugin>
         <plugin name='j' filename='libgazebo_ros_joint_state_publisher.so'><jointName>r_joint</jointName></plugin>",
        wheels_of(size)
    );
    let mut bench = Bench::new(&two_wheels(size, ["l", "r"], &plugins));
    let (imu, frame) = bench.newest::<Imu>("imu");
    assert_eq!(frame.header().frame_id.as_str(), "chassis");
    assert!((DVec3::from(imu.linear_acceleration) - DVec3::Z * 9.8).length() < 0.02, "{imu:?}");
    bench.drive(Command::new(0.5, 1.0), 3.0);
    // The same sum twice: the first frame starts the interval of the second.
    let mut sums = DVec3::ZERO;
    for _ in 0..50 {
        bench.drive(Command::new(0.5, 1.0), 0.01);
        sums += DVec3::from(bench.newest::<Imu>("imu").0.linear_acceleration) / 50.0;
    }
    // Towards the middle of the circle: v²/r to the left.
    assert!((sums - DVec3::new(0.0, 0.5, 9.8)).length() < 0.05, "{sums}");
    let pose = bench.simulation.pose(bench.robot).unwrap();
    let truth = bench.odometry("/truth");
    assert!((DVec3::from(truth.position) - pose.transform_point(DVec3::Z * size.radius_m)).length() < 1e-6);
    assert!((DVec3::from(truth.linear).length() - 0.5).abs() < 0.01 && (truth.angular[2] - 1.0).abs() < 0.02);
    let (own, frame) = bench.newest::<Pose>("truth/pose");
    assert_eq!(frame.header().frame_id.as_str(), "world");
    assert_eq!(DVec3::from(own.position), pose.translation());
    assert_eq!(own.orientation, pose.rotation().to_array());
    // A plugin with the same topic keeps it.
    let same = plugins.replace("<topicName>/truth<", "<topicName>truth/pose<");
    assert_eq!(
        Bench::new(&two_wheels(size, ["l", "r"], &same)).odometry("truth/pose").child_frame_id.as_str(),
        "chassis"
    );
    let (state, _) = bench.newest::<JointState>("joint_states");
    assert_eq!(state.name.as_str(), "r_joint");
    // If it is moved by a command, it measures no acceleration.
    let away = belvedere_sensors::Pose::from_translation(DVec3::new(40.0, 0.0, 0.0)) * pose;
    bench.simulation.place(bench.robot, &away, DVec3::ZERO, DVec3::ZERO).unwrap();
    let felt = DVec3::from(bench.newest::<Imu>("imu").0.linear_acceleration);
    assert!((felt - DVec3::Z * 9.8).length() < 2.0, "{felt}");
}

/// Missing wheels of a base are reported with their line and a suggestion; a robot without a plugin has no base.
#[test]
fn a_base_without_its_wheels_is_one_error() {
    let robot = |plugin: &str| {
        let inside = format!(
            "{}{}<gazebo>\n{plugin}</gazebo>",
            chassis(SMALL),
            wheel("wheel_left", "chassis", [0.0, 0.1, 0.0], SMALL)
        );
        load::model(&format!("<robot name='bot'>{inside}</robot>"))
    };
    let errors = robot("<plugin name='k' filename='libgazebo_ros_kobuki.so'/>").unwrap_err().to_string();
    assert!(
        errors.contains("'wheel_right_joint', which does not exist; did you mean 'wheel_left_joint'?"),
        "{errors}"
    );
    let errors = robot(
        "<plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>wheel_left_joint</leftJoint>
           <rightJoint>wheel_left_joint</rightJoint><wheelDiameter>-1</wheelDiameter></plugin>",
    )
    .unwrap_err()
    .to_string();
    assert!(
        errors.contains("<wheelDiameter> of plugin 'd' is -1; write metres, from 0.0001 to 10000"),
        "{errors}"
    );
    let passive = robot("").unwrap();
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let id = simulation.spawn(&passive, SpawnOptions::default()).unwrap();
    assert!(simulation.command(id, Command::STOP).unwrap_err().to_string().contains("has no base"));
}

/// A model in a world file can drive too; many users add their robot in this way.
#[test]
fn models_of_a_world_can_drive() {
    let size = SIZES[0];
    let y = 0.5 * size.separation_m;
    let wheel = |name: &str, y: f64| {
        format!(
            "<link name='{name}'><pose>0 {y} 0.033 0 0 0</pose><collision name='c'><pose>0 0 0 1.5707963 0 0</pose>
               <geometry><cylinder><radius>0.033</radius><length>0.02</length></cylinder></geometry></collision>
               <inertial><mass>0.02</mass></inertial></link>
             <joint name='{name}_joint' type='revolute'><parent>body</parent><child>{name}</child>
               <axis><xyz>0 1 0</xyz></axis></joint>"
        )
    };
    let ball = |name: &str, x: f64| {
        format!(
            "<collision name='{name}'><pose>{x} 0 0.01 0 0 0</pose><geometry><sphere><radius>0.01</radius></sphere></geometry>
               <surface><friction><ode><mu>0</mu></ode></friction></surface></collision>"
        )
    };
    let world = format!(
        "<sdf version='1.6'><world name='w'><model name='floor'><static>true</static><link name='l'><collision name='c'>
           <geometry><plane><normal>0 0 1</normal></plane></geometry></collision></link></model>
         <model name='burger'><pose>1 2 0 0 0 0</pose><link name='body'><inertial><pose>0 0 0.03 0 0 0</pose><mass>1</mass>
           </inertial>{}{}</link>{}{}
           <plugin name='d' filename='libgazebo_ros_diff_drive.so'><ros><remapping>odom:=odom</remapping></ros>
             <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
             <wheel_separation>{}</wheel_separation><wheel_diameter>0.066</wheel_diameter>
             <max_wheel_torque>20</max_wheel_torque><odometry_frame>odom</odometry_frame>
             <robot_base_frame>body</robot_base_frame></plugin></model></world></sdf>",
        ball("front", 0.06),
        ball("back", -0.06),
        wheel("left", y),
        wheel("right", -y),
        size.separation_m
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("burger.world");
    std::fs::write(&file, world).unwrap();
    let world = load::world(file.to_str().unwrap()).unwrap();
    let mut simulation = Simulation::builder(world).seed(7).build().unwrap();
    let robot = simulation.find("burger").unwrap();
    simulation.command(robot, Command::new(0.2, 0.0)).unwrap();
    simulation.run_for(Duration::from_secs(2));
    let place = simulation.pose(robot).unwrap().translation();
    assert!((place - DVec3::new(1.4, 2.0, 0.0)).truncate().length() < 0.02, "{place}");
    simulation.reset().unwrap();
    simulation.command(robot, Command::new(0.2, 0.0)).unwrap();
    simulation.run_for(Duration::from_secs(2));
    assert_eq!(simulation.pose(robot).unwrap().translation(), place, "again the same");
}

/// gz-sim's sensors have a topic and no plugin; a robot file may be SDF.
#[test]
fn an_sdf_robot_with_gz_sims_sensors_publishes_them() {
    let sensors = "<sensor name='lidar' type='gpu_lidar'><topic>front/scan</topic><gz_frame_id>mast</gz_frame_id>
         <update_rate>10</update_rate><lidar><scan><horizontal><samples>8</samples><min_angle>-1</min_angle>
         <max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>9</max></range></lidar></sensor>
       <sensor name='eye' type='camera'><topic>/eye/image_raw</topic><update_rate>10</update_rate><camera>
         <optical_frame_id>eye_optical</optical_frame_id><image><width>32</width><height>16</height></image></camera></sensor>
       <sensor name='kinect' type='rgbd_camera'><topic>kinect</topic><camera><image><width>32</width><height>16</height>
         </image></camera></sensor>";
    let text = format!(
        "<sdf version='1.9'><model name='bot'><pose>1 0 0 0 0 0</pose><link name='mast'><inertial><mass>1</mass></inertial>
         {sensors}</link></model></sdf>"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.sdf");
    std::fs::write(&file, text).unwrap();
    let robot = load::robot(file.to_str().unwrap()).unwrap();
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).seed(7).build().unwrap();
    let id = simulation.spawn(&robot, SpawnOptions::default()).unwrap();
    assert_eq!(simulation.pose(id).unwrap().translation().x, 1.0);
    let topics = simulation.topics().unwrap();
    for (topic, frame_id) in [
        ("/front/scan", "mast"),
        ("/eye/image_raw", "eye_optical"),
        ("/eye/camera_info", "eye_optical"),
        ("/kinect/image", "mast_optical"),
        ("/kinect/depth_image", "mast_optical"),
        ("/kinect/points", "mast_optical"),
    ] {
        assert!(topics.iter().any(|known| known == topic), "{topic}: {topics:?}");
        let mut frame = FrameBuf::default();
        simulation.render(topic, &mut frame).unwrap();
        assert_eq!(frame.header().frame_id.as_str(), frame_id, "{topic}");
    }
}

/// The article's lidar is on a link that its robot lacks: the error suggests the link of a lidar, not one with a more
/// similar name.
#[test]
fn the_link_of_a_lidar_is_suggested_for_a_missing_one() {
    let links = ["base_footprint", "gyro_link", "base_laser_link", "camera_rgb_frame"];
    let links: String = links.map(|name| format!("<link name='{name}'/>")).concat();
    let joints: String = ["gyro_link", "base_laser_link", "camera_rgb_frame"]
        .map(|child| {
            format!("<joint name='{child}_j' type='fixed'><parent link='base_footprint'/><child link='{child}'/></joint>")
        })
        .concat();
    let sensor = "<gazebo reference='hokuyo_link'><sensor type='ray' name='head'/></gazebo>";
    let error =
        load::model(&format!("<robot name='r'>{links}{joints}{sensor}</robot>")).unwrap_err().to_string();
    assert!(error.contains("did you mean 'base_laser_link'?"), "{error}");
}

/// A robot that starts inside a wall is refused, and nothing of it remains; one that leans slightly into the floor is
/// accepted.
#[test]
fn a_start_inside_a_wall_is_one_error() {
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    let wall = "<sdf version='1.6'><model name='wall'><pose>2 0 0.5 0 0 0</pose><static>true</static><link name='l'>
      <collision name='c'><geometry><box><size>0.5 4 1</size></box></geometry></collision></link></model></sdf>";
    simulation.spawn(&load::model(wall).unwrap(), SpawnOptions::default()).unwrap();
    let robot = load::robot("kobuki_nostack_rplidar").unwrap();
    let at = |x: f64, z: f64| SpawnOptions {
        world_from_model: belvedere_sensors::Pose::from_translation(DVec3::new(x, 0.0, z)),
        ..SpawnOptions::default()
    };
    let error = simulation.spawn(&robot, at(1.9, 0.0)).unwrap_err().to_string();
    assert!(error.contains("inside the model 'wall'; give it another pose"), "{error}");
    assert_eq!(simulation.entities().iter().count(), 2, "the floor and the wall");
    simulation.spawn(&robot, at(1.0, -0.02)).unwrap();
}

/// Invalid commands and parameters do not stop a robot permanently, and are reported.
#[test]
fn invalid_values_are_reported_and_do_no_harm() {
    let mut bench =
        Bench::new(&four_wheels(SMALL, "<plugin name='p' filename='libgazebo_ros_planar_move.so'/>"));
    bench.drive(Command { linear_m_s: 0.0, lateral_m_s: 0.0, angular_rad_s: f64::NAN }, 0.1);
    bench.drive(Command { linear_m_s: 1e300, lateral_m_s: -1e300, angular_rad_s: 0.0 }, 0.01);
    bench.drive(Command::STOP, 0.5);
    let (before, _) = bench.place();
    bench.drive(Command::new(0.5, 0.0), 1.0);
    let way = (bench.place().0 - before).truncate().length();
    assert!((way - 0.5).abs() < 0.02, "{way}");

    let car_between_its_wheels =
        "<plugin name='a' filename='libgazebo_ros_ackermann_drive.so'><max_steer>1.5</max_steer></plugin>";
    let mut bench = Bench::new(&car(SIZES[2], car_between_its_wheels));
    for angle in [0.6, 1.4, -1.4] {
        bench.drive(Command::new(0.0, angle), 2.0);
        let mut frame = FrameBuf::default();
        bench.simulation.render("joint_states", &mut frame).unwrap();
        let states: Vec<JointState> = frame.view().structs().unwrap().collect();
        let steered = states.iter().filter(|state| state.name.as_str().ends_with("steering_joint"));
        assert!(
            steered.clone().count() == 2 && steered.clone().all(|state| state.position * angle > 0.0),
            "{angle}"
        );
    }

    let refused = |plugin: &str| {
        let inside = format!("{}<gazebo>{plugin}</gazebo>", chassis(SMALL));
        load::model(&format!("<robot name='bot'>{inside}</robot>")).unwrap_err().to_string()
    };
    for noise in ["NaN", "-1", "0.1 x", "inf"] {
        let plugin = format!(
            "<plugin name='h' filename='libhector_gazebo_ros_imu.so'><rateGaussianNoise>{noise}</rateGaussianNoise></plugin>"
        );
        let error = refused(&plugin);
        assert!(error.contains(&format!("<rateGaussianNoise> of plugin 'h' is '{noise}'")), "{error}");
    }

    let plugins = format!(
        "<plugin name='d' filename='libgazebo_ros_diff_drive.so'><leftJoint>l_joint</leftJoint>
           <rightJoint>r_joint</rightJoint>{}</plugin></gazebo><gazebo><static>true</static>",
        wheels_of(SMALL)
    );
    let mut simulation = Simulation::builder(load::world("empty").unwrap()).build().unwrap();
    simulation
        .spawn(
            &two_wheels(SMALL, ["l", "r"], &plugins),
            SpawnOptions { is_robot: Some(true), ..SpawnOptions::default() },
        )
        .unwrap();
    let notes: String = simulation.notes().iter().map(ToString::to_string).collect();
    assert!(notes.contains("robot 'bot' cannot drive: it is static; take its <static> out"), "{notes}");
}

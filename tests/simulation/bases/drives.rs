//! Paths that bases drive, and their limits.

use super::*;

#[test]
fn a_differential_drive_closes_its_circle_with_correct_odometry() {
    for size in SIZES {
        for source in ["encoder", "world"] {
            let plugin = format!(
                "<plugin name='drive' filename='libgazebo_ros_diff_drive.so'><leftJoint>l_joint</leftJoint>
                   <rightJoint>r_joint</rightJoint>{}<commandTopic>go</commandTopic><odometryTopic>here</odometryTopic>
                   <odometryFrame>map</odometryFrame><robotBaseFrame>chassis</robotBaseFrame><updateRate>30</updateRate>
                   <odometrySource>{source}</odometrySource><legacyMode>false</legacyMode></plugin>",
                wheels_of(size)
            );
            let mut bench = Bench::new(&two_wheels(size, ["l", "r"], &plugin));
            // A change of speed within a single step is more than tyres can do, so there are some millimetres of slip.
            let apart_m = circle(&mut bench, 0.3, 0.5);
            assert!(apart_m < 0.02, "{size:?}: {apart_m}");
            let (place, _) = bench.place();
            let (reported, frame) = bench.newest::<Odometry>("here");
            let header = frame.header();
            assert_eq!((header.frame_id.as_str(), reported.child_frame_id.as_str()), ("map", "chassis"));
            let apart_m = (DVec3::from(reported.position) - place).truncate().length();
            assert!(apart_m < 0.02, "{size:?} {source}: {apart_m}");
            assert!(
                (reported.linear[0] - 0.3).abs() < 0.003 && (reported.angular[2] - 0.6).abs() < 0.006,
                "{reported:?}"
            );
            assert_eq!(reported.pose_covariance[0], 1e-5);
        }
    }
}

/// An older version of Gazebo's plugin had left and right exchanged, and some files depend on that.
#[test]
fn the_left_wheel_is_found_by_position_not_by_name() {
    let plugin = format!(
        "<plugin name='drive' filename='libgazebo_ros_diff_drive.so'>
           <leftJoint>r_joint</leftJoint><rightJoint>l_joint</rightJoint>{}</plugin>",
        wheels_of(SMALL)
    );
    let mut bench = Bench::new(&two_wheels(SMALL, ["l", "r"], &plugin));
    bench.drive(Command::new(0.0, 0.5), 2.0);
    let (_, heading) = bench.place();
    assert!((heading - 1.0).abs() < 0.02, "{heading}");
}

/// The plugin's radius determines how fast the wheels turn, the actual radius how fast the robot moves; the encoders
/// use the plugin's.
#[test]
fn a_wrong_diameter_has_the_same_effect_as_in_gazebo() {
    let plugin = format!(
        "<plugin name='drive' filename='libgazebo_ros_diff_drive.so'><leftJoint>l_joint</leftJoint>
           <rightJoint>r_joint</rightJoint><wheelSeparation>{}</wheelSeparation><wheelDiameter>{}</wheelDiameter>
           <odometrySource>encoder</odometrySource></plugin>",
        SMALL.separation_m,
        4.0 * SMALL.radius_m
    );
    let mut bench = Bench::new(&two_wheels(SMALL, ["l", "r"], &plugin));
    bench.drive(Command::new(0.4, 0.0), 2.0);
    let (place, _) = bench.place();
    let reported = bench.odometry("odom");
    assert!(
        (place.x - 0.4).abs() < 0.01 && (reported.position[0] - 0.8).abs() < 0.01,
        "{place} {reported:?}"
    );
}

#[test]
fn acceleration_and_torque_are_limits() {
    let plugin = |limits: &str| {
        format!(
            "<plugin name='drive' filename='libgazebo_ros_diff_drive.so'><leftJoint>l_joint</leftJoint>
               <rightJoint>r_joint</rightJoint><wheelSeparation>0.57</wheelSeparation><wheelDiameter>0.33</wheelDiameter>
               {limits}</plugin>"
        )
    };
    let speed = |limits: &str| {
        let mut bench = Bench::new(&two_wheels(SIZES[1], ["l", "r"], &plugin(limits)));
        bench.drive(Command::new(1.0, 0.0), 0.5);
        bench.odometry("odom").linear[0]
    };
    let slow = speed("<wheelAcceleration>0.4</wheelAcceleration><wheelTorque>1000</wheelTorque>");
    assert!((slow - 0.2).abs() < 0.005, "{slow}");
    // Two motors of 2 N·m at a rim of 0.165 m push 46 kg and two wheels of 0.92 kg.
    let weak = speed("<wheelTorque>2</wheelTorque>");
    let expected = 0.5 * 2.0 * 2.0 / 0.165 / (46.0 + 2.0 * 0.92);
    assert!((weak / expected - 1.0).abs() < 0.03, "{weak} {expected}");
}

#[test]
fn a_skid_steer_turns_as_commanded() {
    for size in SIZES {
        let plugin = format!(
            "<plugin name='skid' filename='libgazebo_ros_skid_steer_drive.so'>
               <leftFrontJoint>front_left_joint</leftFrontJoint><rightFrontJoint>front_right_joint</rightFrontJoint>
               <leftRearJoint>rear_left_joint</leftRearJoint><rightRearJoint>rear_right_joint</rightRearJoint>
               <wheelSeparation>{}</wheelSeparation><wheelDiameter>{}</wheelDiameter><torque>1000</torque>
               <covariance_yaw>0.5</covariance_yaw></plugin>",
            1.7 * size.separation_m,
            2.0 * size.radius_m
        );
        let mut bench = Bench::new(&four_wheels(size, &plugin));
        let apart_m = circle(&mut bench, 0.3, 0.5);
        assert!(apart_m < 0.02, "{size:?}: {apart_m}");
        let reported = bench.odometry("odom");
        assert!(
            reported.pose_covariance[35] == 0.5 && (reported.angular[2] - 0.6).abs() < 0.01,
            "{reported:?}"
        );
    }
}

/// A circle with a constant heading, which no wheel could drive; it falls like other bodies.
#[test]
fn a_planar_base_moves_sideways() {
    for size in SIZES {
        let plugin =
            "<plugin name='p' filename='libgazebo_ros_planar_move.so'><robotNamespace>bot</robotNamespace>
            <odometryRate>20.0</odometryRate></plugin>";
        let mut bench = Bench::new(&four_wheels(size, plugin));
        let (parts, radius_m, period_s) = (200, 0.5, 8.0);
        let mut farthest_m = 0.0_f64;
        for part in 0..parts {
            let (sin, cos) = (TAU * f64::from(part) / f64::from(parts)).sin_cos();
            let speed = TAU * radius_m / period_s;
            let command = Command { linear_m_s: speed * cos, lateral_m_s: speed * sin, angular_rad_s: 0.0 };
            bench.drive(command, period_s / f64::from(parts));
            farthest_m = farthest_m.max(bench.place().0.y);
        }
        let (place, heading) = bench.place();
        assert!(place.truncate().length() < 0.01 && heading.abs() < 1e-3, "{size:?}: {place} {heading}");
        assert!((farthest_m - 2.0 * radius_m).abs() < 0.01, "{farthest_m}");
        bench.drive(Command { lateral_m_s: 0.5, ..Command::STOP }, 0.5);
        let reported = bench.odometry("/bot/odom");
        assert!((reported.linear[1] - 0.5).abs() < 0.01 && reported.linear[0].abs() < 0.01, "{reported:?}");
    }
}

#[test]
fn a_car_with_a_commanded_angle_turns_in_reverse_as_in_gazebo() {
    let size = SIZES[0];
    let plugin = "<plugin name='a' filename='libgazebo_ros_ackermann_drive.so'/>";
    // gazebo_ros_ackermann_drive.cpp multiplies the angle by copysign(1, v), so the sign is that of the turn.
    for (speed_m_s, turn) in [(0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)] {
        let mut bench = Bench::new(&car(size, plugin));
        bench.drive(Command::new(speed_m_s, turn), 3.0);
        let yaw_rad = bench.place().1;
        assert!(yaw_rad * turn > 0.02, "{speed_m_s} m/s, {turn}: turned by {yaw_rad}");
    }
}

#[test]
fn a_car_turns_about_a_point_on_its_rear_axle() {
    for (size, angle) in SIZES.into_iter().zip([0.2, 0.35, 0.1]) {
        let plugin = "<plugin name='a' filename='libgazebo_ros_ackermann_drive.so'><max_steer>0.4</max_steer></plugin>";
        let mut bench = Bench::new(&car(size, plugin));
        // Wait until the steering reaches its angle.
        bench.drive(Command::new(0.0, angle), 2.0);
        let radius_m = size.length_m / angle.tan();
        let rear = |bench: &Bench| {
            let pose = bench.simulation.pose(bench.robot).unwrap();
            pose.transform_point(DVec3::X * -0.5 * size.length_m)
        };
        let start = rear(&bench);
        bench.drive(Command::new(0.4, angle), PI * radius_m / 0.4);
        let apart_m = (rear(&bench) - start - DVec3::Y * 2.0 * radius_m).truncate().length();
        assert!(apart_m < 0.02 * radius_m + 0.01, "{size:?}: {apart_m} of {radius_m}");
        let mut frame = FrameBuf::default();
        bench.simulation.render("joint_states", &mut frame).unwrap();
        let view = frame.view();
        let states: Vec<JointState> = view.numbers(view.rows()).collect();
        let position = |name: &str| states.iter().find(|state| state.name.as_str() == name).unwrap().position;
        for (name, y) in [("left_steering_joint", 0.5), ("right_steering_joint", -0.5)] {
            let expected = (size.length_m / (radius_m - y * size.separation_m)).atan();
            assert!(
                (position(name) - expected).abs() < 1e-3,
                "{size:?}: {name} {} {expected}",
                position(name)
            );
        }
        let turned = ["rear_left_joint", "front_left_joint"].map(|name| position(name) * size.radius_m);
        let inner_m = radius_m - 0.5 * size.separation_m;
        let front_m = inner_m.hypot(size.length_m);
        for (turned, expected) in turned.into_iter().zip([PI * inner_m, PI * front_m]) {
            assert!((turned / expected - 1.0).abs() < 0.03, "{size:?}: {turned} {expected}");
        }
        // Beyond its limit it steers no further, and it never turns on the spot.
        bench.drive(Command::new(0.0, 5.0), 2.0);
        let before = bench.place();
        bench.drive(Command::new(0.0, 5.0), 1.0);
        assert!((bench.place().1 - before.1).abs() < 1e-3);
        bench.drive(Command::new(0.2, 5.0), 0.5);
        let reported = bench.odometry("odom");
        let expected = 0.2 * 0.4_f64.tan() / size.length_m;
        assert!((reported.angular[2] / expected - 1.0).abs() < 0.03, "{reported:?} {expected}");
    }
}

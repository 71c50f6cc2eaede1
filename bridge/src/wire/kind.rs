//! The kinds of streams, the encodings of their payloads, and the operations of commands.

use super::{
    layout::{Value, wire_enum},
    point::{LivoxPoint, OusterPoint, PointLayout, XyzIrPoint, XyzIrtPoint, XyzRgbPoint},
};

wire_enum! {
    /// The meaning of a stream's payload (`FrameHeader::kind`). Numbers are never reused.
    Kind {
        /// A colour or grey image; the header carries its intrinsics.
        Image = 1 "image",
        /// Depth along the optical axis; the header carries its intrinsics.
        DepthImage = 2 "depth_image",
        /// One [`CameraInfo`](crate::payload::CameraInfo).
        CameraInfo = 3 "camera_info",
        /// Ranges of a planar or multi-layer lidar; the header carries its angles.
        LaserScan = 4 "laser_scan",
        /// Points in the sensor's frame; organised (an image of points) if the height is more than 1.
        PointCloud = 5 "point_cloud",
        /// One [`Odometry`](crate::payload::Odometry).
        Odometry = 6 "odometry",
        /// An array of [`Transform`](crate::payload::Transform) that are valid at the stamp.
        Transforms = 7 "transforms",
        /// An array of [`Transform`](crate::payload::Transform) that never change.
        StaticTransforms = 8 "static_transforms",
        /// An array of [`JointState`](crate::payload::JointState).
        JointStates = 9 "joint_states",
        /// One [`Clock`](crate::payload::Clock), the simulated time.
        Clock = 10 "clock",
        /// One [`VelocityCommand`](crate::payload::VelocityCommand), to the robot.
        VelocityCommand = 11 "velocity_command",
        /// One [`Imu`](crate::payload::Imu).
        Imu = 12 "imu",
        /// One [`RobotEvent`](crate::payload::RobotEvent), sent when the state changes.
        RobotEvent = 13 "robot_event",
        /// One [`SimulationCommand`](crate::payload::SimulationCommand), to the simulator; a text may follow it in the
        /// payload.
        SimulationCommand = 14 "simulation_command",
        /// One [`SimulationResult`](crate::payload::SimulationResult), the result of a command.
        SimulationResult = 15 "simulation_result",
        /// An array of [`ModelState`](crate::payload::ModelState).
        ModelStates = 16 "model_states",
        /// One [`CoreSensors`](crate::payload::CoreSensors).
        CoreSensors = 17 "core_sensors",
        /// One [`ResetOdometry`](crate::payload::ResetOdometry), to the robot.
        ResetOdometry = 18 "reset_odometry",
        /// One [`MotorPower`](crate::payload::MotorPower), to the robot.
        MotorPower = 19 "motor_power",
        /// One [`Range`](crate::payload::Range).
        Range = 20 "range",
        /// An array of [`SensorSettings`](crate::payload::SensorSettings): the settings of every sensor that has any,
        /// valid from the stamp on.
        SensorSettings = 21 "sensor_settings",
        /// An array of [`BoundingBox`](crate::payload::BoundingBox), one for each object in an image.
        BoundingBoxes = 22 "bounding_boxes",
        /// An array of [`TagDetection`](crate::payload::TagDetection), one for each tag in an image.
        TagDetections = 23 "tag_detections",
        /// One [`NavSatFix`](crate::payload::NavSatFix).
        NavSatFix = 24 "nav_sat_fix",
        /// One [`MagneticField`](crate::payload::MagneticField).
        MagneticField = 25 "magnetic_field",
        /// One [`FluidPressure`](crate::payload::FluidPressure).
        FluidPressure = 26 "fluid_pressure",
        /// One [`Altimeter`](crate::payload::Altimeter).
        Altimeter = 27 "altimeter",
        /// One [`Vector3`](crate::payload::Vector3).
        Vector3 = 28 "vector3",
        /// One [`Wrench`](crate::payload::Wrench).
        Wrench = 29 "wrench",
        /// An array of [`Contact`](crate::payload::Contact): all contacts of a sensor since its last frame.
        Contacts = 30 "contacts",
        /// An array of [`SeenModel`](crate::payload::SeenModel), one for each model that a logical camera sees.
        SeenModels = 31 "seen_models",
        /// One [`Pose`](crate::payload::Pose).
        Pose = 32 "pose",
    }
}

impl Kind {
    /// Returns true for commands to a robot. Such a stream exists before it has a publisher, because the robot reads it.
    #[must_use]
    pub const fn is_robot_command(self) -> bool {
        matches!(self, Self::VelocityCommand | Self::ResetOdometry | Self::MotorPower)
    }
}

/// The largest number of parameters of any [`DistortionModel`].
pub const MAX_DISTORTION: usize = 14;

wire_enum! {
    /// The mapping from directions to pixels by a lens, and the order of its parameters. Names are those of
    /// `sensor_msgs/CameraInfo` where ROS has one. With K = (fx, fy, cx, cy), the direction (x, y, z) is seen at the
    /// pixel (fx·u + cx, fy·v + cy).
    DistortionModel {
        /// Brown–Conrady: k1 k2 p1 p2 k3; all 0 for a pinhole. u, v are the distorted x/z, y/z.
        PlumbBob = 1 "plumb_bob",
        /// OpenCV's extensions of Brown–Conrady: k1 k2 p1 p2 k3 k4 k5 k6, then the thin prism s1 s2 s3 s4, then the
        /// tilts τx τy; 8, 12 or 14 parameters.
        RationalPolynomial = 2 "rational_polynomial",
        /// Kannala–Brandt, OpenCV's fisheye model: k1 k2 k3 k4 in θ + k1 θ³ + k2 θ⁵ + k3 θ⁷ + k4 θ⁹.
        Equidistant = 3 "equidistant",
        /// Extended unified camera model: alpha beta. ROS has no name for this model or for the following ones.
        Eucm = 4 "eucm",
        /// Double sphere: xi alpha.
        DoubleSphere = 5 "double_sphere",
        /// Mei's unified model: xi k1 k2 p1 p2.
        Mei = 6 "mei",
        /// Columns are angles about the camera's y, rows are elevations: u = atan2(x, z), v = atan2(y, √(x² + z²)).
        Equirectangular = 7 "equirectangular",
        /// SDF's wide-angle lens: c1 c2 c3 f fun cutoff. The radius is c1·f·fun(θ/c2 + c3), f in pixels; fun is 0 for
        /// sin, 1 for tan, 2 for the identity. Directions beyond the cutoff angle are not seen. K holds the scale at
        /// the centre.
        WideAngle = 8 "wide_angle",
    }
}

wire_enum! {
    /// The encoding of one element of the payload (`FrameHeader::encoding`).
    Encoding {
        /// Red, green, blue; 8 bits each.
        Rgb8 = 1 "rgb8" of [u8; 3],
        /// Blue, green, red; 8 bits each.
        Bgr8 = 2 "bgr8" of [u8; 3],
        /// Grey, 8 bits.
        Mono8 = 3 "mono8" of u8,
        /// Depth in metres, 32-bit floats: NaN invalid, −inf too near, +inf no return (REP-118).
        F32C1 = 4 "32fc1" of f32,
        /// Depth in millimetres, 16 bits: 0 invalid (REP-118).
        U16C1 = 5 "16uc1" of u16,
        /// A point with a colour. NaN coordinates mean no point.
        XyzRgbF32 = 6 "xyzrgb_f32" as XyzRgbPoint,
        /// Ranges in metres, 32-bit floats (REP-117): `height` layers of `width` rays. With
        /// [`HAS_INTENSITIES`](crate::FrameHeader::HAS_INTENSITIES) a second plane of the same shape follows
        /// at `height · row_stride`.
        RangesF32 = 7 "ranges_f32" of f32,
        /// `height` fixed structs, `elem_stride` bytes apart; see [`payload`](crate::payload).
        Struct = 8 "struct",
        /// Red, green, blue, and 255; 8 bits each.
        Rgba8 = 9 "rgba8" of [u8; 4],
        /// Grey, 16 bits.
        Mono16 = 10 "mono16" of u16,
        /// Bayer mosaic, 8 bits: red and green in the first row, green and blue in the second.
        BayerRggb8 = 11 "bayer_rggb8" of u8,
        /// Bayer mosaic, 8 bits: blue and green in the first row, green and red in the second.
        BayerBggr8 = 12 "bayer_bggr8" of u8,
        /// Bayer mosaic, 8 bits: green and blue in the first row, red and green in the second.
        BayerGbrg8 = 13 "bayer_gbrg8" of u8,
        /// Bayer mosaic, 8 bits: green and red in the first row, blue and green in the second.
        BayerGrbg8 = 14 "bayer_grbg8" of u8,
        /// Bayer mosaic, 16 bits: red and green in the first row, green and blue in the second.
        BayerRggb16 = 15 "bayer_rggb16" of u16,
        /// Bayer mosaic, 16 bits: blue and green in the first row, green and red in the second.
        BayerBggr16 = 16 "bayer_bggr16" of u16,
        /// Bayer mosaic, 16 bits: green and blue in the first row, red and green in the second.
        BayerGbrg16 = 17 "bayer_gbrg16" of u16,
        /// Bayer mosaic, 16 bits: green and red in the first row, blue and green in the second.
        BayerGrbg16 = 18 "bayer_grbg16" of u16,
        /// Two 32-bit floats: optical flow in pixels, to the right and down; NaN where it is undefined.
        F32C2 = 19 "32fc2" of [f32; 2],
        /// Three 32-bit floats: unit normals in the world's axes; 0 where no surface is seen.
        F32C3 = 20 "32fc3" of [f32; 3],
        /// An instance or class number, 32-bit signed; in instance images, −1 where nothing is seen.
        I32C1 = 21 "32sc1" of i32,
        /// A point in the layout of Velodyne's driver. NaN coordinates mean no point, which occurs only in clouds of
        /// several rows.
        XyzIrtF32 = 22 "xyzirt_f32" as XyzIrtPoint,
        /// A point in the layout of Ouster's driver. NaN coordinates mean no point. A row is a laser, a column a
        /// direction.
        OusterPoint = 23 "ouster_point" as OusterPoint,
        /// A point in the layout of Livox's driver.
        LivoxPoint = 24 "livox_point" as LivoxPoint,
        /// A point in the layout of gz-sim's lidars. NaN coordinates mean no point. A row is a layer.
        XyzIrF32 = 25 "xyzir_f32" as XyzIrPoint,
    }
}

wire_enum! {
    /// An operation on a simulation (`SimulationCommand::operation`). Numbers are never reused; a simulator refuses one
    /// that it does not know.
    Operation {
        /// Pause simulated time.
        Pause = 1 "pause",
        /// Resume simulated time.
        Resume = 2 "resume",
        /// Run `steps` physics steps and publish everything that is due, then pause.
        Step = 3 "step",
        /// Return every model to its initial pose, at rest; time continues.
        ResetWorld = 4 "reset_world",
        /// Restart at time 0; the output is the same as after a fresh start.
        ResetSimulation = 5 "reset_simulation",
        /// Set the pose and velocity of the model `name`, in the frame `reference`.
        SetModelState = 6 "set_model_state",
        /// Add the model in the text (URDF or SDF) to the world as `name`, at a pose in the frame `reference`.
        Spawn = 7 "spawn",
        /// Remove the model `name` from the world.
        Delete = 8 "delete",
        /// Change settings of the sensor `name`, or of the sensor that publishes the topic `name`: `key=value` words in
        /// the text.
        Configure = 9 "configure",
        /// Change nothing. The result's `reason` holds words that describe the simulation and, if there is a `name`, that
        /// model.
        Query = 10 "query",
    }
}

impl Encoding {
    /// Returns the bytes of one element; `None` for [`Encoding::Struct`], whose size depends on the kind.
    #[must_use]
    pub const fn elem_size(self) -> Option<usize> {
        match self.value().element_size {
            0 => None,
            size => Some(size),
        }
    }

    /// Returns the layout of a point; `None` for encodings of other elements.
    #[must_use]
    pub const fn point(self) -> Option<&'static PointLayout> {
        self.value().point
    }

    /// Returns this encoding as data.
    const fn value(self) -> &'static Value {
        let values = Self::LAYOUT.values;
        let mut at = 0;
        while values[at].number != self as u16 {
            at += 1;
        }
        &values[at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_names_come_back() {
        for &kind in Kind::ALL {
            assert_eq!(Kind::from_wire(kind.to_wire()), Some(kind));
            assert_eq!(kind.as_str().parse(), Ok(kind));
        }
        for &encoding in Encoding::ALL {
            assert_eq!(Encoding::from_wire(encoding.to_wire()), Some(encoding));
            assert_eq!(encoding.as_str().parse(), Ok(encoding));
        }
        for &operation in Operation::ALL {
            assert_eq!(Operation::from_wire(operation.to_wire()), Some(operation));
            assert_eq!(operation.as_str().parse(), Ok(operation));
        }
        assert_eq!(Kind::from_wire(0), None);
        assert_eq!(Encoding::from_wire(9999), None);
    }
}

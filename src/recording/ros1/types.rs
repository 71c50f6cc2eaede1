//! ROS 1 message types: their names, and their definitions as readers expect them. Fields and constants are those of
//! the packages in Noetic, so that MD5 sums computed from them agree; comments do not count.

use std::fmt::Write as _;

/// A message type.
#[derive(Debug)]
pub struct MessageType {
    /// `package/Type`.
    pub name: &'static str,
    /// Its own fields.
    fields: &'static str,
    /// The types of fields that are messages themselves.
    parts: &'static [&'static MessageType],
}

impl MessageType {
    /// Returns the definition followed by those of all parts, in the format `ros1msg`.
    pub fn definition(&self) -> String {
        let mut parts = Vec::new();
        self.collect(&mut parts);
        let mut text = self.fields.to_owned();
        for part in parts {
            let _ = write!(text, "\n{}\nMSG: {}\n{}", "=".repeat(80), part.name, part.fields);
        }
        text
    }

    fn collect(&self, parts: &mut Vec<&'static MessageType>) {
        for part in self.parts {
            if !parts.iter().any(|known| known.name == part.name) {
                parts.push(part);
                part.collect(parts);
            }
        }
    }
}

/// Defines message types with their parts.
macro_rules! types {
    ($($(#[$doc:meta])* $constant:ident = $name:literal [$($part:ident),*] $fields:expr;)+) => {
        $($(#[$doc])* pub(super) static $constant: MessageType =
            MessageType { name: $name, fields: $fields, parts: &[$(&$part),*] };)+
    };
}

types! {
    HEADER = "std_msgs/Header" [] "uint32 seq\ntime stamp\nstring frame_id";
    VECTOR3 = "geometry_msgs/Vector3" [] "float64 x\nfloat64 y\nfloat64 z";
    POINT = "geometry_msgs/Point" [] "float64 x\nfloat64 y\nfloat64 z";
    QUATERNION = "geometry_msgs/Quaternion" [] "float64 x\nfloat64 y\nfloat64 z\nfloat64 w";
    POSE = "geometry_msgs/Pose" [POINT, QUATERNION] "Point position\nQuaternion orientation";
    TWIST = "geometry_msgs/Twist" [VECTOR3] "Vector3 linear\nVector3 angular";
    POSE_COVARIANCE = "geometry_msgs/PoseWithCovariance" [POSE] "Pose pose\nfloat64[36] covariance";
    TWIST_COVARIANCE = "geometry_msgs/TwistWithCovariance" [TWIST] "Twist twist\nfloat64[36] covariance";
    TRANSFORM = "geometry_msgs/Transform" [VECTOR3, QUATERNION] "Vector3 translation\nQuaternion rotation";
    TRANSFORM_STAMPED = "geometry_msgs/TransformStamped" [HEADER, TRANSFORM]
        "Header header\nstring child_frame_id\nTransform transform";
    REGION = "sensor_msgs/RegionOfInterest" []
        "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify";
    POINT_FIELD = "sensor_msgs/PointField" []
        "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n\
         uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count";

    IMAGE = "sensor_msgs/Image" [HEADER]
        "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data";
    CAMERA_INFO = "sensor_msgs/CameraInfo" [HEADER, REGION]
        "Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\nfloat64[9] K\nfloat64[9] R\n\
         float64[12] P\nuint32 binning_x\nuint32 binning_y\nRegionOfInterest roi";
    LASER_SCAN = "sensor_msgs/LaserScan" [HEADER]
        "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n\
         float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities";
    POINT_CLOUD = "sensor_msgs/PointCloud2" [HEADER, POINT_FIELD]
        "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nuint32 point_step\n\
         uint32 row_step\nuint8[] data\nbool is_dense";
    ODOMETRY = "nav_msgs/Odometry" [HEADER, POSE_COVARIANCE, TWIST_COVARIANCE]
        "Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist";
    TRANSFORMS = "tf2_msgs/TFMessage" [TRANSFORM_STAMPED] "geometry_msgs/TransformStamped[] transforms";
    JOINT_STATE = "sensor_msgs/JointState" [HEADER]
        "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort";
    CLOCK = "rosgraph_msgs/Clock" [] "time clock";
    IMU = "sensor_msgs/Imu" [HEADER, QUATERNION, VECTOR3]
        "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
         geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
         geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance";
    RANGE = "sensor_msgs/Range" [HEADER]
        "uint8 ULTRASOUND=0\nuint8 INFRARED=1\nHeader header\nuint8 radiation_type\nfloat32 field_of_view\n\
         float32 min_range\nfloat32 max_range\nfloat32 range";
    NAV_SAT_STATUS = "sensor_msgs/NavSatStatus" []
        "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\nint8 status\n\
         uint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\nuint16 SERVICE_GALILEO=8\n\
         uint16 service";
    NAV_SAT_FIX = "sensor_msgs/NavSatFix" [HEADER, NAV_SAT_STATUS]
        "Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n\
         float64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\nuint8 COVARIANCE_TYPE_APPROXIMATED=1\n\
         uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\nuint8 COVARIANCE_TYPE_KNOWN=3\nuint8 position_covariance_type";
    MAGNETIC_FIELD = "sensor_msgs/MagneticField" [HEADER, VECTOR3]
        "Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance";
    FLUID_PRESSURE = "sensor_msgs/FluidPressure" [HEADER] "Header header\nfloat64 fluid_pressure\nfloat64 variance";
    POINT_STAMPED = "geometry_msgs/PointStamped" [HEADER, POINT] "Header header\nPoint point";
    VECTOR3_STAMPED = "geometry_msgs/Vector3Stamped" [HEADER, VECTOR3] "Header header\nVector3 vector";
    EMPTY = "std_msgs/Empty" [] "";
    MODEL_STATES = "gazebo_msgs/ModelStates" [POSE, TWIST]
        include_str!("gazebo_msgs/ModelStates.msg");
    LINK_STATES = "gazebo_msgs/LinkStates" [POSE, TWIST]
        include_str!("gazebo_msgs/LinkStates.msg");
    CORE_SENSORS = "kobuki_msgs/SensorState" [HEADER]
        include_str!("kobuki_msgs/SensorState.msg");
    BUMPER = "kobuki_msgs/BumperEvent" [] include_str!("kobuki_msgs/BumperEvent.msg");
    CLIFF = "kobuki_msgs/CliffEvent" [] include_str!("kobuki_msgs/CliffEvent.msg");
    WHEEL_DROP = "kobuki_msgs/WheelDropEvent" []
        include_str!("kobuki_msgs/WheelDropEvent.msg");
    MOTOR_POWER = "kobuki_msgs/MotorPower" []
        include_str!("kobuki_msgs/MotorPower.msg");

    /// Belvedere's own type, for the data that ROS messages lack.
    FRAME = "belvedere/Frame" []
        "# A frame as it was in shared memory; the layout of its header and payload is Belvedere's wire format.\n\
         uint8[] header\n\
         # Where payload is empty and the header tells of one: it is part of the message before this one, of the\n\
         # stream's own topic, from this byte on.\n\
         uint64 payload_offset\n\
         uint8[] payload";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_defined_once_after_the_types_that_use_them() {
        let line = "=".repeat(80);
        let expected = format!(
            "Vector3 linear\nVector3 angular\n{line}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z"
        );
        assert_eq!(TWIST.definition(), expected);
        assert_eq!(ODOMETRY.definition().matches("MSG: geometry_msgs/Point\n").count(), 1);
        assert_eq!(ODOMETRY.definition().matches("MSG: ").count(), 8);
    }
}

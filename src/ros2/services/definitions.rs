//! The fields of the messages of `simulation_interfaces`, from which the hashes of its services follow.
//!
//! They are those of versions 1.5 (Jazzy) and 1.6 (Kilted). Version 2.1 has the same bytes in a request, except for three
//! flags at the end of that of `SetEntityState`.

/// Definitions of the messages that requests and responses contain.
pub(super) const MESSAGES: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular"),
    ("geometry_msgs/Accel", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular"),
    ("simulation_interfaces/Result", "uint8 result\nstring error_message"),
    ("simulation_interfaces/SimulationState", "uint8 state"),
    (
        "simulation_interfaces/SimulatorFeatures",
        "uint16[] features\nstring[] spawn_formats\nstring custom_info",
    ),
    ("simulation_interfaces/Resource", "string uri\nstring resource_string"),
    ("simulation_interfaces/EntityCategory", "uint8 category"),
    ("simulation_interfaces/TagsFilter", "string[] tags\nuint8 filter_mode"),
    ("simulation_interfaces/Bounds", "uint8 type\ngeometry_msgs/Vector3[] points"),
    (
        "simulation_interfaces/EntityFilters",
        "string filter\nsimulation_interfaces/EntityCategory[] categories\nsimulation_interfaces/TagsFilter tags\n\
         simulation_interfaces/Bounds bounds",
    ),
    (
        "simulation_interfaces/EntityInfo",
        "simulation_interfaces/EntityCategory category\nstring description\nstring[] tags",
    ),
    (
        "simulation_interfaces/EntityState",
        "std_msgs/Header header\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel acceleration",
    ),
    (
        "simulation_interfaces/SpawnEntity",
        "string name\nbool allow_renaming\nsimulation_interfaces/Resource entity_resource\nstring entity_namespace\n\
         geometry_msgs/PoseStamped initial_pose",
    ),
    ("simulation_interfaces/SpawnResult", "simulation_interfaces/Result result\nstring entity_name"),
];

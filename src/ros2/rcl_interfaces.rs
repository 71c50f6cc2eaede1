//! The definitions of the package `rcl_interfaces` of ROS 2, as far as parameters need them.

/// The messages, with the packages of those that they contain.
pub(super) const MESSAGES: &[(&str, &str)] = &[
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec"),
    ("rcl_interfaces/Parameter", "string name\nrcl_interfaces/ParameterValue value"),
    (
        "rcl_interfaces/ParameterValue",
        "uint8 type
        bool bool_value
        int64 integer_value
        float64 double_value
        string string_value
        byte[] byte_array_value
        bool[] bool_array_value
        int64[] integer_array_value
        float64[] double_array_value
        string[] string_array_value",
    ),
    (
        "rcl_interfaces/ParameterDescriptor",
        "string name
        uint8 type
        string description
        string additional_constraints
        bool read_only
        bool dynamic_typing
        rcl_interfaces/FloatingPointRange[<=1] floating_point_range
        rcl_interfaces/IntegerRange[<=1] integer_range",
    ),
    ("rcl_interfaces/FloatingPointRange", "float64 from_value\nfloat64 to_value\nfloat64 step"),
    ("rcl_interfaces/IntegerRange", "int64 from_value\nint64 to_value\nuint64 step"),
    ("rcl_interfaces/SetParametersResult", "bool successful\nstring reason"),
    ("rcl_interfaces/ListParametersResult", "string[] names\nstring[] prefixes"),
];

/// The message `rcl_interfaces/msg/ParameterEvent`.
pub(super) const PARAMETER_EVENT: &str = "builtin_interfaces/Time stamp
    string node
    rcl_interfaces/Parameter[] new_parameters
    rcl_interfaces/Parameter[] changed_parameters
    rcl_interfaces/Parameter[] deleted_parameters";

/// What a service of parameters does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Task {
    List,
    Get,
    GetTypes,
    Describe,
    Set,
    SetAtomically,
}

/// A service of parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct ParameterService {
    pub(super) task: Task,
    /// Its name below that of a node.
    pub(super) name: &'static str,
    /// Its type.
    pub(super) service: &'static str,
    /// The definition of its type, with the packages of the messages.
    pub(super) definition: &'static str,
}

/// The services of parameters.
pub(super) const SERVICES: [ParameterService; 6] = [
    ParameterService {
        task: Task::List,
        name: "list_parameters",
        service: "rcl_interfaces/srv/ListParameters",
        definition: "string[] prefixes\nuint64 depth\n---\nrcl_interfaces/ListParametersResult result",
    },
    ParameterService {
        task: Task::Get,
        name: "get_parameters",
        service: "rcl_interfaces/srv/GetParameters",
        definition: "string[] names\n---\nrcl_interfaces/ParameterValue[] values",
    },
    ParameterService {
        task: Task::GetTypes,
        name: "get_parameter_types",
        service: "rcl_interfaces/srv/GetParameterTypes",
        definition: "string[] names\n---\nuint8[] types",
    },
    ParameterService {
        task: Task::Describe,
        name: "describe_parameters",
        service: "rcl_interfaces/srv/DescribeParameters",
        definition: "string[] names\n---\nrcl_interfaces/ParameterDescriptor[] descriptors",
    },
    ParameterService {
        task: Task::Set,
        name: "set_parameters",
        service: "rcl_interfaces/srv/SetParameters",
        definition: "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult[] results",
    },
    ParameterService {
        task: Task::SetAtomically,
        name: "set_parameters_atomically",
        service: "rcl_interfaces/srv/SetParametersAtomically",
        definition: "rcl_interfaces/Parameter[] parameters\n---\nrcl_interfaces/SetParametersResult result",
    },
];

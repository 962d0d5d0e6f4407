//! The definitions of ROS 2 message types as MCAP files have them (encoding `ros2msg`): the type, then each type that it uses. The
//! field names are those of common_interfaces, rcl_interfaces and tf2_msgs.

/// A type: its name, and its definition with those of the types in it.
#[derive(Clone, Copy, Debug)]
pub struct Schema {
    /// The name, such as `sensor_msgs/msg/JointState`.
    pub name: &'static str,
    /// The fields.
    fields: &'static str,
    /// The types in it, directly and through others.
    uses: &'static [(&'static str, &'static str)],
}

impl Schema {
    /// The whole definition.
    #[must_use]
    pub fn text(&self) -> String {
        let part = |(name, fields): &(&str, &str)| format!("{}\nMSG: {name}\n{fields}", "=".repeat(80));
        format!("{}{}", self.fields, self.uses.iter().map(part).collect::<String>())
    }
}

const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const VECTOR: (&str, &str) = ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
const POINT: (&str, &str) = ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
const QUATERNION: (&str, &str) = ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
const WRENCH: (&str, &str) = ("geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n");
const POSE: (&str, &str) =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const TRANSFORM: (&str, &str) =
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n");
const STAMPED: (&str, &str) = (
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
);

/// Angles and torques of joints.
pub const JOINT_STATE: Schema = Schema {
    name: "sensor_msgs/msg/JointState",
    fields: "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    uses: &[HEADER, TIME],
};

/// A wrench in a frame.
pub const WRENCH_STAMPED: Schema = Schema {
    name: "geometry_msgs/msg/WrenchStamped",
    fields: "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
    uses: &[HEADER, TIME, WRENCH, VECTOR],
};

/// A pose in a frame.
pub const POSE_STAMPED: Schema = Schema {
    name: "geometry_msgs/msg/PoseStamped",
    fields: "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    uses: &[HEADER, TIME, POSE, POINT, QUATERNION],
};

/// Poses of frames in others.
pub const TF_MESSAGE: Schema = Schema {
    name: "tf2_msgs/msg/TFMessage",
    fields: "geometry_msgs/TransformStamped[] transforms\n",
    uses: &[STAMPED, HEADER, TIME, TRANSFORM, VECTOR, QUATERNION],
};

/// A number.
pub const FLOAT64: Schema = Schema { name: "std_msgs/msg/Float64", fields: "float64 data\n", uses: &[] };

/// An event with its level and text.
pub const LOG: Schema = Schema {
    name: "rcl_interfaces/msg/Log",
    fields: "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\nstring function\nuint32 line\n",
    uses: &[TIME],
};

#include <initializer_list>
#include <map>
#include <string_view>

#include <knurl/messages/schemas.hpp>

namespace knurl::messages {

namespace {

constexpr std::string_view separator =
    "================================================================================\n";

/// Definitions of ROS 2 Humble, without their comments.
const std::map<std::string_view, std::string_view>& definitions() {
    static const std::map<std::string_view, std::string_view> all{
        {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
        {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
        {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
        {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
        {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
        {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
        {"geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"},
        {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
        {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
        {"geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"},
        {"geometry_msgs/WrenchStamped", "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n"},
        {"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
        {"geometry_msgs/TwistStamped", "std_msgs/Header header\ngeometry_msgs/Twist twist\n"},
        {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
        {"geometry_msgs/TransformStamped",
         "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
        {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
        {"sensor_msgs/JointState",
         "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"},
        {"sensor_msgs/Joy", "std_msgs/Header header\nfloat32[] axes\nint32[] buttons\n"},
        {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
        {"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
        {"diagnostic_msgs/DiagnosticStatus",
         "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
         "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values\n"},
        {"diagnostic_msgs/DiagnosticArray",
         "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
        {"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"},
        {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"},
        {"visualization_msgs/Marker",
         "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\n"
         "int32 LINE_LIST=5\nint32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\n"
         "int32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\nint32 TRIANGLE_LIST=11\n"
         "int32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\n"
         "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
         "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
         "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\n"
         "string texture_resource\nsensor_msgs/CompressedImage texture\n"
         "visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n"
         "visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"},
        {"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n"},
    };
    return all;
}

/// The first type, with the others behind it.
Schema schema_of(std::initializer_list<std::string_view> types) {
    Schema schema;
    schema.encoding = "ros2msg";
    for (const std::string_view type : types) {
        if (schema.name.empty()) {
            const std::size_t slash = type.find('/');
            schema.name = std::string(type.substr(0, slash)) + "/msg" + std::string(type.substr(slash));
        } else {
            schema.text += std::string(separator) + "MSG: " + std::string(type) + "\n";
        }
        schema.text += definitions().at(type);
    }
    return schema;
}

constexpr std::string_view time = "builtin_interfaces/Time", header = "std_msgs/Header",
                           vector = "geometry_msgs/Vector3", point = "geometry_msgs/Point",
                           quaternion = "geometry_msgs/Quaternion", pose = "geometry_msgs/Pose";

}  // namespace

// bindings/python/knurl/_mcap.py has the same text.
const Schema& report_schema() {
    static const Schema schema{
        "knurl_msgs/msg/Report", "ros2msg",
        R"(# What Knurl's servo publishes each cycle, of one device, in that device's own frame.
uint64 cycle
int64 deadline_ns   # CLOCK_MONOTONIC: when the cycle should have begun
int64 read_ns       # when the joint sample had been read
int64 write_ns      # when the efforts had been written
float64[8] joints   # rad
geometry_msgs/Vector3 position      # m
knurl_msgs/Quaternion orientation
geometry_msgs/Vector3 velocity      # m/s
geometry_msgs/Vector3 slow_velocity # m/s
geometry_msgs/Vector3 angular_velocity # rad/s
geometry_msgs/Vector3 scene_force   # N, before the supervisor
geometry_msgs/Vector3 scene_torque  # N m
geometry_msgs/Vector3 sent_force    # N, after the supervisor
geometry_msgs/Vector3 sent_torque   # N m
geometry_msgs/Vector3 contact_point # m
uint32 state        # 0 disconnected, 1 idle, 2 armed, 3 ramp up, 4 active, 5 ramp down, 6 fault
uint32 faults       # bit mask
uint32 buttons      # bit mask
uint32 flags        # bit mask
uint64 late_count   # cycles
uint32 presses      # bit mask, a bit turned over by each press
uint32 touches      # contacts that have begun
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: knurl_msgs/Quaternion
float64 w
float64 x
float64 y
float64 z
)"};
    return schema;
}

const Schema& pose_schema() {
    static const Schema schema =
        schema_of({"geometry_msgs/PoseStamped", header, time, pose, point, quaternion});
    return schema;
}
const Schema& wrench_schema() {
    static const Schema schema =
        schema_of({"geometry_msgs/WrenchStamped", header, time, "geometry_msgs/Wrench", vector});
    return schema;
}
const Schema& twist_schema() {
    static const Schema schema =
        schema_of({"geometry_msgs/TwistStamped", header, time, "geometry_msgs/Twist", vector});
    return schema;
}
const Schema& joints_schema() {
    static const Schema schema = schema_of({"sensor_msgs/JointState", header, time});
    return schema;
}
const Schema& joy_schema() {
    static const Schema schema = schema_of({"sensor_msgs/Joy", header, time});
    return schema;
}
const Schema& transforms_schema() {
    static const Schema schema = schema_of({"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped", header,
                                            time, "geometry_msgs/Transform", vector, quaternion});
    return schema;
}
const Schema& markers_schema() {
    static const Schema schema = schema_of(
        {"visualization_msgs/MarkerArray", "visualization_msgs/Marker", header, time, pose, point, quaternion,
         vector, "std_msgs/ColorRGBA", "builtin_interfaces/Duration", "sensor_msgs/CompressedImage",
         "visualization_msgs/UVCoordinate", "visualization_msgs/MeshFile"});
    return schema;
}
const Schema& diagnostics_schema() {
    static const Schema schema = schema_of({"diagnostic_msgs/DiagnosticArray", header, time,
                                            "diagnostic_msgs/DiagnosticStatus", "diagnostic_msgs/KeyValue"});
    return schema;
}

const Schema& parameters_schema() {
    static const Schema schema{"knurl.Parameters", "jsonschema", R"({
  "title": "knurl.Parameters",
  "type": "object",
  "properties": {
    "device": {"type": "object", "properties": {
      "name": {"type": "string"}, "servo": {"type": "string"}, "address": {"type": "string"},
      "profile": {"type": "string"}, "serial": {"type": "string"}, "joints": {"type": "integer"},
      "renders_torque": {"type": "boolean"}, "senses_orientation": {"type": "boolean"},
      "rate": {"type": "number"}, "workspace_radius": {"type": "number"},
      "workspace_centre": {"type": "array", "items": {"type": "number"}},
      "peak_force": {"type": "number"}, "peak_torque": {"type": "number"}, "max_stiffness": {"type": "number"},
      "damping": {"type": "number"}, "lag": {"type": "number"}}},
    "items": {"type": "array", "items": {"type": "object", "properties": {
      "claim": {"type": "integer"}, "slot": {"type": "integer"}, "kind": {"type": "string"},
      "probe": {"type": "integer"}, "params": {"type": "object"}}}},
    "left_out": {"type": "integer"}
  }
})"};
    return schema;
}

}  // namespace knurl::messages

#pragma once
// Definitions of the messages, as Foxglove and MCAP files want them: the type, then each type that it needs behind a
// line of '=' and "MSG: package/Type". The types of ROS are those of Humble.

#include <string>

namespace knurl::messages {

struct Schema {
    std::string name;      // "geometry_msgs/msg/PoseStamped"
    std::string encoding;  // "ros2msg", "jsonschema"
    std::string text;
};

const Schema& report_schema();
const Schema& pose_schema();
const Schema& wrench_schema();
const Schema& twist_schema();
const Schema& joints_schema();
const Schema& joy_schema();
const Schema& transforms_schema();
const Schema& markers_schema();
const Schema& diagnostics_schema();
/// JSON: a device's figures, its clients, what they have made.
const Schema& parameters_schema();

}  // namespace knurl::messages

#pragma once

/// @file
/// Names and hashes of ROS 2's message types. Since Iron each endpoint says by a hash (RIHS01) how its type is defined;
/// a node of ROS prints an error for an endpoint that says none.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace knurl::dds {

/// One member of a message, as a .msg file has it: "float64", "string[]", "geometry_msgs/msg/Pose".
struct MessageField {
    /// Its name.
    std::string name;
    /// Its type.
    std::string type;
};

/// A message type.
struct MessageType {
    /// "geometry_msgs/msg/PoseStamped".
    std::string name;
    /// Its members, in order.
    std::vector<MessageField> fields;
};

/// All that knurl-dds speaks, those of the representations included.
std::span<const MessageType> message_types();
/// Of that name; null: there is none.
const MessageType* find_message_type(std::string_view name);

/// "RIHS01_" and 64 hexadecimal digits: SHA-256 of the type's description in JSON, as ROS 2 states it. Throws
/// std::runtime_error: it is none of message_types().
std::string type_hash(std::string_view message);
/// The text that is hashed.
std::string type_description(std::string_view message);
/// "geometry_msgs::msg::dds_::PoseStamped_" for "geometry_msgs/msg/PoseStamped".
std::string dds_type_name(std::string_view message);
/// What stands in the USER_DATA of an endpoint: "typehash=RIHS01_...;".
std::string user_data(std::string_view message);
/// The hash in somebody's USER_DATA; none: it says none.
std::optional<std::string> hash_in(std::string_view user_data);

}  // namespace knurl::dds

#include <array>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nettle/sha2.h>

#include <knurl/dds/type_hash.hpp>

#include "kind_message.hpp"

namespace knurl::dds {

namespace {

/// Numbers of type_description_interfaces/msg/FieldType.
const std::map<std::string_view, int>& primitives() {
    static const std::map<std::string_view, int> all{
        {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
        {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
        {"bool", 15},  {"byte", 16}, {"string", 17}};
    return all;
}
constexpr int nested = 1, unbounded_sequence = 144;

std::vector<MessageType> ros_types() {
    const MessageField header{"header", "std_msgs/msg/Header"};
    const std::vector<MessageField> xyz{{"x", "float64"}, {"y", "float64"}, {"z", "float64"}};
    std::vector<MessageField> xyzw = xyz;
    xyzw.push_back({"w", "float64"});
    return {
        {"builtin_interfaces/msg/Time", {{"sec", "int32"}, {"nanosec", "uint32"}}},
        {"std_msgs/msg/Header", {{"stamp", "builtin_interfaces/msg/Time"}, {"frame_id", "string"}}},
        {"std_msgs/msg/Empty", {{"structure_needs_at_least_one_member", "uint8"}}},
        {"geometry_msgs/msg/Vector3", xyz},
        {"geometry_msgs/msg/Point", xyz},
        {"geometry_msgs/msg/Quaternion", xyzw},
        {"geometry_msgs/msg/Pose",
         {{"position", "geometry_msgs/msg/Point"}, {"orientation", "geometry_msgs/msg/Quaternion"}}},
        {"geometry_msgs/msg/PoseStamped", {header, {"pose", "geometry_msgs/msg/Pose"}}},
        {"geometry_msgs/msg/Twist",
         {{"linear", "geometry_msgs/msg/Vector3"}, {"angular", "geometry_msgs/msg/Vector3"}}},
        {"geometry_msgs/msg/TwistStamped", {header, {"twist", "geometry_msgs/msg/Twist"}}},
        {"geometry_msgs/msg/Wrench",
         {{"force", "geometry_msgs/msg/Vector3"}, {"torque", "geometry_msgs/msg/Vector3"}}},
        {"geometry_msgs/msg/WrenchStamped", {header, {"wrench", "geometry_msgs/msg/Wrench"}}},
        {"geometry_msgs/msg/Transform",
         {{"translation", "geometry_msgs/msg/Vector3"}, {"rotation", "geometry_msgs/msg/Quaternion"}}},
        {"geometry_msgs/msg/TransformStamped",
         {header, {"child_frame_id", "string"}, {"transform", "geometry_msgs/msg/Transform"}}},
        {"tf2_msgs/msg/TFMessage", {{"transforms", "geometry_msgs/msg/TransformStamped[]"}}},
        {"sensor_msgs/msg/JointState",
         {header,
          {"name", "string[]"},
          {"position", "float64[]"},
          {"velocity", "float64[]"},
          {"effort", "float64[]"}}},
        {"sensor_msgs/msg/Joy", {header, {"axes", "float32[]"}, {"buttons", "int32[]"}}},
        {"diagnostic_msgs/msg/KeyValue", {{"key", "string"}, {"value", "string"}}},
        {"diagnostic_msgs/msg/DiagnosticStatus",
         {{"level", "byte"},
          {"name", "string"},
          {"message", "string"},
          {"hardware_id", "string"},
          {"values", "diagnostic_msgs/msg/KeyValue[]"}}},
        {"diagnostic_msgs/msg/DiagnosticArray",
         {header, {"status", "diagnostic_msgs/msg/DiagnosticStatus[]"}}},
        {"crtk_msgs/msg/OperatingState",
         {header, {"state", "string"}, {"is_homed", "bool"}, {"is_busy", "bool"}}},
        {"crtk_msgs/msg/StringStamped", {header, {"string", "string"}}},
        {"knurl_msgs/msg/Remove", {header, {"id", "string"}}},
    };
}

std::string member_type(Field::Type type) {
    switch (type) {
        case Field::Type::real:
            return "float64";
        case Field::Type::vector:
            return "geometry_msgs/msg/Vector3";
        case Field::Type::quaternion:
            return "geometry_msgs/msg/Quaternion";
        case Field::Type::choice:
        case Field::Type::integer:
            return "uint32";
        case Field::Type::matrix:
            return "float64[]";
        case Field::Type::points:
            return "geometry_msgs/msg/Vector3[]";
    }
    return {};
}

std::vector<MessageType> all_types() {
    std::vector<MessageType> all = ros_types();
    for (const KindMessage& kind : kind_messages()) {
        MessageType type{
            .name = fmt::format("knurl_msgs/msg/{}", kind.type),
            .fields = {{"header", "std_msgs/msg/Header"}, {"id", "string"}, {"probe", "uint32"}}};
        for (const Field& field : kinds()[kind.kind].fields) {
            std::string name(field.name);
            for (char& c : name)
                if (c == '.') c = '_';
            type.fields.push_back({std::move(name), member_type(field.type)});
        }
        all.push_back(std::move(type));
    }
    return all;
}

const MessageType& required(std::string_view name) {
    if (const MessageType* found = find_message_type(name)) return *found;
    throw std::runtime_error(fmt::format("there is no message type '{}'", name));
}

/// As Python's json.dumps writes it, with ", " and ": ".
std::string description_of(const MessageType& type, std::set<std::string>& used) {
    std::string fields;
    for (const MessageField& field : type.fields) {
        std::string_view base = field.type;
        int number = 0;
        if (base.ends_with("[]")) {
            base.remove_suffix(2);
            number = unbounded_sequence;
        }
        const auto primitive = primitives().find(base);
        std::string_view nested_name;
        if (primitive == primitives().end()) {
            nested_name = base;
            number += nested;
            used.emplace(base);
        } else {
            number += primitive->second;
        }
        fields += fmt::format(
            R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": 0, "string_capacity": 0, "nested_type_name": "{}"}}}})",
            fields.empty() ? "" : ", ", field.name, number, nested_name);
    }
    return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", type.name, fields);
}

}  // namespace

std::span<const MessageType> message_types() {
    static const std::vector<MessageType> all = all_types();
    return all;
}

const MessageType* find_message_type(std::string_view name) {
    for (const MessageType& type : message_types())
        if (type.name == name) return &type;
    return nullptr;
}

std::string type_description(std::string_view message) {
    std::set<std::string> to_do;
    const std::string top = description_of(required(message), to_do);
    std::map<std::string, std::string> referenced;  // sorted by name
    while (!to_do.empty()) {
        const std::string name = *to_do.begin();
        to_do.erase(to_do.begin());
        if (referenced.contains(name)) continue;
        referenced[name] = description_of(required(name), to_do);
    }
    std::string rest;
    for (const auto& [name, text] : referenced) rest += (rest.empty() ? "" : ", ") + text;
    return fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})", top, rest);
}

std::string type_hash(std::string_view message) {
    const std::string text = type_description(message);
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, text.size(), reinterpret_cast<const std::uint8_t*>(text.data()));
    std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
    sha256_digest(&context, digest.size(), digest.data());
    std::string hash = "RIHS01_";
    for (const std::uint8_t byte : digest) hash += fmt::format("{:02x}", byte);
    return hash;
}

std::string dds_type_name(std::string_view message) {
    const std::size_t first = message.find('/'), last = message.rfind('/');
    if (first == std::string_view::npos || first == last)
        throw std::runtime_error(fmt::format("'{}' is no message type; write package/msg/Name", message));
    return fmt::format("{}::{}::dds_::{}_", message.substr(0, first),
                       message.substr(first + 1, last - first - 1), message.substr(last + 1));
}

std::string user_data(std::string_view message) {
    return "typehash=" + type_hash(message) + ";";
}

std::optional<std::string> hash_in(std::string_view user_data) {
    constexpr std::string_view key = "typehash=";
    const std::size_t at = user_data.find(key);
    if (at == std::string_view::npos) return std::nullopt;
    const std::string_view rest = user_data.substr(at + key.size());
    return std::string(rest.substr(0, rest.find(';')));
}

}  // namespace knurl::dds

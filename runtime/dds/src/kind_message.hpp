#pragma once
// The messages of the representations as idlc's C structs, and from there to the parameters of a Kind.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <dds/dds.h>

#include <knurl/reps/kind.hpp>

namespace knurl::dds {

/// knurl_msgs/msg/<type>, of one kind. Offsets are in idlc's struct.
struct KindMessage {
    Kind kind = 0;
    std::string_view type;  // "Plane"
    const dds_topic_descriptor_t* descriptor = nullptr;
    std::size_t size = 0;
    std::size_t header = 0, id = 0, probe = 0;
    std::span<const std::size_t> fields;      // in the order of the kind's table
    std::span<const unsigned char> defaults;  // of the parameters
};

/// Of each kind but those that are made of a mesh. Written by generate/main.cpp.
std::span<const KindMessage> kind_messages();

/// The parameters that a message states, not checked but for what does not fit. ROS sends 0 for what nobody has set: of a
/// part of the material ("texture.wavelength") and of an orientation, 0 means the default where it can mean nothing else. Returns why they cannot be read, in one
/// line; empty: they were.
std::string read_params(const KindMessage& message, const void* sample, std::vector<std::byte>& params);

}  // namespace knurl::dds

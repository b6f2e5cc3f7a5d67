#pragma once
// Topics and frames. `<device>_base` is the device's own frame (x towards the user, y right, z up: REP 103 with the
// user in front), `<device>_hand` its tip.

#include <span>
#include <string>
#include <string_view>

#include <knurl/messages/schemas.hpp>

namespace knurl::messages {

enum class Channel {
    report,
    measured_cp,
    measured_cf,
    measured_cv,
    measured_js,
    joy,
    scene,
    parameters,
    tf,
    diagnostics,
};
inline constexpr std::size_t channel_count = 10;

struct ChannelInfo {
    Channel channel;
    std::string_view name;      // last part of the topic
    std::string_view encoding;  // "cdr", "json"
    const Schema& (*schema)();
    bool of_device;  // a topic for each device; else one for all
};

/// All channels, by their numbers.
std::span<const ChannelInfo> channels();

/// What a device is called in topics and frames: its name, where what ROS does not take ('.', '-') is '_'.
std::string ros_name(std::string_view device);
/// "/right/measured_cp", "/tf".
std::string topic(Channel channel, std::string_view device);
std::string base_frame(std::string_view device);
std::string hand_frame(std::string_view device);

}  // namespace knurl::messages

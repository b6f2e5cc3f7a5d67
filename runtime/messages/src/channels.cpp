#include <algorithm>
#include <array>

#include <knurl/messages/channels.hpp>

namespace knurl::messages {

std::span<const ChannelInfo> channels() {
    static constexpr std::array<ChannelInfo, channel_count> all{{
        {Channel::report, "report", "cdr", report_schema, true},
        {Channel::measured_cp, "measured_cp", "cdr", pose_schema, true},
        {Channel::measured_cf, "measured_cf", "cdr", wrench_schema, true},
        {Channel::measured_cv, "measured_cv", "cdr", twist_schema, true},
        {Channel::measured_js, "measured_js", "cdr", joints_schema, true},
        {Channel::joy, "joy", "cdr", joy_schema, true},
        {Channel::scene, "scene", "cdr", markers_schema, true},
        {Channel::parameters, "parameters", "json", parameters_schema, true},
        {Channel::tf, "tf", "cdr", transforms_schema, false},
        {Channel::diagnostics, "diagnostics", "cdr", diagnostics_schema, false},
    }};
    return all;
}

std::string ros_name(std::string_view device) {
    std::string name(device);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '.' || c == '-'; }, '_');
    return name;
}

std::string topic(Channel channel, std::string_view device) {
    const ChannelInfo& info = channels()[static_cast<std::size_t>(channel)];
    std::string text = "/";
    if (info.of_device) text += ros_name(device) + "/";
    return text += info.name;
}

std::string base_frame(std::string_view device) {
    return ros_name(device) + "_base";
}
std::string hand_frame(std::string_view device) {
    return ros_name(device) + "_hand";
}

}  // namespace knurl::messages

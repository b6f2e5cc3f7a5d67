#include <span>
#include <utility>

#include <knurl/messages/messages.hpp>
#include <knurl/recording/report_channels.hpp>

namespace knurl::recording {

namespace {

using messages::Channel;

// Pose, wrench, twist, joints, buttons and transform are in each report already. They are there for 3D views and
// plots by topic, which draw 60 times a second: at each cycle they would take more room than the reports do.
constexpr std::int64_t view_every = 10'000'000;  // ns

/// What a recording has of the channels that Foxglove is sent live.
bool recorded(Channel channel) {
    return channel != Channel::parameters && channel != Channel::diagnostics;
}

}  // namespace

ReportChannels::ReportChannels(McapWriter& file, const std::string& device, std::uint32_t joints,
                               const ReportChannels* sibling)
    : file_(file), device_(device), joints_(joints) {
    for (const messages::ChannelInfo& channel : messages::channels()) {
        if (!recorded(channel.channel)) continue;
        if (sibling != nullptr && !channel.of_device) {
            channels_[channel.channel] = sibling->number(channel.channel);
            continue;
        }
        const messages::Schema& schema = channel.schema();
        const McapSchema as_mcap{schema.name, schema.encoding, schema.text};
        channels_[channel.channel] = file_.add_channel(messages::topic(channel.channel, device),
                                                       std::string(channel.encoding), &as_mcap);
    }
}

void ReportChannels::write(const Report& report, std::int64_t time_ns) {
    const auto write = [&](Channel channel, const messages::Bytes& message) {
        file_.message(channels_.at(channel), time_ns, message, {});
    };
    write(Channel::report, messages::report_message(report));
    if (const std::int64_t view = time_ns / view_every; std::exchange(view_, view) == view) return;
    write(Channel::measured_cp, messages::pose_message(device_, time_ns, report));
    write(Channel::measured_cf, messages::wrench_message(device_, time_ns, report));
    write(Channel::measured_cv, messages::twist_message(device_, time_ns, report));
    if (joints_ > 0) write(Channel::measured_js, messages::joints_message(device_, time_ns, report, joints_));
    write(Channel::joy, messages::joy_message(device_, time_ns, report));
    const messages::HandTransform hand{.device = device_, .stamp_ns = time_ns, .report = &report};
    write(Channel::tf, messages::transforms_message(std::span(&hand, 1)));
}

}  // namespace knurl::recording

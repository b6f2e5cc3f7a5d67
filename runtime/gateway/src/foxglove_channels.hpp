#pragma once
// The channels that Foxglove's sockets are shown, and what is on them: made once a tick for all sockets.

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <knurl/gateway/foxglove.hpp>
#include <knurl/messages/channels.hpp>
#include <knurl/messages/messages.hpp>

#include "foxglove_scene.hpp"

namespace knurl::gateway {

/// A message, and when it was (ns of CLOCK_REALTIME).
struct FoxgloveMessage {
    std::int64_t ns = 0;
    messages::Bytes bytes;
};

/// A channel that is advertised. `sequence` counts its messages; a socket has the newest one if it has seen that.
struct FoxgloveChannel {
    messages::Channel channel{};
    std::size_t device = 0;
    std::string topic;
    std::size_t subscribers = 0;
    std::uint64_t sequence = 0;
    bool made_since = false;  // since somebody has subscribed
    std::uint64_t cycle = 0;  // of the newest report that was sent
    FoxgloveMessage newest;
    // Of reports: the newest ones, the last of which is number `sequence`.
    std::deque<FoxgloveMessage> reports;
    // Of parameters and diagnostics.
    std::uint64_t version = 0;
    std::optional<std::chrono::steady_clock::time_point> made;
};

struct FoxgloveSource::Impl {
    using Time = std::chrono::steady_clock::time_point;

    Impl(std::function<FoxgloveLook()> look, std::function<std::int64_t()> realtime_offset);

    /// Looks, once a tick.
    void tick(Time now);
    const FoxgloveLook& look() const { return now_; }
    /// The scene's changes for one subscription; none: nothing has changed.
    std::optional<FoxgloveMessage> changes(const FoxgloveChannel& channel, FoxgloveScene& scene) const;
    void subscribe(std::uint32_t channel) { ++channels.at(channel).subscribers; }
    void unsubscribe(std::uint32_t channel);

    std::map<std::uint32_t, FoxgloveChannel> channels;  // by number; numbers are not used again
    std::uint64_t version = 0;                          // of the list of channels
    std::string session;

  private:
    std::int64_t stamp(const SeenDevice& device) const;
    void find_channels();
    void open(messages::Channel channel, std::size_t device);
    void make(FoxgloveChannel& channel, Time now);
    void make(FoxgloveChannel& channel, const SeenDevice& device, Time now);
    void make_reports(FoxgloveChannel& channel, const SeenDevice& device);
    messages::Bytes encoded(messages::Channel channel, const SeenDevice& device, const Report& report) const;
    void make_transforms(FoxgloveChannel& channel);
    void make_diagnostics(FoxgloveChannel& channel, Time now);
    void make_parameters(FoxgloveChannel& channel, const SeenDevice& device, Time now);

    std::function<FoxgloveLook()> look_;
    std::function<std::int64_t()> realtime_offset_;
    std::int64_t offset_;
    std::optional<Time> ticked_;
    FoxgloveLook now_;
    std::vector<std::string> names_;
    std::uint64_t epoch_ = 0;
    std::uint32_t next_ = 1;
};

}  // namespace knurl::gateway

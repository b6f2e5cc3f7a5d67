#include "foxglove_channels.hpp"

#include <cstdlib>
#include <utility>

#include <fmt/format.h>
#include <time.h>

#include <knurl/json/json.hpp>
#include <knurl/messages/markers.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/reps/kind.hpp>
#include <knurl/view/text.hpp>

#include "params_json.hpp"

namespace knurl::gateway {

namespace {

using messages::Bytes;
using messages::Channel;
using Time = std::chrono::steady_clock::time_point;

constexpr auto diagnostics_every = std::chrono::seconds(1);
constexpr auto parameters_every = std::chrono::milliseconds(250);  // however often they change
constexpr std::size_t most_listed = 256;                           // items in the parameters
constexpr std::size_t most_reports = 1024;                         // for a peer that stood still for a while
constexpr std::int64_t millisecond = 1'000'000;                    // ns

std::int64_t clock_ns(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return t.tv_sec * std::int64_t{1'000'000'000} + t.tv_nsec;
}

Json vector(const Vec3& v) {
    return Json::array({number_json(v.x), number_json(v.y), number_json(v.z)});
}

Json parameters_of(const SeenDevice& device) {
    const protocol::DeviceInfo& info = device.info;
    Json about = Json::object();
    about["name"] = protocol::printable(info.name);
    about["servo"] = protocol::printable(info.servo);
    about["address"] = protocol::printable(info.address);
    about["profile"] = protocol::printable(info.profile);
    about["serial"] = protocol::printable(info.serial);
    about["joints"] = info.joints;
    about["renders_torque"] = info.renders_torque != 0;
    about["senses_orientation"] = info.senses_orientation != 0;
    about["rate"] = number_json(info.rate);
    about["workspace_centre"] = vector(info.workspace_centre);
    about["workspace_radius"] = number_json(info.workspace_radius);
    about["peak_force"] = number_json(info.peak_force);
    about["peak_torque"] = number_json(info.peak_torque);
    about["max_stiffness"] = number_json(info.max_stiffness);
    about["damping"] = number_json(info.damping);
    about["lag"] = number_json(info.lag);
    Json items = Json::array();
    std::size_t left_out = 0;
    for (const auto& [claim, scene] : device.claims)
        for (const auto& [slot, item] : scene.items) {
            if (item.kind >= kinds().size() || item.params.size() != kinds()[item.kind].size ||
                items.size() >= most_listed) {
                ++left_out;
                continue;
            }
            Json one = Json::object();
            one["claim"] = claim;
            one["slot"] = slot;
            one["kind"] = kinds()[item.kind].name;
            one["probe"] = item.options.probe;
            one["params"] = params_json(item.kind, item.params);
            items.push_back(std::move(one));
        }
    Json all = Json::object();
    all["device"] = std::move(about);
    all["items"] = std::move(items);
    all["left_out"] = left_out;
    return all;
}

Bytes bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// State, rates and counters of a device.
messages::Diagnostic diagnostic_of(const SeenDevice& device) {
    const view::DeviceRates& rates = device.rates;
    messages::Diagnostic one;
    one.name = "knurl: " + protocol::printable(device.info.name);
    one.hardware_id = protocol::printable(device.info.serial);
    if (one.hardware_id.empty()) one.hardware_id = protocol::printable(device.info.address);
    using Level = messages::Diagnostic::Level;
    if (!device.newest) {
        one.level = Level::stale;
        one.message = "no report";
    } else {
        one.message = view::state_name(device.newest->state);
        if (device.newest->state == DeviceState::fault) {
            one.level = Level::error;
            one.message += ": " + view::fault_names(device.newest->faults);
        } else if (device.newest->state == DeviceState::disconnected) {
            one.level = Level::error;
        } else if (rates.late > 0 || rates.overruns > 0) {
            one.level = Level::warn;
            one.message += fmt::format("; {} cycles late", rates.late);
        }
    }
    const auto value = [&one](std::string key, std::string text) {
        one.values.emplace_back(std::move(key), std::move(text));
    };
    value("rate (Hz)", fmt::format("{:.1f}", rates.rate));
    value("late", std::to_string(rates.late));
    value("overruns", std::to_string(rates.overruns));
    value("busy", fmt::format("{:.3f}", rates.busy));
    value("step (us)", fmt::format("{:.1f}", rates.step));
    if (rates.parts)
        for (std::size_t i = 0; i < rates.parts->size(); ++i)
            value(fmt::format("{} (us)", view::cycle_parts[i]), fmt::format("{:.2f}", (*rates.parts)[i]));
    if (rates.late_median) value("lateness, median (us)", fmt::format("{:.1f}", *rates.late_median));
    if (rates.late_max) value("lateness, largest (us)", fmt::format("{:.1f}", *rates.late_max));
    for (const auto& [name, count] : rates.device.counters) value(name, std::to_string(count));
    for (const view::ClientRates& client : rates.clients)
        value(fmt::format("client {}", client.client.row),
              fmt::format("{} (pid {}){}, {:.1f} updates/s, {} merged, {} refused, {} missed",
                          protocol::printable(client.client.name), client.client.pid,
                          client.client.observer ? " observes" : "", client.updates, client.merged,
                          client.refused, client.missed));
    return one;
}

std::string name(const SeenDevice& device) {
    return protocol::printable(device.info.name);
}

void step(FoxgloveChannel& channel) {
    ++channel.sequence;
    channel.made_since = true;
}

}  // namespace

std::int64_t FoxgloveSource::system_offset() {
    return clock_ns(CLOCK_REALTIME) - clock_ns(CLOCK_MONOTONIC);
}

FoxgloveSource::Impl::Impl(std::function<FoxgloveLook()> look, std::function<std::int64_t()> realtime_offset)
    : look_(std::move(look)), realtime_offset_(std::move(realtime_offset)), offset_(realtime_offset_()) {
    session = std::to_string(clock_ns(CLOCK_REALTIME));
}

void FoxgloveSource::Impl::tick(Time now) {
    if (ticked_ && now == *ticked_) return;
    ticked_ = now;
    now_ = look_();
    // A clock that is slewed gives another offset each time: adopting each would shake the stamps.
    if (const std::int64_t offset = realtime_offset_(); std::abs(offset - offset_) > millisecond)
        offset_ = offset;
    find_channels();
    for (auto& [id, channel] : channels)
        if (channel.subscribers > 0) make(channel, now);
}

std::optional<FoxgloveMessage> FoxgloveSource::Impl::changes(const FoxgloveChannel& channel,
                                                             FoxgloveScene& scene) const {
    const SeenDevice& device = now_.devices[channel.device];
    const std::vector<messages::Marker> markers = scene.changes(device, *ticked_);
    if (markers.empty()) return std::nullopt;
    return FoxgloveMessage{
        stamp(device), messages::markers_message(messages::base_frame(name(device)), stamp(device), markers)};
}

void FoxgloveSource::Impl::unsubscribe(std::uint32_t channel) {
    const auto found = channels.find(channel);
    if (found == channels.end() || --found->second.subscribers > 0) return;
    found->second.reports.clear();
    found->second.made.reset();
    found->second.made_since = false;  // what it holds grows old
}

std::int64_t FoxgloveSource::Impl::stamp(const SeenDevice& device) const {
    return device.newest ? device.newest->read_ns + offset_ : clock_ns(CLOCK_MONOTONIC) + offset_;
}

void FoxgloveSource::Impl::find_channels() {
    std::vector<std::string> names;
    if (now_.connected)
        for (const SeenDevice& device : now_.devices) names.push_back(name(device));
    if (version > 0 && names == names_ && (names.empty() || now_.epoch == epoch_)) return;
    names_ = std::move(names);
    epoch_ = now_.epoch;
    ++version;
    // Those of all devices stay.
    std::erase_if(channels, [](const auto& one) {
        return messages::channels()[static_cast<std::size_t>(one.second.channel)].of_device;
    });
    for (const messages::ChannelInfo& info : messages::channels())
        if (info.of_device)
            for (std::size_t i = 0; i < names_.size(); ++i) open(info.channel, i);
        else if (version == 1)
            open(info.channel, 0);
}

void FoxgloveSource::Impl::open(Channel channel, std::size_t device) {
    FoxgloveChannel& one = channels[next_++];
    one.channel = channel;
    one.device = device;
    one.topic = messages::topic(channel, device < names_.size() ? names_[device] : "");
}

void FoxgloveSource::Impl::make(FoxgloveChannel& channel, Time now) {
    switch (channel.channel) {
        case Channel::tf:
            return make_transforms(channel);
        case Channel::diagnostics:
            return make_diagnostics(channel, now);
        default:
            return make(channel, now_.devices[channel.device], now);
    }
}

void FoxgloveSource::Impl::make(FoxgloveChannel& channel, const SeenDevice& device, Time now) {
    if (channel.channel == Channel::report) return make_reports(channel, device);
    if (channel.channel == Channel::scene) return;  // each subscription has changes of its own
    if (channel.channel == Channel::parameters) return make_parameters(channel, device, now);
    if (!device.newest || (channel.made_since && device.newest->cycle == channel.cycle)) return;
    const Report& report = *device.newest;
    channel.cycle = report.cycle;
    channel.newest = {stamp(device), encoded(channel.channel, device, report)};
    step(channel);
}

void FoxgloveSource::Impl::make_reports(FoxgloveChannel& channel, const SeenDevice& device) {
    for (const Report& report : device.fresh) {
        channel.reports.push_back({report.read_ns + offset_, messages::report_message(report)});
        if (channel.reports.size() > most_reports) channel.reports.pop_front();
        step(channel);
    }
}

Bytes FoxgloveSource::Impl::encoded(Channel channel, const SeenDevice& device, const Report& report) const {
    const std::string called = name(device);
    const std::int64_t at = stamp(device);
    switch (channel) {
        case Channel::measured_cf:
            return messages::wrench_message(called, at, report);
        case Channel::measured_cv:
            return messages::twist_message(called, at, report);
        case Channel::measured_js:
            return messages::joints_message(called, at, report, device.info.joints);
        case Channel::joy:
            return messages::joy_message(called, at, report);
        default:
            return messages::pose_message(called, at, report);
    }
}

void FoxgloveSource::Impl::make_transforms(FoxgloveChannel& channel) {
    std::vector<std::string> names;
    std::vector<messages::HandTransform> all;
    std::uint64_t cycles = 0;
    if (now_.connected)
        for (const SeenDevice& device : now_.devices) {
            if (!device.newest) continue;
            cycles += device.newest->cycle;
            names.push_back(name(device));
            all.push_back({.device = {}, .stamp_ns = stamp(device), .report = &*device.newest});
        }
    if (all.empty() || (channel.made_since && cycles == channel.cycle)) return;
    std::int64_t newest = all.front().stamp_ns;
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i].device = names[i];
        newest = std::max(newest, all[i].stamp_ns);
    }
    channel.cycle = cycles;
    channel.newest = {newest, messages::transforms_message(all)};
    step(channel);
}

void FoxgloveSource::Impl::make_diagnostics(FoxgloveChannel& channel, Time now) {
    if (channel.made && now - *channel.made < diagnostics_every) return;
    channel.made = now;
    const std::int64_t at = clock_ns(CLOCK_MONOTONIC) + offset_;
    std::vector<messages::Diagnostic> all;
    if (now_.connected)
        for (const SeenDevice& device : now_.devices) all.push_back(diagnostic_of(device));
    else
        all.push_back({.level = messages::Diagnostic::error,
                       .name = "knurl: " + protocol::printable(now_.name),
                       .message = now_.trouble,
                       .hardware_id = {},
                       .values = {}});
    channel.newest = {at, messages::diagnostics_message(at, all)};
    step(channel);
}

void FoxgloveSource::Impl::make_parameters(FoxgloveChannel& channel, const SeenDevice& device, Time now) {
    if (channel.made && (channel.version == device.scene_version || now - *channel.made < parameters_every))
        return;
    channel.made = now;
    channel.version = device.scene_version;
    channel.newest = {stamp(device), bytes_of(parameters_of(device).dump())};
    step(channel);
}

}  // namespace knurl::gateway

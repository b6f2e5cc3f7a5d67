#include "pulse.hpp"

namespace knurl::bridge {

namespace {
constexpr std::chrono::milliseconds answer_time{500};
}

bool Pulse::open() {
    if (link_) return false;
    auto link = detail::connect_local(servo_, "knurl-bridge", answer_time);
    protocol::ClaimRequest request;
    request.observe = 1;
    std::vector<Device> devices;
    for (std::uint32_t i = 0; i < link->devices().size(); ++i)
        devices.push_back({.attachment = link->attach(i, request), .streams = 0});
    link_ = std::move(link);
    devices_ = std::move(devices);
    return true;
}

void Pulse::join(std::size_t device) noexcept {
    if (device >= devices_.size() || devices_[device].streams++ > 0) return;
    Report report;  // those of the time when nobody listened
    devices_[device].attachment.reports->latest(report);
    rearm(device);
}

void Pulse::leave(std::size_t device) noexcept {
    if (device < devices_.size() && devices_[device].streams > 0) --devices_[device].streams;
}

bool Pulse::next(std::size_t device, Report& report) noexcept {
    return devices_[device].attachment.reports->next(report);
}

void Pulse::rearm(std::size_t device) noexcept {
    if (devices_[device].streams > 0) devices_[device].attachment.reports->rearm();
}

bool Pulse::newest(std::size_t device, Report& report) const noexcept {
    return device < devices_.size() && devices_[device].attachment.reports->newest(report);
}

}  // namespace knurl::bridge

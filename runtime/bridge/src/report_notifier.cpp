#include "report_notifier.hpp"

namespace knurl::bridge {

bool ReportNotifier::open() {
    if (link_) return false;
    auto link = detail::connect_local(servo_, "knurl-bridge", servo_answer_time);
    protocol::ClaimRequest request;
    request.observe = 1;
    std::vector<Device> devices;
    for (std::uint32_t i = 0; i < link->devices().size(); ++i)
        devices.push_back({.attachment = link->attach(i, request)});
    link_ = std::move(link);
    devices_ = std::move(devices);
    return true;
}

void ReportNotifier::join(std::size_t device) noexcept {
    if (device >= devices_.size() || devices_[device].streams++ > 0) return;
    // Reports from the time without a stream belong to nobody.
    if (Report report; devices_[device].attachment.reports->latest(report)) {
        devices_[device].last = report;
        devices_[device].any = true;
    }
    rearm(device);
}

void ReportNotifier::leave(std::size_t device) noexcept {
    if (device < devices_.size() && devices_[device].streams > 0) --devices_[device].streams;
}

bool ReportNotifier::next(std::size_t device, Report& report, std::uint64_t& unseen) noexcept {
    Device& from = devices_[device];
    detail::ReportSource& reports = *from.attachment.reports;
    const std::uint64_t before = reports.missed();
    if (!reports.next(report)) return false;
    unseen = reports.missed() - before;
    from.last = report;
    from.any = true;
    return true;
}

void ReportNotifier::rearm(std::size_t device) noexcept {
    if (devices_[device].streams > 0) devices_[device].attachment.reports->rearm();
}

const Report* ReportNotifier::last(std::size_t device) const noexcept {
    return device < devices_.size() && devices_[device].any ? &devices_[device].last : nullptr;
}

}  // namespace knurl::bridge

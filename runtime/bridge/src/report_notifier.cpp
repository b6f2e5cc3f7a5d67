#include "report_notifier.hpp"

namespace knurl::bridge {

ReportNotifier::Observers ReportNotifier::attach(const std::string& servo) {
    Observers made{.link = detail::connect_local(servo, "knurl-bridge", servo_answer_time), .devices = {}};
    protocol::ClaimRequest request;
    request.observe = 1;
    for (std::uint32_t i = 0; i < made.link->devices().size(); ++i)
        made.devices.push_back(made.link->attach(i, request));
    return made;
}

void ReportNotifier::open(Observers observers) {
    devices_.clear();
    for (detail::Attachment& attachment : observers.devices)
        devices_.push_back({.attachment = std::move(attachment)});
    link_ = std::move(observers.link);
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

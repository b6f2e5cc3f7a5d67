#include "feel.hpp"

#include <chrono>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/measure/progress.hpp>

namespace feel {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto patience = 10s;  // for a slow hand, and for an active device

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

void wait_until_slow(knurl::Claim& hand, const std::atomic<bool>& stop) {
    const auto begin = Clock::now();
    for (int slow = 0; slow < 100 && !stop;) {
        const auto report = hand.next_report(100ms);
        hand.commit();
        if (Clock::now() - begin > patience)
            throw std::runtime_error(
                "the hand does not come to rest, so the device is not armed; hold it still");
        if (report) slow = knurl::to_eigen(report->velocity).norm() < 0.1 ? slow + 1 : 0;
    }
}

/// The radius (m) of the device's world in which the whole thing fits; 0: the device's own is large enough.
double radius_to_fit(knurl::Client& client, double size, const FeelOptions& options) {
    double radius = 0;
    for (const auto& device : client.devices())
        if ((options.device.empty() || options.device == device.name) &&
            size / 2 > 0.9 * device.workspace_radius)
            radius = size / 2 / 0.9;
    return radius;
}

/// None: stopped before the servo answered.
std::optional<knurl::SentShape> send(knurl::Claim& hand, const knurl::meshfile::MeshFile& file,
                                     const knurl::SendOptions& options, const std::atomic<bool>& stop) {
    const auto begin = Clock::now();
    knurl::Sending sending = hand.begin_sending(file.triangles_of(), options);
    std::optional<knurl::SentShape> sent;
    knurl::measure::Progress progress("knurl-feel");
    while (!stop && !(sent = sending.done(50ms))) {
        hand.commit();
        progress.show(fmt::format("the servo builds the shape of {} triangles, {:.0f} s",
                                  file.triangles.size(), seconds_since(begin)));
    }
    progress.clear();
    return sent;
}

/// Records the cycles of the armed device until it faults, or the time is over.
void record(knurl::Claim& hand, const FeelOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told, FeelResult& result) {
    const auto armed = Clock::now();
    double told_at = 0;
    std::int64_t first = 0;
    while (!stop) {
        const auto report = hand.next_report(50ms);
        if (!report) {
            hand.commit();
            if (!hand.connected()) throw std::runtime_error("the servo has gone; start it again");
            continue;
        }
        result.faults = report->faults;
        if (report->faults != 0) return;
        if (report->state != knurl::DeviceState::active) {
            if (first == 0 && Clock::now() - armed > patience)
                throw std::runtime_error(
                    "the device did not become active; look at `knurl devices` and the servo's log");
            hand.commit();
            continue;
        }
        if (first == 0) first = report->deadline_ns;
        const double t = static_cast<double>(report->deadline_ns - first) * 1e-9;
        result.cycles.push_back({.number = report->cycle,
                                 .t = t,
                                 .position = knurl::to_eigen(report->position) - result.position,
                                 .force = knurl::to_eigen(report->scene_force)});
        if (result.cycles.size() % 20 == 0) hand.commit();
        if (t >= told_at + 1) {
            told_at = t;
            told(fmt::format("{:5.0f} s  {:.2f} N", t, knurl::to_eigen(report->scene_force).norm()));
        }
        if (options.seconds > 0 && t >= options.seconds) return;
    }
}

}  // namespace

FeelResult feel(knurl::Client& client, const knurl::meshfile::MeshFile& file, const FeelOptions& options,
                const std::atomic<bool>& stop, const std::function<void(const std::string&)>& told) {
    knurl::ClaimOptions claim{.update_interval = 20ms};
    // The size of the thing, and of the device's world around it, is known before it is sent.
    if (options.fit)
        claim.workspace_radius = radius_to_fit(client, options.send.scale * file.size(), options);
    knurl::Claim hand = client.claim(options.device, claim);
    FeelResult result;
    if (claim.workspace_radius > 0) result.scale = claim.workspace_radius / hand.device().workspace_radius;

    const auto begin = Clock::now();
    const std::optional<knurl::SentShape> sent = send(hand, file, options.send, stop);
    if (!sent) return result;
    result.sent = *sent;
    result.send_seconds = seconds_since(begin);

    const Eigen::Vector3d centre = claim.workspace_radius > 0
                                       ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                       : knurl::to_eigen(hand.device().workspace_centre);
    result.position = centre - (knurl::to_eigen(sent->low) + knurl::to_eigen(sent->high)) / 2;
    knurl::Shape params = options.shape;
    params.asset = sent->asset;
    params.position = knurl::to_plain(result.position);
    const auto shape = hand.add(params);
    if (options.radius > 0) hand.place_probe(0, {.offset = {}, .radius = options.radius});
    wait_until_slow(hand, stop);
    hand.arm();
    record(hand, options, stop, told, result);
    result.stiffness = shape.applied_stiffness().value_or(0);
    result.unread = hand.missed();
    hand.release();
    return result;
}

}  // namespace feel

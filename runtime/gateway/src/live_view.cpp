#include <algorithm>
#include <stdexcept>
#include <vector>

#include <knurl/gateway/live_view.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/view/arm.hpp>

#include "scene_watch.hpp"

namespace knurl::gateway {

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto connect_every = std::chrono::seconds(1);
constexpr std::chrono::milliseconds answer_time{200};  // of a servo that is there; the gateway waits so long
constexpr auto rates_every = std::chrono::milliseconds(250);

/// One line through all joints: out along the first leg, back along the second, out along the third.
std::vector<Vec3> one_line(const view::Lines& lines) {
    std::vector<Vec3> points;
    bool back = false;
    for (const auto& line : lines) {
        std::vector<Vec3> part;
        for (const Eigen::Vector3d& point : line) part.push_back(to_plain(point));
        if (back) std::reverse(part.begin(), part.end());
        points.insert(points.end(), part.begin(), part.end());
        back = !back;
    }
    return points;
}

}  // namespace

struct LiveView::Impl {
    std::string said;  // as the user named it
    std::string name, trouble = "not connected yet";
    pid_t pid = 0;
    std::uint64_t epoch = 0;
    bool connected = false;
    std::optional<Clock::time_point> tried;
    Clock::time_point rated;
    std::optional<view::ServoWatch> servo;
    view::ServoView before;
    std::vector<std::unique_ptr<SceneWatch>> scenes;
    std::vector<view::Arm> arms;
    std::vector<SeenDevice> devices;
    // Reports since the last rates, thinned out for the lateness.
    std::vector<std::vector<Report>> seen;

    void connect(Clock::time_point now);
    void disconnect(const std::string& why);
    void look_at_rates(Clock::time_point now);
    void look_at_reports();
};

void LiveView::Impl::connect(Clock::time_point now) {
    if (tried && now - *tried < connect_every) return;
    tried = now;
    try {
        const protocol::ServoAddress address = protocol::servo_address(said);
        name = address.name;
        servo.emplace(address.socket, answer_time);
        before = servo->look();
        scenes.clear();
        arms.clear();
        devices.clear();
        for (std::uint32_t i = 0; i < before.devices.size(); ++i) {
            scenes.push_back(std::make_unique<SceneWatch>(address, i, answer_time));
            SeenDevice& device = devices.emplace_back();
            device.info = before.devices[i].info;
            device.rates.device = before.devices[i];
            arms.push_back(view::Arm::of_address(protocol::text_of(device.info.address)));
        }
        seen.assign(devices.size(), {});
        servo->new_reports();
        pid = before.pid;
        rated = now;
        connected = true;
        trouble.clear();
        ++epoch;
    } catch (const std::exception& error) {
        servo.reset();
        trouble = error.what();
    }
}

void LiveView::Impl::disconnect(const std::string& why) {
    connected = false;
    trouble = why;
    pid = 0;
    servo.reset();
    scenes.clear();
    tried.reset();
    for (SeenDevice& device : devices) device.fresh.clear();
}

void LiveView::Impl::look_at_reports() {
    constexpr std::size_t most_seen = 2000;
    std::vector<std::vector<Report>> fresh = servo->new_reports();
    for (std::size_t i = 0; i < devices.size(); ++i) {
        SeenDevice& device = devices[i];
        device.fresh = std::move(fresh[i]);
        if (device.fresh.empty()) continue;
        const Report& first = device.fresh.front();
        if (device.newest && first.cycle > device.newest->cycle + 1)
            device.missed += first.cycle - device.newest->cycle - 1;
        device.newest = device.fresh.back();
        device.arm = one_line(arms[i].lines(device.newest->joints, to_eigen(device.newest->position)));
        if (seen[i].size() < most_seen)
            seen[i].insert(seen[i].end(), device.fresh.begin(), device.fresh.end());
    }
}

void LiveView::Impl::look_at_rates(Clock::time_point now) {
    if (now - rated < rates_every) return;
    view::ServoView look = servo->look();
    const double seconds = std::chrono::duration<double>(now - rated).count();
    for (std::size_t i = 0; i < devices.size(); ++i) {
        view::DeviceRates rates =
            view::rates_between(before.devices[i], look.devices[i], seconds, std::exchange(seen[i], {}));
        view::keep_parts(devices[i].rates, rates);
        devices[i].rates = std::move(rates);
    }
    before = std::move(look);
    rated = now;
}

LiveView::LiveView(std::string servo) : impl_(std::make_unique<Impl>()) {
    impl_->said = std::move(servo);
    impl_->name = impl_->said;
}
LiveView::~LiveView() = default;

void LiveView::tick(Clock::time_point now) {
    Impl& live = *impl_;
    if (!live.connected) live.connect(now);
    if (!live.connected) return;
    for (std::size_t i = 0; i < live.devices.size(); ++i) {
        if (live.scenes[i]->look(live.devices[i])) continue;
        return live.disconnect("the servo has ended; waiting for one of that name");
    }
    live.look_at_reports();
    live.look_at_rates(now);
}

bool LiveView::connected() const {
    return impl_->connected;
}
const std::string& LiveView::trouble() const {
    return impl_->trouble;
}
const std::string& LiveView::name() const {
    return impl_->name;
}
pid_t LiveView::pid() const {
    return impl_->pid;
}
std::uint64_t LiveView::epoch() const {
    return impl_->epoch;
}
std::span<const SeenDevice> LiveView::devices() const {
    return impl_->devices;
}

}  // namespace knurl::gateway

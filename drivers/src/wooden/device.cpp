#include "wooden/device.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <knurl/drivers/arm_file.hpp>

#include "usb/address.hpp"
#include "usb/io_thread.hpp"
#include "wooden/protocol.hpp"

namespace knurl::drivers::wooden {

namespace {

// Every Teensy with the RawHID sketch has this id.
constexpr UsbId ids[] = {{0x16c0, 0x0486}};

/// A count has 16 bits, which span two turns of the arm or more. So the wrap nearest to the count at opening
/// is taken. The wrap nearest to the last reading could be permanently wrong after two noisy reports.
std::int32_t unwrapped(std::int32_t raw, std::int32_t at_first) {
    return at_first + static_cast<std::int16_t>(static_cast<std::uint16_t>(raw - at_first));
}

class WoodenHaptics final : public Device {
  public:
    /// `home`: rad, the axes' angles at this moment; none: they follow from the controller's counters.
    WoodenHaptics(usb::Wanted wanted, const ArmFile& arm,
                  const std::optional<std::array<double, motors>>& home, double damping, double lag,
                  int priority)
        : io_(std::move(wanted), std::make_unique<Protocol>(), priority),
          mechanism_(arm.table),
          link_(link_of(arm)) {
        link_.name = "wooden";
        link_.serial = io_.info().serial;
        std::ostringstream text;
        text << arm.description
             << (io_.info().port.empty() ? " that is waited for" : " in port " + io_.info().port) << "; "
             << arm.source << "; damping and lag not measured by us";
        link_.description = text.str();
        link_.damping = damping;
        link_.lag = lag;
        link_.continuous_force = link_.continuous_force > 0 ? link_.continuous_force : link_.peak_force / 2;
        for (std::size_t i = 0; i < motors; ++i)
            effort_per_milliampere_[i] = arm.axes[i].effort_per_count.value_or(0);
        stated_home_ = home;
        reading_ = io_.first();
        if (reading_.session != 0) begin();
    }

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }
    bool has_buttons() const noexcept override { return false; }

    ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        const ReadStatus status = io_.take(reading_);
        if (status == ReadStatus::ok && first_session_ == 0) begin();
        for (std::size_t i = 0; i < motors; ++i) {
            const std::int32_t counts = unwrapped(reading_.counts[i], first_counts_[i]);
            sample.position[i] = home_[i] + link_.radians_per_count[i] * counts;
        }
        sample.has_velocity = false;
        // The counters restart at power-up, wherever the arm is then.
        sample.calibrated = reading_.session == first_session_ && status != ReadStatus::unplugged;
        calibrated_ = sample.calibrated;
        return status;
    }

    bool write(Nanoseconds, const JointEfforts& efforts) noexcept override {
        std::array<double, motors> wanted{};
        double share = 1;  // common to all motors, so that the force at the tip keeps its direction
        for (std::size_t i = 0; i < motors; ++i) {
            wanted[i] = std::isfinite(efforts[i]) && calibrated_ ? efforts[i] : 0;
            const double size = std::abs(wanted[i]);
            if (size > link_.effort_limit[i]) share = std::min(share, link_.effort_limit[i] / size);
        }
        usb::Orders orders;
        for (std::size_t i = 0; i < motors; ++i)
            orders.efforts[i] =
                static_cast<std::int16_t>(std::lround(wanted[i] * share / effort_per_milliampere_[i]));
        return io_.send(orders);
    }

    void make_safe() noexcept override { io_.make_safe(); }

  private:
    /// The first reading: here the counters begin, and here the axes stand as `home` says.
    void begin() noexcept {
        for (std::size_t i = 0; i < motors; ++i) {
            first_counts_[i] = reading_.counts[i];
            if (stated_home_)
                home_[i] =
                    (*stated_home_)[i] - link_.radians_per_count[i] * static_cast<double>(first_counts_[i]);
        }
        first_session_ = reading_.session;
    }

    usb::IoThread io_;
    SerialChain mechanism_;
    LinkConfig link_;
    usb::Reading reading_;
    std::optional<std::array<double, motors>> stated_home_;  // rad
    std::array<std::int32_t, motors> first_counts_ = {};
    std::array<double, motors> home_ = {};                    // rad
    std::array<double, motors> effort_per_milliampere_ = {};  // N m
    std::uint64_t first_session_ = 0;
    bool calibrated_ = false;
};

/// "0:32.6:45.2", degrees.
std::array<double, motors> degrees(const std::string& text) {
    std::array<double, motors> angles{};
    const char* at = text.data();
    const char* const last = at + text.size();
    for (std::size_t i = 0; i < motors; ++i) {
        const auto [end, error] = std::from_chars(at, last, angles[i]);
        const bool right = error == std::errc() && std::abs(angles[i]) <= 360 &&
                           (i + 1 < motors ? end != last && *end == ':' : end == last);
        if (!right)
            throw std::runtime_error("wooden: cannot use home=" + text +
                                     "; give the three axes' angles now in degrees, like home=0:32.6:45.2");
        angles[i] *= M_PI / 180;
        at = end + 1;
    }
    return angles;
}

std::unique_ptr<Device> open(std::string_view what, const OpenOptions& options) {
    usb::Address address(
        {.scheme = "wooden", .kind = "WoodenHaptics", .ids = {std::begin(ids), std::end(ids)}}, what);
    const std::string arm_name = address.text("arm");
    const std::string home = address.text("home");
    const double damping = address.number("damping", 0.2, 0.01, 20, "N s/m");
    const double lag = address.number("lag", 2e-3, 0, 0.05, "s");
    address.done();
    const ArmFile arm = find_arm(arm_name.empty() ? "woodenhaptics" : arm_name);
    if (arm.joints() != motors || arm.actuated() != motors)
        throw std::runtime_error("wooden: the arm \"" + arm.name + "\" (" + arm.path +
                                 ") has not three driven axes, as the controller does");
    for (const ArmAxis& axis : arm.axes)
        if (!axis.radians_per_count || !axis.effort_limit || !axis.effort_per_count)
            throw std::runtime_error("wooden: " + arm.path +
                                     " does not say counts_per_turn, effort_limit and "
                                     "effort_per_count (N m per mA) of axis \"" +
                                     axis.name + "\"");
    for (const ArmAxis& axis : arm.axes)
        if (!(*axis.effort_limit / *axis.effort_per_count <= most_milliamperes))
            throw std::runtime_error("wooden: " + arm.path + ": effort_limit of axis \"" + axis.name +
                                     "\" is more than the 32767 mA that fit into a report; check its "
                                     "effort_per_count (N m per mA)");
    std::optional<std::array<double, motors>> at;
    if (!home.empty()) at = degrees(home);
    if (options.check_only) return nullptr;
    return std::make_unique<WoodenHaptics>(address.wanted(), arm, at, damping, lag, options.io_priority);
}

}  // namespace

Driver driver() {
    return {.scheme = "wooden",
            .help = "[SERIAL][?wait][,home=A:B:C][,arm=FILE][,damping=NS_PER_M][,lag=S][,port=PORT]",
            .open = open,
            .usb = {std::begin(ids), std::end(ids)}};
}

}  // namespace knurl::drivers::wooden

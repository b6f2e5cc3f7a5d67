#include "falcon/device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include <knurl/drivers/delta.hpp>

#include "falcon/protocol.hpp"
#include "usb/address.hpp"
#include "usb/io_thread.hpp"

namespace knurl::drivers::falcon {

namespace {

constexpr UsbId ids[] = {{0x0403, 0xcb48}};

constexpr std::size_t legs = 3;

struct Settings {
    double counts_per_effort = 10'000;  // counts per N m of a leg
    double low_pass = 300;              // Hz, of the efforts; 0: none
    double peak_force = 8;              // N
    double damping = 0.5;               // N s/m
    double lag = 3e-3;                  // s, without the low-pass
    double max_stiffness = 0;           // N/m as measured; 0: estimated from damping and lag
    double mass = 0;                    // kg at the tip; 0: unknown
    bool event_character = false;
    std::optional<Firmware> firmware;
};

/// The delay of a first-order low-pass with this corner frequency.
double filter_lag(double corner) {
    return corner > 0 ? 1 / (2 * std::numbers::pi * corner) : 0;
}

LinkConfig describe(const Settings& settings, const UsbDevice& usb) {
    std::ostringstream text;
    text << "Novint Falcon " << (usb.port.empty() ? "that is waited for" : "in port " + usb.port)
         << ", force not calibrated (" << settings.counts_per_effort
         << " counts per N m), damping and lag not measured by us";
    if (settings.firmware) {
        const std::string known = settings.firmware->known_as();
        text << ", firmware sha256 " << settings.firmware->sha256
             << (known.empty() ? "" : " (" + known + ")");
    } else {
        text << ", firmware as it runs";
    }
    LinkConfig link;
    link.name = "falcon";
    link.serial = usb.serial;
    link.description = text.str();
    link.sensed_joints = link.actuated_joints = static_cast<int>(legs);
    link.radians_per_count.assign(legs, falcon_radians_per_count);
    link.effort_limit.assign(legs, most_counts / settings.counts_per_effort);
    link.workspace_radius = 0.04;
    link.peak_force = settings.peak_force;
    link.continuous_force = settings.peak_force / 2;
    link.damping = settings.damping;
    link.lag = settings.lag + filter_lag(settings.low_pass);
    link.measured_max_stiffness = settings.max_stiffness;
    link.apparent_mass = settings.mass;
    return link;
}

class Falcon final : public Device {
  public:
    Falcon(usb::Wanted wanted, Settings settings, int priority)
        : settings_(std::move(settings)),
          io_(std::move(wanted), std::make_unique<Protocol>(settings_.firmware, settings_.event_character),
              priority),
          mechanism_(falcon_in_device_frame()),
          link_(describe(settings_, io_.info())) {}

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }

    ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        const ReadStatus status = io_.take(reading_);
        homed_ = reading_.calibrated && status != ReadStatus::unplugged;
        for (std::size_t i = 0; i < legs; ++i)
            sample.position[i] = falcon_zero + falcon_radians_per_count * reading_.counts[i];
        sample.has_velocity = false;
        sample.calibrated = homed_;
        sample.buttons = reading_.buttons;
        return status;
    }

    bool write(Nanoseconds now, const JointEfforts& efforts) noexcept override {
        std::array<double, legs> wanted{};
        double largest = 0;
        for (std::size_t i = 0; i < legs; ++i) {
            wanted[i] = std::isfinite(efforts[i]) ? efforts[i] : 0;
            largest = std::max(largest, std::abs(wanted[i]));
        }
        // All together, so that the force at the tip keeps its direction. Before the low-pass, which would
        // otherwise still push while it forgets what the motors could not give.
        const double most = most_counts / settings_.counts_per_effort;
        const double scale = largest > most ? most / largest : 1;
        const double dt = std::clamp(static_cast<double>(now - last_write_) * 1e-9, 0.0, longest_step);
        last_write_ = now;
        const double share = settings_.low_pass > 0 && homed_ && largest > 0
                                 ? 1 - std::exp(-2 * std::numbers::pi * settings_.low_pass * dt)
                                 : 1;  // a zero is never delayed
        usb::Orders orders;
        for (std::size_t i = 0; i < legs; ++i) {  // a positive count turns a leg towards smaller angles
            smooth_[i] += share * (wanted[i] * scale - smooth_[i]);
            orders.efforts[i] =
                static_cast<std::int16_t>(-std::lround(settings_.counts_per_effort * smooth_[i]));
        }
        orders.flags = !homed_ ? info_red : enabled_ ? info_green : info_blue;
        return io_.send(orders);
    }

    void notify(Notice notice) noexcept override {
        if (notice == Notice::enabled) enabled_ = true;
        if (notice == Notice::disabled) enabled_ = false;
    }

    void make_safe() noexcept override {
        smooth_ = {};
        io_.make_safe();
    }

  private:
    static constexpr double longest_step = 10e-3;  // s

    Settings settings_;
    usb::IoThread io_;
    Delta mechanism_;
    LinkConfig link_;
    usb::Reading reading_;
    std::array<double, legs> smooth_ = {};  // N m
    Nanoseconds last_write_ = 0;
    bool homed_ = false, enabled_ = false;
};

std::unique_ptr<Device> open(std::string_view what, const OpenOptions& options) {
    usb::Address address(
        {.scheme = "falcon", .kind = "Novint Falcon", .ids = {std::begin(ids), std::end(ids)}}, what);
    Settings settings;
    settings.counts_per_effort =
        address.number("force", settings.counts_per_effort, 100, 1e6, "counts per N m");
    settings.low_pass = address.number("low_pass", settings.low_pass, 0, 5000, "Hz (0: none)");
    settings.peak_force = address.number("limit", settings.peak_force, 0.1, 20, "N");
    settings.damping = address.number("damping", settings.damping, 0.01, 20, "N s/m");
    settings.lag = address.number("lag", settings.lag, 0, 0.05, "s");
    settings.max_stiffness =
        address.number("max_stiffness", settings.max_stiffness, 0, 5000, "N/m (0: estimated)");
    settings.mass = address.number("mass", settings.mass, 0, 5, "kg at the tip (0: unknown)");
    settings.event_character = address.flag("event_char", settings.event_character);
    const std::string firmware = address.text("firmware");
    address.done();
    if (!firmware.empty()) settings.firmware = load_firmware(firmware);
    if (options.check_only) return nullptr;
    return std::make_unique<Falcon>(address.wanted(), std::move(settings), options.io_priority);
}

}  // namespace

Driver driver() {
    return {.scheme = "falcon",
            .help =
                "[SERIAL][?wait][,firmware=FILE][,force=COUNTS_PER_NM][,low_pass=HZ][,limit=N][,damping=NS_"
                "PER_M][,"
                "lag=S]"
                "[,max_stiffness=N_PER_M][,mass=KG][,event_char=on][,port=PORT]",
            .open = open,
            .usb = {std::begin(ids), std::end(ids)},
            .note =
                "after power-up it may need its firmware, which is Novint's and not part of Knurl: add "
                "firmware=nvent_firmware.bin (whether one runs already, only opening it tells)"};
}

}  // namespace knurl::drivers::falcon

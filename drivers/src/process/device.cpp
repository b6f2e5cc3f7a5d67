#include "process/device.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <sched.h>

#include <knurl/drivers/cartesian_tool.hpp>
#include <knurl/drivers/vendor_library.hpp>

#include "process/keeper.hpp"
#include "usb/address.hpp"

namespace knurl::drivers::process {

namespace {

/// What the address says of the device's figures, in place of the table's; 0: nothing.
struct Figures {
    double limit = 0, damping = 0, lag = 0, mass = 0, max_stiffness = 0;

    void take(usb::Address& address) {
        limit = address.number("limit", 0, 0.1, 100, "N");
        damping = address.number("damping", 0, 0.01, 50, "N s/m");
        lag = address.number("lag", 0, 1e-5, 0.1, "s");
        mass = address.number("mass", 0, 0.001, 10, "kg");
        max_stiffness = address.number("max_stiffness", 0, 1, 1e5, "N/m");
    }
    void put(LinkConfig& link) const {
        if (limit > 0) {
            const double share = link.peak_force > 0 ? limit / link.peak_force : 1;
            link.peak_force = limit;
            link.continuous_force = std::min(link.continuous_force, limit);
            for (std::size_t i = 0; i < std::min<std::size_t>(3, link.effort_limit.size()); ++i)
                link.effort_limit[i] *= share;
        }
        if (damping > 0) link.damping = damping;
        if (lag > 0) link.lag = lag;
        if (mass > 0) link.apparent_mass = mass;
        if (max_stiffness > 0) link.measured_max_stiffness = max_stiffness;
    }
};

class DriverProcessDevice final : public Device {
  public:
    DriverProcessDevice(Plan plan, const Figures& figures)
        : keeper_(std::move(plan)),
          link_(link_of(keeper_.description())),
          mechanism_(keeper_.description().shape.wrist != 0, keeper_.description().shape.gripper),
          seen_(keeper_.session()) {
        figures.put(link_);
        last_.calibrated = false;
    }

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return mechanism_; }
    bool has_buttons() const noexcept override { return keeper_.description().has_buttons != 0; }

    ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        Shared& shared = keeper_.shared();
        if (!begun_) {
            begun_ = true;
            shared.awake.store(1, std::memory_order_release);
            ring(shared);
        }
        acts_ = shared.acts.load(std::memory_order_acquire);
        const ReadStatus status = take();
        sample = last_;
        return status;
    }

    bool write(Nanoseconds, const JointEfforts& efforts) noexcept override {
        // Nobody knew where it was when that was written.
        if (!begun_) return there();
        Order order{.efforts = {}, .acts = acts_, .written = monotonic(), .cpu = sched_getcpu()};
        double share = 1;  // common to all, so that the force keeps its direction
        for (std::size_t i = 0; i < link_.effort_limit.size(); ++i) {
            order.efforts[i] = std::isfinite(efforts[i]) && last_.calibrated ? efforts[i] : 0;
            const double size = std::abs(order.efforts[i]);
            if (size > link_.effort_limit[i]) share = std::min(share, link_.effort_limit[i] / size);
        }
        for (double& effort : order.efforts) effort *= share;
        if (there()) {
            keeper_.lane(seen_).orders.publish(order);
            ring(keeper_.shared());
        }
        return there();
    }

    void make_safe() noexcept override {
        keeper_.shared().acts.fetch_add(1, std::memory_order_release);
        ring(keeper_.shared());
    }

  private:
    bool there() const noexcept { return seen_ % 2 == 1 && keeper_.session() == seen_; }

    ReadStatus take() noexcept {
        const std::uint64_t session = keeper_.session();
        if (session != seen_) {
            seen_ = session;
            seen_garbage_ = 0;
            return ReadStatus::unplugged;  // once, too, if another process is there already
        }
        if (session % 2 == 0) return ReadStatus::unplugged;
        Lane& lane = keeper_.lane(session);
        const std::uint64_t garbage = lane.garbage.load(std::memory_order_relaxed);
        const bool more_garbage = garbage != seen_garbage_;
        seen_garbage_ = garbage;
        Sample next;
        if (!lane.samples.take(next)) return more_garbage ? ReadStatus::bad : ReadStatus::stale;
        for (std::size_t i = 0; i < static_cast<std::size_t>(link_.sensed_joints); ++i)
            if (!std::isfinite(next.joints.position[i])) return ReadStatus::bad;
        if (more_garbage) return ReadStatus::bad;
        last_ = next.joints;
        last_.has_velocity = false;  // the servo's estimators, the same for every device
        return ReadStatus::ok;
    }

    Keeper keeper_;
    LinkConfig link_;
    CartesianTool mechanism_;
    JointSample last_;
    std::uint64_t seen_, seen_garbage_ = 0, acts_ = 0;
    bool begun_ = false;
};

std::string text(double value) {
    std::array<char, 32> digits{};
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
    return {digits.data(), end};
}

/// The library to load, or why there is none.
std::string library_for(const std::string& scheme) {
    const VendorLibrary& library = *vendor_library(scheme);
    std::string unusable;
    for (const FoundLibrary& found : find_library(library)) {
        if (found.problem.empty()) return found.path;
        if (unusable.empty()) unusable = found.path + ": " + found.problem;
    }
    if (!unusable.empty()) throw std::runtime_error(scheme + ": cannot use " + unusable);
    throw std::runtime_error(scheme + ": there is no " + library.names.front() + " of the " +
                             library.product + " on this machine; " + library.remedy);
}

/// Options that knurl-device gets as --set NAME=VALUE.
class Settings {
  public:
    explicit Settings(usb::Address& address) : address_(address) {}
    void number(const char* name, double least, double greatest, const char* unit) {
        const double none = std::nan("");
        const double value = address_.number(name, none, least, greatest, unit);
        if (std::isfinite(value)) words.insert(words.end(), {"--set", std::string(name) + "=" + text(value)});
    }
    std::vector<std::string> words;

  private:
    usb::Address& address_;
};

usb::Address address_of(const char* scheme, std::string_view what) {
    usb::Address address({.scheme = scheme, .kind = scheme, .ids = {}}, what);
    if (!address.wanted().port.empty())
        throw std::runtime_error(
            std::string(scheme) + ":" + std::string(what) +
            ": port= is not known to the maker's library; name the device by its serial number");
    if (address.wanted().wait)
        throw std::runtime_error(
            std::string(scheme) + ":" + std::string(what) +
            ": ?wait is for devices whose figures are known before they are there; this one states its "
            "own");
    return address;
}

std::unique_ptr<Device> started(const char* scheme, std::string_view what, std::vector<std::string> arguments,
                                const Figures& figures, const OpenOptions& options) {
    if (options.check_only) return nullptr;
    return std::make_unique<DriverProcessDevice>(Plan{.scheme = scheme,
                                                      .what = std::string(what),
                                                      .arguments = std::move(arguments),
                                                      .priority = options.io_priority},
                                                 figures);
}

constexpr const char* figure_help = "[,limit=N][,damping=NS_PER_M][,lag=S][,mass=KG][,max_stiffness=N_PER_M]";

std::unique_ptr<Device> open_dhd(std::string_view what, const OpenOptions& options) {
    usb::Address address = address_of("dhd", what);
    const std::string name = address.wanted().serial;
    if (!std::ranges::all_of(name, [](unsigned char c) { return std::isdigit(c) != 0; }) || name.size() > 6)
        throw std::runtime_error("dhd:" + std::string(what) + ": " + name +
                                 " is neither a serial number nor an index; knurl devices lists both");
    Settings settings(address);
    settings.number("rate", 500, 8000, "Hz");
    settings.number("watchdog", 0, 0.03, "s");
    settings.number("base_x", -180, 180, "degrees");
    settings.number("base_z", -180, 180, "degrees");
    settings.number("tool", 0, 2, "kg");
    Figures figures;
    figures.take(address);
    address.done();
    settings.words.insert(settings.words.end(), {"--library", library_for("dhd")});
    if (!name.empty()) settings.words.insert(settings.words.end(), {"--name", name});
    return started("dhd", what, std::move(settings.words), figures, options);
}

std::unique_ptr<Device> open_hd(std::string_view what, const OpenOptions& options) {
    usb::Address address = address_of("hd", what);
    const std::string name = address.wanted().serial;
    Figures figures;
    figures.take(address);
    address.done();
    std::vector<std::string> words{"--library", library_for("hd")};
    if (!name.empty()) words.insert(words.end(), {"--name", name});
    return started("hd", what, std::move(words), figures, options);
}

std::vector<UsbId> force_dimension_ids() {
    std::vector<UsbId> ids{{0x1451, 0x0301}};
    for (std::uint16_t product = 0x0400; product <= 0x040f; ++product) ids.push_back({0x1451, product});
    return ids;
}

}  // namespace

Driver hd_driver() {
    return {.scheme = "hd",
            .help = "[NAME]" + std::string(figure_help),
            .open = open_hd,
            // Of the Touch by USB, which is a serial port to the kernel; as found in others' udev rules.
            .usb = {{0x2988, 0x0302}, {0x2988, 0x0304}},
            .note =
                "the name is the one that the maker's Touch_Setup gave it; its serial port (ls -l "
                "/dev/ttyACM*) must "
                "be this user's: sudo usermod --append --groups dialout $USER",
            .named_by_library = true};
}

Driver dhd_driver() {
    return {
        .scheme = "dhd",
        .help = "[SERIAL|INDEX][,rate=HZ][,watchdog=S][,base_x=DEG][,base_z=DEG][,tool=KG]" +
                std::string(figure_help),
        .open = open_dhd,
        // As found in others' udev rules: 0301 omega, 0402 and 0403 sigma, 040c lambda; the rest between them.
        .usb = force_dimension_ids(),
        .note = "its serial number is the one that the SDK shows",
        .named_by_library = true};
}

}  // namespace knurl::drivers::process

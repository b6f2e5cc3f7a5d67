// "premium15,grip=0.5,tremor=0.2" -> SimProfile.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/words/nearest.hpp>

#include "sim/profiles.hpp"

namespace knurl::drivers {

namespace {

constexpr std::string_view arm_prefix = "arm=";

struct Option {
    std::string_view name;
    std::string_view unit;
    double least, greatest;
    std::string_view meaning;
    void (*set)(SimProfile&, double);
    bool zero_too = false;  // 0 is allowed and means "none", below the range
};

constexpr Option options[] = {
    {"grip", "", 0, 1, "how firmly the hand holds the tip; 0: not at all",
     [](SimProfile& p, double v) { p.hand.grip = v; }},
    {"hand", "N/m", 0, 2000, "the hand's spring towards its path (along z too, unless hand_normal is given)",
     [](SimProfile& p, double v) { p.hand.stiffness = v; }},
    {"hand_normal", "N/m", 0, 2000, "the hand's spring along z; 60 with a push unless given",
     [](SimProfile& p, double v) { p.hand.normal_stiffness = v; }},
    {"hand_damping", "N s/m", 0, 50, "the hand's damper",
     [](SimProfile& p, double v) { p.hand.damping = v; }},
    {"push", "N", 0, 10, "the hand presses along -z while its motion plays",
     [](SimProfile& p, double v) { p.hand.push = v; }},
    {"finger", "kg", 0, 1, "mass of the finger", [](SimProfile& p, double v) { p.hand.finger_mass = v; }},
    {"tremor", "N", 0, 2, "rms per axis of the hand's 8-12 Hz tremor",
     [](SimProfile& p, double v) { p.hand.tremor = v; }},
    {"seed", "", 0, 1e9, "of the tremor",
     [](SimProfile& p, double v) { p.seed = static_cast<std::uint64_t>(v); }},
    {"mass", "kg", 0.02, 5, "the device's own at the tip", [](SimProfile& p, double v) { p.mass = v; }},
    {"damping", "N s/m", 0, 20, "the device's own at the tip",
     [](SimProfile& p, double v) { p.damping = v; }},
    {"coulomb", "N", 0, 5, "dry friction at the tip", [](SimProfile& p, double v) { p.coulomb = v; }},
    {"gravity", "m/s^2", 0, 20, "along -z, not compensated", [](SimProfile& p, double v) { p.gravity = v; }},
    {"quantum", "m", 1e-9, 1e-2, "an encoder's count at the tip; 0: continuous",
     [](SimProfile& p, double v) {
         p.quantum = v;
         p.radians_per_count = {};
     },
     true},
    {"lag", "Hz", 10, 20000, "corner of the actuators' lag; 0: none",
     [](SimProfile& p, double v) { p.lag = v; }, true},
    {"dac", "bits", 2, 24, "resolution of the efforts; 0: continuous",
     [](SimProfile& p, double v) { p.dac_bits = std::round(v); }, true},
    {"limit", "N", 0.1, 50, "peak force at the tip",
     [](SimProfile& p, double v) {
         for (double& effort : p.effort_limit) effort *= v / p.peak_force;
         p.continuous_force = std::min(p.continuous_force, v);
         p.peak_force = v;
     }},
    {"watchdog", "s", 1e-3, 10, "motors go off after so long without a write; 0: has none",
     [](SimProfile& p, double v) { p.watchdog = v; }, true},
};

/// "grip=0..1", "lag=0|10..20000 Hz".
std::string usage(const Option& option) {
    std::ostringstream text;
    text << option.name << '=' << (option.zero_too ? "0|" : "") << option.least << ".." << option.greatest;
    if (!option.unit.empty()) {
        text << ' ' << option.unit;
    }
    return text.str();
}

template <class Range, class Name>
std::string listed(const Range& range, Name name) {
    std::string names;
    for (const auto& item : range) {
        if (!names.empty()) {
            names += ", ";
        }
        names += name(item);
    }
    return names;
}

void apply(std::string_view item, std::string_view address, SimProfile& profile, bool& normal_given) {
    const std::string where = "simulated device \"" + std::string(address) + "\": ";
    const auto equals = item.find('=');
    const std::string_view name = item.substr(0, equals);
    if (name == "live" && equals != std::string_view::npos && equals + 1 < item.size()) {
        profile.live = item.substr(equals + 1);
        return;
    }
    for (const Option& option : options) {
        if (option.name != name) {
            continue;
        }
        const std::string_view text = equals == std::string_view::npos ? "" : item.substr(equals + 1);
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool inside =
            (value >= option.least && value <= option.greatest) || (value == 0 && option.zero_too);
        if (text.empty() || error != std::errc() || end != text.data() + text.size() || !inside) {
            throw std::runtime_error(where + "cannot use \"" + std::string(item) + "\"; give " +
                                     usage(option));
        }
        option.set(profile, value);
        normal_given = normal_given || name == "hand_normal";
        return;
    }
    std::vector<std::string_view> names{"live"};
    for (const Option& option : options) names.push_back(option.name);
    throw std::runtime_error(where + "no option \"" + std::string(name) + "\"; there are " +
                             listed(options, [](const Option& option) { return option.name; }) +
                             ", live=/dev/input/event3" + words::meant(name, names));
}

}  // namespace

SimProfile sim_profile(std::string_view address) {
    const auto comma = address.find(',');
    const std::string_view name = address.substr(0, comma);
    SimProfile profile;
    if (name.starts_with(arm_prefix)) {
        profile = sim_profile_of(find_arm(std::string(name.substr(arm_prefix.size()))));
    } else if (!make_named_profile(name, profile)) {
        throw std::runtime_error("no simulated device \"" + std::string(name) + "\"; there are " +
                                 listed(sim_profile_names(), [](const std::string& known) { return known; }) +
                                 ", and arm=FILE.toml" + words::meant(name, sim_profile_names()));
    }
    bool normal_given = false;
    for (auto at = comma; at != std::string_view::npos;) {
        const auto next = address.find(',', at + 1);
        apply(address.substr(at + 1, next == std::string_view::npos ? next : next - at - 1), address, profile,
              normal_given);
        at = next;
    }
    if (!normal_given) {
        profile.hand.normal_stiffness = profile.hand.push > 0 ? 60 : profile.hand.stiffness;
    }
    return profile;
}

std::string sim_option_help() {
    std::string help;
    for (const Option& option : options) {
        help += usage(option) + "  " + std::string(option.meaning) + "\n";
    }
    help += "live=PATH[:PATH]  mouse and keyboard (evdev nodes) that move the hand\n";
    return help;
}

}  // namespace knurl::drivers

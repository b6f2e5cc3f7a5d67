#include <charconv>
#include <sstream>
#include <stdexcept>

#include <knurl/drivers/debounce.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_device.hpp>
#include <knurl/words/nearest.hpp>

#include "debounced.hpp"
#include "falcon/device.hpp"
#include "measured.hpp"
#include "process/device.hpp"
#include "spacemouse/device.hpp"
#include "wooden/device.hpp"

namespace knurl::drivers {

std::vector<Driver>& drivers() {
    static std::vector<Driver> all = {
        sim_driver(),     falcon::driver(),      spacemouse::driver(),
        wooden::driver(), process::dhd_driver(), process::hd_driver(),
    };
    return all;
}

namespace {

constexpr std::string_view debounce_option = "debounce=", measured_option = "measured=";

/// The options that every driver's address may have, removed from it.
struct AddressOptions {
    std::string what;
    double debounce = Debounce::usual;  // s
    std::string measured;               // file; empty: the driver's own figures
};

AddressOptions options_of(std::string_view address, std::size_t at) {
    AddressOptions given;
    for (bool first = true, more = true; more; first = false) {
        const std::size_t end = address.find(',', at);
        more = end != std::string_view::npos;
        const std::string_view item = address.substr(at, more ? end - at : end);
        at = end + 1;
        if (item.starts_with(measured_option)) {
            given.measured = item.substr(measured_option.size());
            continue;
        }
        if (!item.starts_with(debounce_option)) {
            given.what.append(first ? "" : ",").append(item);
            continue;
        }
        const std::string_view text = item.substr(debounce_option.size());
        const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), given.debounce);
        if (text.empty() || error != std::errc() || stopped != text.data() + text.size() ||
            !(given.debounce >= 0 && given.debounce <= Debounce::longest)) {
            std::ostringstream why;
            why << address << ": cannot use " << item << "; give 0 to " << Debounce::longest
                << " s for which a button's further edges are ignored after an edge (0: all count)";
            throw std::runtime_error(why.str());
        }
    }
    return given;
}

}  // namespace

std::unique_ptr<Device> open_device(std::string_view address, const OpenOptions& options) {
    const auto colon = address.find(':');
    const std::string_view scheme = address.substr(0, colon);
    std::string known;
    for (const Driver& driver : drivers()) {
        if (colon != std::string_view::npos && driver.scheme == scheme) {
            const AddressOptions given = options_of(address, colon + 1);
            if (!given.measured.empty()) check_measured(given.measured);
            std::unique_ptr<Device> device = driver.open(given.what, options);
            if (device && !given.measured.empty()) device = measured(std::move(device), given.measured);
            return device ? debounced(std::move(device), given.debounce) : nullptr;
        }
        known += (known.empty() ? "" : "; ") + driver.scheme + ":" + driver.help;
    }
    std::vector<std::string> schemes;
    for (const Driver& driver : drivers()) schemes.push_back(driver.scheme);
    throw std::runtime_error("no device \"" + std::string(address) + "\"; write one of " + known +
                             words::meant(scheme, schemes));
}

}  // namespace knurl::drivers

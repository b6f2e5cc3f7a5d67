#include <stdexcept>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/sim_device.hpp>
#include <knurl/words/nearest.hpp>

#include "falcon/device.hpp"
#include "spacemouse/device.hpp"
#include "wooden/device.hpp"

namespace knurl::drivers {

std::vector<Driver>& drivers() {
    static std::vector<Driver> all = {
        sim_driver(),
        falcon::driver(),
        spacemouse::driver(),
        wooden::driver(),
    };
    return all;
}

std::unique_ptr<Device> open_device(std::string_view address, const OpenOptions& options) {
    const auto colon = address.find(':');
    const std::string_view scheme = address.substr(0, colon);
    std::string known;
    for (const Driver& driver : drivers()) {
        if (colon != std::string_view::npos && driver.scheme == scheme) {
            return driver.open(address.substr(colon + 1), options);
        }
        known += (known.empty() ? "" : "; ") + driver.scheme + ":" + driver.help;
    }
    std::vector<std::string> schemes;
    for (const Driver& driver : drivers()) schemes.push_back(driver.scheme);
    throw std::runtime_error("no device \"" + std::string(address) + "\"; write one of " + known +
                             words::meant(scheme, schemes));
}

}  // namespace knurl::drivers

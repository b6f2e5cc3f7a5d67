#include "wish.hpp"

#include <chrono>
#include <cstdlib>

#include <knurl/client/client.hpp>

namespace knurl::lookalike {

namespace {

std::string variable(const char* name, const char* otherwise) {
    const char* said = std::getenv(name);
    return said == nullptr || *said == '\0' ? otherwise : said;
}

}  // namespace

std::vector<Place> places_said(const std::string& devices, const std::string& servo) {
    std::vector<Place> all;
    for (std::size_t begin = 0; begin <= devices.size();) {
        const std::size_t end = std::min(devices.find(',', begin), devices.size());
        std::string one = devices.substr(begin, end - begin);
        begin = end + 1;
        if (one.empty()) continue;
        const std::size_t equals = one.find('=');
        const std::string alias = equals == std::string::npos ? "" : one.substr(0, equals);
        if (equals != std::string::npos) one.erase(0, equals + 1);
        // A servo may be a path: the device is what is behind the last slash.
        const std::size_t slash = one.rfind('/');
        if (slash == std::string::npos)
            all.push_back({servo, one, alias});
        else
            all.push_back({one.substr(0, slash), one.substr(slash + 1), alias});
    }
    return all;
}

std::vector<Place> places() {
    const std::string servo = variable("KNURL_AS_SERVO", "knurl:default");
    std::vector<Place> all = places_said(variable("KNURL_AS_DEVICES", ""), servo);
    if (!all.empty()) return all;
    const Client client = Client::connect(servo, {.wait = std::chrono::milliseconds(0), .hints = false});
    for (const DeviceDescription& device : client.devices()) all.push_back({servo, device.name, {}});
    return all;
}

}  // namespace knurl::lookalike

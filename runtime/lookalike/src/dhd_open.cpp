// Devices: how many, which, open and closed; what is known of them.

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>

#include "dhd.h"
#include "dhd_state.hpp"

namespace knurl::lookalike::dhd {

namespace {

/// Whose interface this is like. Programs look at it: the newest Python bindings ask for 3.16.
constexpr int interface_version[] = {3, 16, 0, 0};

int count() {
    const int all = static_cast<int>(places().size());
    if (all == 0) throw Refused{Code::no_device};
    return std::min(all, most_devices);
}

/// Opens the first device that `fits` (its description, its number), or finds it open.
template <class Fits>
int open_that(Fits fits) {
    const int all = count();
    for (int number = 0; number < all; ++number) {
        bool was_open = true;
        try {
            opened(static_cast<char>(number));
        } catch (const Refused&) {
            was_open = false;
        }
        const int before = default_device();
        try {
            open_number(number);
        } catch (...) {
            caught();
            continue;
        }
        if (fits(opened(static_cast<char>(number))->hand.device(), number)) return number;
        if (!was_open) close_device(static_cast<char>(number));
        if (before >= 0) set_default(static_cast<char>(before));
    }
    throw Refused{Code::no_device};
}

void give_text(char* out, std::size_t room, const char* text) {
    require(out);
    if (room > 0) std::snprintf(out, room, "%s", text);
}

}  // namespace

}  // namespace knurl::lookalike::dhd

using namespace knurl::lookalike::dhd;
using knurl::DeviceDescription;

extern "C" {

int dhdErrorGetLast(void) {
    return last_error();
}
int* dhdErrnoLocation(void) {
    return &last_error();
}
const char* dhdErrorGetLastStr(void) {
    return text_of(last_error());
}
const char* dhdErrorGetStr(int error) {
    return text_of(error);
}

void dhdEnableSimulator(unsigned char) {}

int dhdGetDeviceCount(void) {
    return call([] { return count(); }, 0);
}
int dhdGetAvailableCount(void) {
    return dhdGetDeviceCount();
}
int dhdOpen(void) {
    return call([] { return open_first(); });
}
int dhdOpenID(char id) {
    return call([=] {
        const int number = static_cast<signed char>(id);
        return number < 0 ? open_first() : open_number(number);
    });
}
int dhdOpenSerial(int serial) {
    return call([=] {
        return open_that(
            [=](const DeviceDescription& device, int number) { return serial_of(device, number) == serial; });
    });
}
int dhdOpenType(int type) {
    return call([=] {
        return open_that([=](const DeviceDescription& device, int) { return type_of(device) == type; });
    });
}
int dhdClose(char id) {
    return call([=] { return close_device(id), 0; });
}
int dhdSetDevice(char id) {
    return call([=] { return set_default(id), 0; });
}
int dhdGetDeviceID(void) {
    const int number = default_device();
    return number < 0 ? fail(Code::not_ready) : number;
}

int dhdGetSerialNumber(unsigned short* serial, char id) {
    return call([=] {
        require(serial);
        const auto device = opened(id);
        const int said = static_cast<signed char>(id);
        *serial = serial_of(device->hand.device(), said < 0 ? default_device() : said);
        return 0;
    });
}
int dhdGetSystemType(char id) {
    return call([=] { return type_of(opened(id)->hand.device()); });
}
int dhdGetSystemRev(char id) {
    return call([=] { return opened(id), 0; });
}
const char* dhdGetSystemName(char id) {
    try {
        // As long as the thread does not ask again.
        thread_local std::string name;
        const auto device = opened(id);
        name = "Knurl " + device->hand.device().profile;
        return name.c_str();
    } catch (...) {
        fail(caught());
        return nullptr;
    }
}
int dhdGetVersion(double* version, char id) {
    return call([=] {
        require(version);
        opened(id);
        return *version = 0, 0;
    });
}
int dhdGetVersionStr(char* out, size_t room, char id) {
    return call([=] { return opened(id), give_text(out, room, KNURL_VERSION), 0; });
}
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
    int* const out[] = {major, minor, release, revision};
    for (std::size_t i = 0; i < std::size(out); ++i)
        if (out[i] != nullptr) *out[i] = interface_version[i];
}
void dhdGetAPIVersion(int* major, int* minor, int* release, int* revision) {
    dhdGetSDKVersion(major, minor, release, revision);
}
const char* dhdGetSDKVersionStr(void) {
    return "3.16.0 (Knurl " KNURL_VERSION ")";
}
int dhdGetComMode(char id) {
    constexpr int virtual_device = 3, network = 4;
    return call([=] {
        return opened(id)->hand.device().address.find("knurl://") == std::string::npos ? virtual_device
                                                                                       : network;
    });
}

bool dhdIsLeftHanded(char) {
    return false;
}
bool dhdHasBase(char id) {
    return call([=] { return opened(id) != nullptr; }, false);
}
bool dhdHasWrist(char id) {
    return call([=] { return opened(id)->hand.device().senses_orientation; }, false);
}
bool dhdHasActiveWrist(char id) {
    return call([=] { return opened(id)->hand.device().renders_torque; }, false);
}
bool dhdHasGripper(char) {
    return false;
}
bool dhdHasActiveGripper(char) {
    return false;
}

int dhdEnableExpertMode(void) {
    expert = true;
    return 0;
}
int dhdDisableExpertMode(void) {
    expert = false;
    return 0;
}

}  // extern "C"

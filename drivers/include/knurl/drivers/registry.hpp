#pragma once

/// @file
/// One line per driver: a scheme ("sim") and what opens "sim:premium15".

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/drivers/device.hpp>

namespace knurl::drivers {

/// Settings that come with a device from knurld's command line or configuration.
struct OpenOptions {
    /// File with the motion of a simulated hand (t,x,y,z[,qw,qx,qy,qz]); empty: it rests at the centre.
    std::string hand_file;
    /// Seed of a simulated hand's tremor.
    std::uint64_t seed = 1;
    /// SCHED_FIFO priority of a driver's own threads; 0: ordinary.
    int io_priority = 0;
    /// True: read address and files, and touch no hardware. There may be no device then.
    bool check_only = false;
};

/// What a device on USB says it is.
struct UsbId {
    /// Vendor number.
    std::uint16_t vendor;
    /// Product number.
    std::uint16_t product;
};

/// What opens the devices of one scheme.
struct Driver {
    /// Scheme of the addresses: "sim".
    std::string scheme;
    /// One line: what the part after the colon may be.
    std::string help;
    /// Opens what comes after the colon. Throws std::runtime_error: what was wrong, where, what to do.
    std::function<std::unique_ptr<Device>(std::string_view what, const OpenOptions&)> open;
    /// The USB devices that it drives, for `knurl devices`; empty: it is not on USB.
    std::vector<UsbId> usb = {};
    /// What a user should know about such a device before it is opened.
    std::string note = {};
    /// True: its maker's library names the devices, by names that USB does not tell. "SCHEME:" opens the first.
    bool named_by_library = false;
};

/// All drivers of this build.
std::vector<Driver>& drivers();

/// Opens "scheme:what"; with check_only it may return null. The option "measured=FILE" of the address has mass, damping
/// and lag of one's own device, as `knurl device calibrate` wrote them, in place of the driver's figures. The option "debounce=S" of the address is every
/// device's: how long a button's contacts are ignored after an edge (debounce.hpp), 0 for the contacts as
/// they are. Throws std::runtime_error that names the known schemes if there is no such scheme.
std::unique_ptr<Device> open_device(std::string_view address, const OpenOptions& options = {});

}  // namespace knurl::drivers

#pragma once
// One line per driver: a scheme ("sim") and what opens "sim:premium15".

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
    // motion of a simulated hand (t,x,y,z[,qw,qx,qy,qz]); empty: it rests at the centre
    std::string hand_file;
    std::uint64_t seed = 1;
    int io_priority = 0;      // SCHED_FIFO of a driver's own threads; 0: ordinary
    bool check_only = false;  // reads address and files, touches no hardware: there may be no device then
};

/// What a device on USB says it is.
struct UsbId {
    std::uint16_t vendor, product;
};

struct Driver {
    std::string scheme;
    std::string help;  // one line: what the part after the colon may be
    // throws: what, where, mend
    std::function<std::unique_ptr<Device>(std::string_view what, const OpenOptions&)> open;
    std::vector<UsbId> usb = {};  // of the devices that it drives, for `knurl devices`; empty: not on USB
    std::string note = {};        // what whoever has one plugged in should know before it is opened
};

/// All drivers of this build.
std::vector<Driver>& drivers();

/// Opens "scheme:what"; with check_only it may return none. Of its options "debounce=S" is every device's: how
/// long a button is left alone after an edge (debounce.hpp), 0 for the contacts as they are. Throws
/// std::runtime_error that names the known schemes if there is none such.
std::unique_ptr<Device> open_device(std::string_view address, const OpenOptions& options = {});

}  // namespace knurl::drivers

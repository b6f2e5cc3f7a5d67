#pragma once
// Which of the USB devices that Knurl can drive are plugged in. Opens none of them: what it says is in sysfs.

#include <cstdint>
#include <string>
#include <vector>

namespace knurl::drivers {

struct UsbDevice {
    std::uint16_t vendor = 0, product = 0;
    std::string scheme;       // of the driver: "falcon"
    std::string name;         // as the device calls itself: "FALCON HAPTIC"
    std::string serial;       // empty: has none
    bool twin = false;        // another of its kind that is plugged in has the same serial number
    std::string port;         // bus and ports, "1-1.2": stays the same until it is plugged in elsewhere
    std::string node;         // "/dev/bus/usb/001/004"
    bool accessible = false;  // this user may open the node
    bool claimed = false;     // a program talks to it, this one or another

    /// What opens it: "falcon:SERIAL", or "falcon:port=1-1.2" where no serial number tells it apart.
    std::string address() const;
};

/// All that some driver of this build knows, in order of port. Throws std::runtime_error if USB itself cannot
/// be looked at.
std::vector<UsbDevice> usb_devices();

/// The udev rule that lets the user at the seat open the node, and the command that installs it, in a file of
/// this driver's own: one named like the package's would hide that.
std::string udev_rule(const UsbDevice& device);
std::string udev_rule_file(const UsbDevice& device);
std::string install_udev_rule(const UsbDevice& device);
/// The file whose rules are for this device, Knurl's own or one that was made by hand; empty: none is
/// installed.
std::string installed_udev_rules(const UsbDevice& device);
/// Why its node may not be opened, and the command that mends it.
struct NoRights {
    std::string problem, mend;
};
NoRights no_rights(const UsbDevice& device);

}  // namespace knurl::drivers

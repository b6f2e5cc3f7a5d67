#pragma once

/// @file
/// Which of the USB devices that Knurl can drive are plugged in. Opens none of them: what it says is in
/// sysfs.

#include <cstdint>
#include <string>
#include <vector>

namespace knurl::drivers {

/// A USB device that is plugged in.
struct UsbDevice {
    /// Vendor number.
    std::uint16_t vendor = 0;
    /// Product number.
    std::uint16_t product = 0;
    /// Scheme of its driver: "falcon".
    std::string scheme;
    /// Its own name: "FALCON HAPTIC".
    std::string name;
    /// Serial number; empty: it has none.
    std::string serial;
    /// True: another of its kind that is plugged in has the same serial number.
    bool twin = false;
    /// Bus and ports, "1-1.2"; the same until it is plugged in elsewhere.
    std::string port;
    /// Its node: "/dev/bus/usb/001/004".
    std::string node;
    /// True: this user may open the node.
    bool accessible = false;
    /// True: a program talks to it, this one or another.
    bool claimed = false;

    /// The address that opens it: "falcon:SERIAL", or "falcon:port=1-1.2" where no serial number tells it
    /// apart.
    std::string address() const;
};

/// All devices that a driver of this build knows, in order of port. Throws std::runtime_error if USB itself
/// cannot be read.
std::vector<UsbDevice> usb_devices();

/// The udev rule that lets the user at the seat open the node.
std::string udev_rule(const UsbDevice& device);
/// The file for it. It is this driver's own: one named like the package's would hide the package's file.
std::string udev_rule_file(const UsbDevice& device);
/// The command that installs it.
std::string install_udev_rule(const UsbDevice& device);
/// The file whose rules are for this device, Knurl's own or one that was made by hand; empty: none is
/// installed.
std::string installed_udev_rules(const UsbDevice& device);
/// Why its node may not be opened, and the command that mends it.
struct NoRights {
    /// Why the node may not be opened.
    std::string problem;
    /// The command that changes that.
    std::string mend;
};
/// Why the node of this device may not be opened.
NoRights no_rights(const UsbDevice& device);

}  // namespace knurl::drivers

#include <algorithm>

#include <knurl/drivers/usb_list.hpp>

#include "falcon/device.hpp"
#include "spacemouse/device.hpp"
#include "usb/session.hpp"
#include "wooden/device.hpp"

namespace knurl::drivers {

std::string UsbDevice::address() const {
    return scheme + ":" + (serial.empty() ? "port=" + port : serial);
}

std::string udev_rule(const UsbDevice& device) {
    char text[128];
    std::snprintf(text, sizeof text,
                  "SUBSYSTEM==\"usb\", ATTR{idVendor}==\"%04x\", ATTR{idProduct}==\"%04x\", TAG+=\"uaccess\"",
                  unsigned{device.vendor}, unsigned{device.product});
    return text;
}

std::vector<UsbDevice> usb_devices() {
    const usb::Context context;
    std::vector<UsbDevice> all;
    const auto add = [&](std::span<const usb::DeviceId> ids, const char* scheme) {
        for (const usb::Found& found : context.list(ids, scheme)) all.push_back(found.info);
    };
    add(falcon::ids, "falcon");
    add(spacemouse::ids, "spacemouse");
    add(wooden::ids, "wooden");
    std::ranges::sort(all, {}, &UsbDevice::port);
    return all;
}

}  // namespace knurl::drivers

#include <algorithm>

#include <knurl/drivers/usb_list.hpp>

#include "usb/session.hpp"

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

std::string udev_rule_file(const UsbDevice& device) {
    return "70-knurl-" + device.scheme + ".rules";
}

std::string install_udev_rule(const UsbDevice& device) {
    return "echo '" + udev_rule(device) + "' | sudo tee /etc/udev/rules.d/" + udev_rule_file(device) +
           " && sudo udevadm control --reload && sudo udevadm trigger";
}

std::vector<UsbDevice> usb_devices() {
    const usb::Context context;
    std::vector<UsbDevice> all;
    for (const Driver& driver : drivers())
        for (const usb::Found& found : context.list(driver.usb, driver.scheme)) all.push_back(found.info);
    std::ranges::sort(all, {}, &UsbDevice::port);
    return all;
}

}  // namespace knurl::drivers

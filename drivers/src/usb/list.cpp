#include <algorithm>
#include <filesystem>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/usb_list.hpp>

#include "usb/session.hpp"

namespace knurl::drivers {

std::string UsbDevice::address() const {
    for (const Driver& driver : drivers())
        if (driver.scheme == scheme && driver.named_by_library) return scheme + ":";
    return scheme + ":" + (serial.empty() || twin ? "port=" + port : serial);
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

std::string installed_udev_rules(const UsbDevice& device) {
    for (const char* folder : {"/etc/udev/rules.d", "/run/udev/rules.d", "/usr/local/lib/udev/rules.d",
                               "/usr/lib/udev/rules.d", "/lib/udev/rules.d"}) {
        for (const std::string& name : {std::string("70-knurl.rules"), udev_rule_file(device)}) {
            const std::filesystem::path file = std::filesystem::path(folder) / name;
            std::error_code none;
            if (std::filesystem::exists(file, none)) return file.string();
        }
    }
    return "";
}

NoRights no_rights(const UsbDevice& device) {
    const std::string rules = installed_udev_rules(device);
    if (rules.empty())
        return {.problem = "no right to open it: there is no udev rule for it",
                .mend = install_udev_rule(device)};
    return {.problem = "no right to open it, though " + rules + " is there",
            .mend = "sudo usermod --append --groups haptics $USER (then log in again), or plug it in again"};
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

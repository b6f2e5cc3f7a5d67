// The rules that the package installs, against the devices that the drivers know.

#include <fstream>
#include <regex>

#include <fnmatch.h>
#include <gtest/gtest.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/usb_list.hpp>

namespace knurl::drivers {
namespace {

/// A value of udev: patterns of the shell, '|' between them.
bool matches(const std::string& patterns, std::uint16_t id) {
    char text[8];
    std::snprintf(text, sizeof text, "%04x", unsigned{id});
    std::stringstream all(patterns);
    for (std::string one; std::getline(all, one, '|');)
        if (fnmatch(one.c_str(), text, 0) == 0) return true;
    return false;
}

TEST(UdevRules, GiveTheGroupEveryDeviceThatADriverKnows) {
    std::ifstream file(KNURL_RULES);
    ASSERT_TRUE(file) << KNURL_RULES;
    const std::regex rule(
        R"re(^ATTR\{idVendor\}=="([^"]+)", ATTR\{idProduct\}=="([^"]+)", GROUP="haptics", MODE="0660", TAG\+="uaccess"$)re");
    std::vector<std::smatch> rules;
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    for (const std::string& line : lines)
        if (std::smatch found; std::regex_match(line, found, rule)) rules.push_back(found);
    int devices = 0;
    for (const Driver& driver : drivers()) {
        for (const UsbId& id : driver.usb) {
            ++devices;
            EXPECT_TRUE(std::ranges::any_of(rules,
                                            [&](const std::smatch& one) {
                                                return matches(one[1], id.vendor) &&
                                                       matches(one[2], id.product);
                                            }))
                << driver.scheme << " " << std::hex << id.vendor << ":" << id.product;
        }
    }
    EXPECT_GT(devices, 0);
}

TEST(UdevRules, OneThatIsMadeByHandDoesNotHideThePackagesFile) {
    UsbDevice falcon;
    falcon.vendor = 0x0403;
    falcon.product = 0xcb48;
    falcon.scheme = "falcon";
    EXPECT_EQ(install_udev_rule(falcon),
              "echo 'SUBSYSTEM==\"usb\", ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"cb48\", "
              "TAG+=\"uaccess\"' | sudo tee /etc/udev/rules.d/70-knurl-falcon.rules && sudo udevadm control "
              "--reload && sudo udevadm trigger");
}

}  // namespace
}  // namespace knurl::drivers

// `knurl devices`: which devices are plugged in, what is missing, and the command that fixes it. On a bus
// that umockdev emulates.

#include <cstring>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/json/json.hpp>

#include "program.hpp"

namespace knurl::test {
namespace {

using json = knurl::Json;
using testing::HasSubstr;
using testing::Not;

// A root hub and a Falcon, as in sysfs and in their descriptors.
constexpr const char* bus = R"(P: /devices/pci0000:00/0000:00:14.0/usb1
N: bus/usb/001/001
E: DEVNAME=/dev/bus/usb/001/001
E: DEVTYPE=usb_device
E: SUBSYSTEM=usb
E: BUSNUM=001
E: DEVNUM=001
A: busnum=1
A: devnum=1
A: idVendor=1d6b
A: idProduct=0002
A: speed=480
A: bConfigurationValue=1
H: descriptors=12010002090001406b1d020006060302010109021900010100e0000904000001090000000705810304000c

P: /devices/pci0000:00/0000:00:14.0/usb1/1-2
N: bus/usb/001/004
E: DEVNAME=/dev/bus/usb/001/004
E: DEVTYPE=usb_device
E: SUBSYSTEM=usb
E: BUSNUM=001
E: DEVNUM=004
A: busnum=1
A: devnum=4
A: idVendor=0403
A: idProduct=cb48
A: product=FALCON HAPTIC
A: serial=FALCON01
A: speed=12
A: bConfigurationValue=1
H: descriptors=1201100100000008030448cb0006010203010902200001010080320904000002ffffff020705810240000007050202400000
)";

/// Runs it on that bus.
Outcome on_the_bus(const std::string& text, const std::string& words) {
    const Folder folder;
    return run({"/usr/bin/env", "umockdev-run", "-d", folder.file("bus", text), "--", "/bin/sh", "-c",
                knurl_program() + " " + words});
}

/// The same as user nobody, who may only read the node.
Outcome as_nobody(const std::string& words) {
    const Folder folder;
    std::filesystem::permissions(folder.path(""), std::filesystem::perms(0755));
    // The user nobody may have no access to the build folder.
    const std::string program = folder.path("knurl");
    std::filesystem::copy_file(knurl_program(), program);
    return run({"/usr/bin/setpriv", "--reuid=65534", "--clear-groups", "/usr/bin/env", "umockdev-run", "-d",
                folder.file("bus", bus), "--", "/bin/sh", "-c",
                "chmod 444 $UMOCKDEV_DIR/dev/bus/usb/001/004 && " + program + " " + words});
}

TEST(Devices, WhatIsPluggedInIsListedWithItsAddress) {
    const Outcome text = on_the_bus(bus, "devices");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("falcon:FALCON01  FALCON HAPTIC at 1-2 (/dev/bus/usb/001/004): ready"));
    EXPECT_THAT(text.out, HasSubstr("firmware=")) << "what it may need next";
    const json list = json::parse(on_the_bus(bus, "devices --json").out).at("devices");
    ASSERT_EQ(list.size(), 1u);
    EXPECT_EQ(list[0].at("address"), "falcon:FALCON01");
    EXPECT_TRUE(list[0].at("problem").is_null());
    EXPECT_THAT(list[0].at("note").get<std::string>(), HasSubstr("firmware="));
}

TEST(Devices, TwoOfOneSerialNumberAreToldApartByTheirPorts) {
    std::string twins = bus, second = twins.substr(twins.rfind("P: "));
    for (const auto& [from, to] : {std::pair{"usb1/1-2", "usb1/1-3"}, std::pair{"001/004", "001/005"},
                                   std::pair{"DEVNUM=004", "DEVNUM=005"}, std::pair{"devnum=4", "devnum=5"}})
        for (std::size_t at = 0; (at = second.find(from, at)) != std::string::npos; ++at)
            second.replace(at, std::strlen(from), to);
    twins += "\n" + second;
    const json list = json::parse(on_the_bus(twins, "devices --json").out).at("devices");
    ASSERT_EQ(list.size(), 2u);
    EXPECT_EQ(list[0].at("address"), "falcon:port=1-2");
    EXPECT_EQ(list[1].at("address"), "falcon:port=1-3");
    EXPECT_EQ(list[1].at("serial"), "FALCON01");
}

TEST(Devices, WithoutTheRightToOpenItSaysWhatGivesIt) {
    KNURL_NEEDS(missing_other_user());
    const Outcome text = as_nobody("devices");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("no right to open it"));
    EXPECT_THAT(text.out, testing::AnyOf(HasSubstr("ATTR{idVendor}==\"0403\", ATTR{idProduct}==\"cb48\""),
                                         HasSubstr("usermod --append --groups haptics")));
    EXPECT_THAT(text.out, Not(HasSubstr("ready")));
}

TEST(Devices, AServiceThatIsNotOursToSeeHidesNoDevice) {
    KNURL_NEEDS(missing_other_user());
    const Folder folder;
    std::filesystem::permissions(folder.path(""), std::filesystem::perms(0700));
    setenv("KNURL_RUNTIME_DIR", folder.path("").c_str(), 1);
    const Outcome devices = as_nobody("devices");
    const Outcome servos = as_nobody("ls");
    unsetenv("KNURL_RUNTIME_DIR");
    EXPECT_EQ(devices.code, 0) << devices.err;
    EXPECT_THAT(devices.out, HasSubstr("falcon:FALCON01"));
    EXPECT_EQ(servos.code, 1) << servos.out;
    EXPECT_THAT(servos.err, HasSubstr("cannot be looked into: Permission denied"));
}

TEST(Devices, AMakersLibraryIsTriedAndSaysWhatItSeesOrWhatIsMissing) {
    const Folder folder;
    setenv("KNURL_LIBDHD", KNURL_COUNTERFEIT_DHD, 1);
    setenv("KNURL_LIBHD", folder.file("libHD.so", "no library").c_str(), 1);
    const Outcome text = on_the_bus("", "devices");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("Force Dimension SDK 3.17.1"));
    EXPECT_THAT(text.out, HasSubstr("loads; it sees 0 devices"));
    EXPECT_THAT(text.out, HasSubstr("libHD.so: it is no shared library"));
    setenv("KNURL_LIBDHD", KNURL_COUNTERFEIT_DHD_LACKING, 1);
    setenv("KNURL_LIBHD", KNURL_COUNTERFEIT_HD, 1);
    const json list = json::parse(on_the_bus("", "devices --json").out).at("libraries");
    unsetenv("KNURL_LIBDHD");
    unsetenv("KNURL_LIBHD");
    ASSERT_EQ(list.size(), 2u);
    EXPECT_THAT(list[0].at("problem").get<std::string>(), HasSubstr("has no function dhdGetPosition"));
    EXPECT_TRUE(list[0].at("sdk_version").is_null());
    EXPECT_EQ(list[1].at("sdk_version"), "3.40");
    EXPECT_TRUE(list[1].at("devices").is_null()) << "it tells none before one is opened";
    EXPECT_TRUE(list[1].at("problem").is_null());
}

TEST(Devices, NothingPluggedInIsAnAnswer) {
    const Outcome text = on_the_bus("", "devices");
    EXPECT_EQ(text.code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("nothing that Knurl drives is plugged into USB"));
    EXPECT_THAT(text.out, HasSubstr("sim:"));
}

}  // namespace
}  // namespace knurl::test

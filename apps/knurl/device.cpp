// knurl device VERB: one device, without a servo. `check` reads its description, `test` tries it.

#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "device_check.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

struct DeviceArguments {
    std::string arm, picture;
    bool json = false;
};

int run_check(const DeviceArguments& arguments) {
    CheckedArm arm;
    try {
        arm = checked_arm(arguments.arm);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());  // an unusable file: exit code 2
    }
    const ArmCheck checked = check(arm);
    fmt::print("{}", arguments.json ? report_json(arm, checked) : report_text(arm, checked));
    if (!arguments.picture.empty()) draw(arm, checked, arguments.picture);
    return 0;
}

}  // namespace

void add_device_check(commandline::Command& device) {
    auto& verb = device.verb(
        "check", "Workspace, condition, force and resolution of an arm, from its file; no hardware");
    auto arguments = std::make_shared<DeviceArguments>();
    verb.option("FILE", arguments->arm,
                "an arm's TOML file, or the name of one that is built in (omni, woodenhaptics, ...)")
        .required();
    verb.option("--picture", arguments->picture, "draws the arm and its workspace").type_name("P.png");
    verb.flag("--json", arguments->json, "for programs");
    verb.action([arguments] { return run_check(*arguments); });
}

void add_device(commandline::Command& program) {
    auto& device = program.verb("device", "One device, without a servo: what it can do, what it does");
    device.requires_verb();
    add_device_check(device);
    add_device_test(device);
    add_device_calibrate(device);
}

}  // namespace knurl::cli

// knurl device VERB: what a device can do.

#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "device_check.hpp"
#include "verbs.hpp"

namespace knurl::cli {

namespace {

struct Arguments {
    std::string arm, picture;
    bool json = false;
};

int run_check(const Arguments& arguments) {
    CheckedArm arm;
    try {
        arm = checked_arm(arguments.arm);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());  // a file that says nothing usable: exit code 2
    }
    const ArmCheck checked = check(arm);
    fmt::print("{}", arguments.json ? report_json(arm, checked) : report_text(arm, checked));
    if (!arguments.picture.empty()) draw(arm, checked, arguments.picture);
    return 0;
}

}  // namespace

void add_device(CLI::App& program, Run& run) {
    auto* device = program.add_subcommand("device", "What a device can do, from its description");
    device->require_subcommand(1);
    auto* verb = device->add_subcommand(
        "check", "Workspace, condition, force and resolution of an arm, from its file; no hardware");
    auto arguments = std::make_shared<Arguments>();
    verb->add_option("FILE", arguments->arm,
                     "an arm's TOML file, or the name of one that is built in (omni, woodenhaptics, ...)")
        ->required();
    verb->add_option("--picture", arguments->picture, "draws the arm and its workspace")->type_name("P.png");
    verb->add_flag("--json", arguments->json, "for programs");
    verb->callback([&run, arguments] { run = [arguments] { return run_check(*arguments); }; });
}

}  // namespace knurl::cli

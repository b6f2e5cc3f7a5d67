// knurl device VERB: one device, without a servo. `check` reads its description, `test` tries it.

#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
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

void add_device_check(CLI::App& device, Run& run) {
    auto* verb = device.add_subcommand(
        "check", "Workspace, condition, force and resolution of an arm, from its file; no hardware");
    auto arguments = std::make_shared<Arguments>();
    verb->add_option("FILE", arguments->arm,
                     "an arm's TOML file, or the name of one that is built in (omni, woodenhaptics, ...)")
        ->required();
    verb->add_option("--picture", arguments->picture, "draws the arm and its workspace")->type_name("P.png");
    verb->add_flag("--json", arguments->json, "for programs");
    verb->callback([&run, arguments] { run = [arguments] { return run_check(*arguments); }; });
}

void add_device(CLI::App& program, Run& run) {
    auto* device =
        program.add_subcommand("device", "One device, without a servo: what it can do, what it does");
    device->require_subcommand(1);
    add_device_check(*device, run);
    add_device_test(*device, run);
}

}  // namespace knurl::cli

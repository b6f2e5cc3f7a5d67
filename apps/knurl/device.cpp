// knurl device ...: one device, without a servo.

#include "verbs.hpp"

namespace knurl::cli {

void add_device(CLI::App& program, Run& run) {
    auto* device = program.add_subcommand("device", "Tries one device, without a servo");
    device->require_subcommand(1);
    add_device_test(*device, run);
}

}  // namespace knurl::cli

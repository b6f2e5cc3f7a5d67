#pragma once
// The verbs of `knurl`: one file each. A verb adds itself, its options and its action.

#include <knurl/commandline/command.hpp>
#include <knurl/protocol/servo_address.hpp>

namespace knurl::view {}  // namespace knurl::view

namespace knurl::cli {

using commandline::UsageError;
using namespace view;

/// The servo named by --servo. Throws UsageError.
protocol::ServoAddress servo_said(const std::string& said);

void add_as(commandline::Command& program);
void add_ls(commandline::Command& program);
void add_eval(commandline::Command& program);
void add_latency(commandline::Command& program);
void add_trace(commandline::Command& program);
void add_top(commandline::Command& program);
void add_doctor(commandline::Command& program);
void add_devices(commandline::Command& program);
void add_device(commandline::Command& program);
void add_record(commandline::Command& program);
void add_replay(commandline::Command& program);
void add_reset(commandline::Command& program);
void add_web(commandline::Command& program);
void add_device_check(commandline::Command& device);
void add_device_test(commandline::Command& device);
void add_device_calibrate(commandline::Command& device);

}  // namespace knurl::cli

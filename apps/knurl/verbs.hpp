#pragma once
// The verbs of `knurl`: one file each. A verb adds its subcommand and its options; the one that the command
// line chooses leaves in `run` what it does.

#include <functional>
#include <stdexcept>

namespace CLI {
class App;  // its header brings 100 KB of code into every source that includes it
}

namespace knurl::cli {

/// Returns the exit code, or throws an exception whose text is one line: what was wrong, where, what to do.
using Run = std::function<int()>;

void add_ls(CLI::App& program, Run& run);
void add_eval(CLI::App& program, Run& run);
void add_latency(CLI::App& program, Run& run);
void add_trace(CLI::App& program, Run& run);
void add_top(CLI::App& program, Run& run);
void add_doctor(CLI::App& program, Run& run);
void add_devices(CLI::App& program, Run& run);
void add_device(CLI::App& program, Run& run);
void add_record(CLI::App& program, Run& run);
void add_replay(CLI::App& program, Run& run);
void add_device_check(CLI::App& device, Run& run);
void add_device_test(CLI::App& device, Run& run);

/// What the command line asks for makes no sense: exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

}  // namespace knurl::cli

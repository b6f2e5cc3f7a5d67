#pragma once
// What every program of Knurl does alike around its work: exit codes, the one line that says what went wrong,
// and the signals that stop it.

#include <atomic>
#include <functional>
#include <string>

#include <knurl/commandline/command.hpp>

namespace knurl::commandline {

/// Exit codes.
inline constexpr int could_not = 1, wrong_command_line = 2;

/// The work's exit code; of a UsageError wrong_command_line, of another exception could_not, with one line on
/// standard error: "who: what it says".
int guarded(const std::function<std::string()>& who, const std::function<int()>& work);

/// main(): reads the command line, then does what it asks for.
int run(Command& program, int argc, const char* const* argv);

/// For programs that end by themselves and leave what they have: SIGINT, SIGTERM or SIGHUP sets `stop` from
/// now on. What nohup, or a shell for its background, has ignored stays so.
inline std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");
void stop_on_signals();

}  // namespace knurl::commandline

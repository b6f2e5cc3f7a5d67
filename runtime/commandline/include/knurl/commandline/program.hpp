#pragma once

/// @file
/// What every program of Knurl does alike around its work: exit codes, the one line that says what went
/// wrong, its three standard streams whatever they are, and the signals that stop it.

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>

#include <knurl/commandline/command.hpp>

namespace knurl::commandline {

/// Exit code: the program could not do it.
inline constexpr int could_not = 1;
/// Exit code: the command line makes no sense.
inline constexpr int wrong_command_line = 2;

/// Standard output takes nothing any more.
class OutputError : public std::runtime_error {
  public:
    /// `reason`: an errno; 0: not known.
    explicit OutputError(int reason);
    /// The errno; 0: not known.
    const int reason;
};

/// Prints a text. Throws OutputError: one that is longer than a buffer may fail here, where the reason is known,
/// and not at the end.
void print(const std::string& text);
/// Writes out what was printed. Throws OutputError. For programs that print until they are stopped.
void flush_output();

/// The body of main(). The exit code is the work's; of a UsageError wrong_command_line, of another exception
/// could_not, with one line on standard error: "WHO: what it says". What the work has printed and what could
/// not be written makes a 0 could_not. Around the work:
/// - Descriptors 0 to 2 that are closed are opened, so that no file or socket takes their number: an input that is
///   empty, an output that cannot be written, and an error output that takes anything.
/// - Standard error never fails and never ends a program: a message that cannot be written is dropped.
/// - A reader of standard output that has gone away is an error of that write, and no signal: work is finished and
///   files are whole. At the end the program dies of SIGPIPE nevertheless, without a word, as shells expect.
int guarded(const std::function<std::string()>& who, const std::function<int()>& work);

/// main() of a program with a Command: reads the command line, then runs its action.
int run(Command& program, int argc, const char* const* argv);

/// Path of another program of Knurl: beside this one, where both are installed or in a build tree; else its name alone,
/// for the PATH.
std::string program_beside(const std::string& name);

/// Set by stop_on_signals(); for programs that end by themselves and keep what they have.
inline std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");
/// SIGINT, SIGTERM or SIGHUP sets `stop` from now on. What nohup, or a shell for its background, has ignored
/// stays ignored.
void stop_on_signals();

/// For a gateway, before it starts a thread: its peers wait for it, so it should not wait for every program of this
/// host. With the right to do so it gets a higher priority than these (nice -11), but a lower one than any real-time
/// thread.
void go_before_others();

}  // namespace knurl::commandline

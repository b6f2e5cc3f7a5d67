#pragma once
// The ends of a program: its command line, the signals that stop it, and the file that it leaves no trace of.

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace knurl::measure {

inline std::atomic<bool> stop{false};  // SIGINT, SIGTERM or SIGHUP came
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");

/// Reads the command line into what `app` was told of, then `run()`: its exit code; 2 for a command line that
/// makes no sense, 1 for an exception, each with one line.
template <class Run>
int program_main(CLI::App& app, int argc, char** argv, Run&& run) {
    const auto say = [&](const char* what, const char* more) {
        std::fprintf(stderr, "%s: %s%s\n", app.get_name().c_str(), what, more);
    };
    // The library's ranges let it through.
    for (CLI::Option* option :
         app.get_options([](const CLI::Option* one) { return one->get_type_name().rfind("FLOAT", 0) == 0; }))
        option->check([](const std::string& text) {
            double value = 0;
            const bool none = CLI::detail::lexical_cast(text, value) && std::isnan(value);
            return none ? text + " is no number" : std::string();
        });
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& wanted) {  // --help
        return app.exit(wanted);
    } catch (const CLI::ParseError& error) {
        say(error.what(), ("; see " + app.get_name() + " --help").c_str());
        return 2;
    }
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        // What nohup, or a shell for its background, has ignored stays so.
        if (std::signal(signal, [](int) { stop = true; }) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    try {
        return run();
    } catch (const std::exception& error) {
        say(error.what(), "");
        return 1;
    }
}

/// Of this process; gone with it.
struct TemporaryFile {
    explicit TemporaryFile(const std::string& program)
        : name(std::filesystem::temp_directory_path() / (program + "-" + std::to_string(getpid()) + ".csv")) {
    }
    ~TemporaryFile() { unlink(name.c_str()); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string name;
};

}  // namespace knurl::measure

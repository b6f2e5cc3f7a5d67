#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <system_error>

#include <sys/resource.h>

#include <knurl/commandline/program.hpp>

#include "streams.hpp"

namespace knurl::commandline {

namespace {

std::string output_text(int reason) {
    if (reason == EBADF) return "standard output is closed: the output is lost";
    return std::string("standard output cannot be written") +
           (reason > 0 ? std::string(": ") + std::strerror(reason) : std::string()) +
           "; the output is lost, in part or whole";
}

int complain(const std::string& who, std::string text, int code) {
    for (char& c : text) {
        if (c == '\n') c = ' ';
    }
    std::fprintf(stderr, "%s: %s\n", who.c_str(), text.c_str());
    return code;
}

/// An exception of a failed write to standard output, which says only "cannot write to file".
bool of_output(const std::exception& error) {
    return std::ferror(stdout) != 0 && (dynamic_cast<const std::system_error*>(&error) != nullptr ||
                                        dynamic_cast<const OutputError*>(&error) != nullptr);
}

int reason_of(const std::exception& error) {
    if (const auto* system = dynamic_cast<const std::system_error*>(&error)) return system->code().value();
    const auto* output = dynamic_cast<const OutputError*>(&error);
    return output != nullptr ? output->reason : no_reason;
}

}  // namespace

OutputError::OutputError(int why) : std::runtime_error(output_text(why)), reason(why) {}

void print(const std::string& text) {
    errno = 0;
    if (std::fputs(text.c_str(), stdout) == EOF) throw OutputError(errno);
}

void flush_output() {
    if (const int reason = output_problem()) throw OutputError(reason);
}

int guarded(const std::function<std::string()>& who, const std::function<int()>& work) {
    secure_streams();
    int code = 0, output = 0;
    try {
        code = work();
    } catch (const UsageError& error) {
        code = complain(who(), error.what(), wrong_command_line);
    } catch (const std::exception& error) {
        code = could_not;
        if (of_output(error))
            output = reason_of(error);
        else
            complain(who(), error.what(), could_not);
    }
    if (const int now = output_problem(); output == 0 || output == no_reason) output = now;
    if (output == 0) return code;
    if (output == EPIPE) die_of_broken_pipe();
    complain(who(), output_text(output), could_not);
    return code == 0 ? could_not : code;
}

int run(Command& program, int argc, const char* const* argv) {
    return guarded([&] { return program.chosen_path(); },
                   [&] { return program.parse(argc, argv) == Command::Answer::work ? program.act() : 0; });
}

void stop_on_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        if (std::signal(signal, [](int) { stop = true; }) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
}

void go_before_others() {
    constexpr int nice = -11;
    ::setpriority(PRIO_PROCESS, 0, nice);
}

std::string program_beside(const std::string& name) {
    std::error_code none;
    const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", none).parent_path();
    // In a build tree each has a folder of its own; demos lie one deeper.
    const std::filesystem::path beside = here.parent_path(), above = beside.parent_path();
    for (const std::filesystem::path& candidate : {here / name, beside / name / name, above / name / name})
        if (std::filesystem::is_regular_file(candidate, none)) return candidate.string();
    return name;
}

}  // namespace knurl::commandline

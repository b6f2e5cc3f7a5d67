#include <csignal>
#include <cstdio>
#include <exception>

#include <knurl/commandline/program.hpp>

namespace knurl::commandline {

namespace {

int complain(const std::string& who, std::string text, int code) {
    for (char& c : text) {
        if (c == '\n') c = ' ';
    }
    std::fprintf(stderr, "%s: %s\n", who.c_str(), text.c_str());
    return code;
}

}  // namespace

int guarded(const std::function<std::string()>& who, const std::function<int()>& work) {
    try {
        return work();
    } catch (const UsageError& error) {
        return complain(who(), error.what(), wrong_command_line);
    } catch (const std::exception& error) {
        return complain(who(), error.what(), could_not);
    }
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

}  // namespace knurl::commandline

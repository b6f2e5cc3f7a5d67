// knurl VERB: what people ask of a haptics server from a terminal.

#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "verbs.hpp"

namespace {

constexpr int failed = 1, usage = 2;

/// One line, whatever was thrown.
int complain(const std::string& verb, std::string text, int code) {
    for (char& c : text) {
        if (c == '\n') c = ' ';
    }
    std::fprintf(stderr, "knurl%s%s: %s\n", verb.empty() ? "" : " ", verb.c_str(), text.c_str());
    return code;
}

bool has_verb(CLI::App& program, const std::string& name) {
    return !program.get_subcommands([&](CLI::App* verb) { return verb->get_name() == name; }).empty();
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App program("Looks at Knurl's servos, evaluates scenes without one, measures how late a touch is.",
                     "knurl");
    program.require_subcommand(1);
    program.set_version_flag("--version", "knurl " KNURL_VERSION);
    knurl::cli::Run run;
    knurl::cli::add_ls(program, run);
    knurl::cli::add_eval(program, run);
    knurl::cli::add_latency(program, run);
    knurl::cli::add_top(program, run);
    knurl::cli::add_trace(program, run);
    knurl::cli::add_doctor(program, run);
    knurl::cli::add_record(program, run);
    knurl::cli::add_replay(program, run);
    knurl::cli::add_devices(program, run);
    knurl::cli::add_device(program, run);

    std::string verb;
    if (argc > 1 && argv[1][0] != '-' && !has_verb(program, argv[1])) {
        return complain("", fmt::format("there is no verb '{}'; see knurl --help", argv[1]), usage);
    }
    try {
        program.parse(argc, argv);
        verb = program.get_subcommands().front()->get_name();
        return run();
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
        for (const auto* chosen : program.get_subcommands()) verb = chosen->get_name();
        return complain(
            verb, std::string(error.what()) + "; see knurl " + verb + (verb.empty() ? "" : " ") + "--help",
            usage);
    } catch (const knurl::cli::UsageError& error) {
        return complain(verb, error.what(), usage);
    } catch (const std::exception& error) {
        return complain(verb, error.what(), failed);
    }
}

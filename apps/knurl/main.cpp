// knurl VERB: the tools of a haptics server for the terminal.

#include <stdexcept>

#include <knurl/commandline/program.hpp>

#include "verbs.hpp"

namespace knurl::cli {

protocol::ServoAddress servo_said(const std::string& said) {
    try {
        return protocol::servo_address(said);
    } catch (const std::runtime_error& error) {
        throw UsageError(error.what());
    }
}

}  // namespace knurl::cli

int main(int argc, char** argv) {
    knurl::commandline::Command program(
        "knurl", "Looks at Knurl's servos, evaluates scenes without one, measures how late a touch is.");
    program.requires_verb();
    knurl::cli::add_ls(program);
    knurl::cli::add_eval(program);
    knurl::cli::add_latency(program);
    knurl::cli::add_top(program);
    knurl::cli::add_trace(program);
    knurl::cli::add_doctor(program);
    knurl::cli::add_record(program);
    knurl::cli::add_replay(program);
    knurl::cli::add_reset(program);
    knurl::cli::add_web(program);
    knurl::cli::add_devices(program);
    knurl::cli::add_device(program);
    knurl::cli::add_as(program);
    return knurl::commandline::run(program, argc, argv);
}

// knurl_reference FOLDER: writes the pages of docs/reference/ that come from the tables of the code.

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include <knurl/commandline/program.hpp>
#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/report_names.hpp>
#include <knurl/reps/bounds.hpp>
#include <knurl/scenefile/scene_file.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/servo/config.hpp>
#include <knurl/servo/flight_recorder.hpp>

#include "pages.hpp"

namespace knurl::reference {

std::string table(const std::vector<std::string_view>& columns,
                  const std::vector<std::vector<std::string>>& rows) {
    std::string text = "|";
    for (const std::string_view column : columns) text += fmt::format(" {} |", column);
    text += "\n|";
    for (std::size_t i = 0; i < columns.size(); ++i) text += "---|";
    text += "\n";
    for (const auto& row : rows) {
        text += "|";
        for (const std::string& cell : row) text += fmt::format(" {} |", cell);
        text += "\n";
    }
    return text;
}

namespace {

using Rows = std::vector<std::vector<std::string>>;

struct Column {
    std::string_view name, unit, meaning;
};

/// The CSV columns of the guardian, `knurl replay --csv` and PlotJuggler. Their names are checked against the
/// code's.
constexpr Column report_table[] = {
    {"cycle", "", "number of the cycle, from the start of the servo"},
    {"deadline_ns", "ns", "CLOCK_MONOTONIC: when the cycle should have begun"},
    {"read_ns", "ns", "when the joints had been read"},
    {"write_ns", "ns", "when the efforts had been written"},
    {"q0", "rad", "joints of the device, up to 8 (`q0` to `q7`); m of a sliding one"},
    {"x", "m", "place of the tip (`x`, `y`, `z`), in the device's frame"},
    {"qw", "1", "its orientation (`qw`, `qx`, `qy`, `qz`)"},
    {"vx", "m/s", "velocity (`vx`, `vy`, `vz`), by an adaptive window of 16 ms"},
    {"slow_vx", "m/s", "velocity (`slow_vx`, ...), first order 20 Hz: for prediction"},
    {"wx", "rad/s", "angular velocity (`wx`, `wy`, `wz`)"},
    {"scene_fx", "N", "force of all claims (`scene_fx`, ...), before the supervisor"},
    {"scene_tx", "N m", "torque (`scene_tx`, ...), about the tip, likewise"},
    {"sent_fx", "N", "force that was sent (`sent_fx`, ...), after the supervisor"},
    {"sent_tx", "N m", "torque that was sent (`sent_tx`, ...)"},
    {"contact_x", "m", "where probe 0 touches (`contact_x`, ...); else its place"},
    {"state", "", "of the device, below"},
    {"faults", "", "a bit mask, below"},
    {"buttons", "", "a bit for each button that is down"},
    {"flags", "", "a bit mask, below"},
    {"late_count", "", "cycles so far whose write ended after the next deadline"},
    {"presses", "", "a bit for each button, turned over whenever it goes down"},
    {"touches", "", "how often a touch has begun"},
};

/// Checks that the code's list has these columns in this order.
void check_columns() {
    const std::string all = fmt::format(",{},", servo::report_columns);
    std::size_t at = 0;
    for (const Column& column : report_table) {
        const std::size_t found = all.find(fmt::format(",{},", column.name), at);
        if (found == std::string::npos)
            throw std::runtime_error(fmt::format("report.md: there is no column {}", column.name));
        at = found;
    }
}

template <class Names>
std::string names_table(const Names& names, std::string_view number) {
    Rows rows;
    for (const protocol::ReportName& one : names)
        rows.push_back({fmt::format("{}", one.value), std::string(one.name), std::string(one.meaning)});
    return table({number, "name", "meaning"}, rows);
}

std::string report() {
    check_columns();
    Rows columns;
    for (const Column& column : report_table)
        columns.push_back(
            {fmt::format("`{}`", column.name), std::string(column.unit), std::string(column.meaning)});
    return "# Reports\n\n"
           "What the servo publishes in each cycle of a device, and what a recording has. In C++ it is "
           "`knurl::Report`\n"
           "([report.hpp](../../runtime/protocol/include/knurl/protocol/report.hpp)). An application reads "
           "it in its own "
           "world frame; a\nCSV has the device's frame: origin in the middle of the workspace, x away from "
           "the base, z "
           "up.\n\n## Columns of a CSV\n\nWritten by `knurl replay --csv` and by the guardian when a servo "
           "dies "
           "(there, lines with # come first).\n\n" +
           table({"column", "unit", "meaning"}, columns) + "\n## States\n\n" +
           names_table(protocol::state_names, "`state`") + "\n## Faults\n\n" +
           names_table(protocol::fault_names, "bit of `faults`") +
           "\n[What to do about each](../howto/troubleshooting.md#fault).\n\n## Flags\n\n" +
           names_table(protocol::flag_names, "bit of `flags`");
}

Rows key_rows(std::span<const scenefile::KeyInfo> keys) {
    Rows rows;
    for (const scenefile::KeyInfo& key : keys)
        rows.push_back({fmt::format("`{}`", key.name), std::string(key.value), std::string(key.meaning)});
    return rows;
}

std::string scene_file() {
    return "# Scene files\n\n"
           "A scene as TOML, for `knurl eval` and `knurl replay --scene`. One table for each representation, "
           "named as its "
           "kind\n(`[[plane]]`, `[[spring]]`, ...), with [the keys of its fields](representations.md) and "
           "these. "
           "[The chapter](../../runtime/scenefile/README.md)\nhas examples.\n\n## Every table\n\n" +
           table({"key", "takes; default", "meaning"}, key_rows(scenefile::entry_keys())) +
           "\n## Probes\n\n`[[probe]]`: probe 0, then 1, ...\n\n" +
           table({"key", "unit", "range", "default", "meaning"}, probe_keys()) +
           "\n## Assets\n\n`[[asset]]`: asset 1, then 2, ..., which a `[[shape]]` names. One of three forms: "
           "a mesh from a "
           "file, triangles, or heights.\n\n" +
           table({"key", "takes; default", "meaning"}, key_rows(scenefile::asset_keys()));
}

/// The lines of config_help(), "  KEY   TEXT", as rows.
Rows config_rows() {
    constexpr std::size_t key_at = 2, text_at = 39;
    Rows rows;
    std::istringstream lines(servo::config_help());
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("  ") || line.size() <= text_at) continue;
        const std::string key = line.substr(key_at, line.find_last_not_of(' ', text_at - 1) + 1 - key_at);
        rows.push_back({fmt::format("`{}`", key), line.substr(text_at)});
    }
    return rows;
}

std::string configuration() {
    return "# Configuration of knurld\n\n"
           "Keys of the TOML file that `knurld --config` reads. The command line wins over the file. `knurld "
           "--check-config FILE` checks one\nand starts nothing. Limits can only be tightened. "
           "[An example with every key](../../apps/knurld/example.toml).\n\n" +
           table({"key", "takes"}, config_rows());
}

const Rows& exit_codes() {
    static const Rows rows{
        {"0", "done"},
        {fmt::format("{}", commandline::could_not),
         "it could not, or a verdict that says no; one line on standard error"},
        {fmt::format("{}", commandline::wrong_command_line),
         "the command line makes no sense, or a file that it names is wrong"},
        {"130", "Ctrl-C ended `knurl-surface`, or `knurl-feel` before the servo had the mesh"},
        {"128 + n",
         "signal n ended the program, as a shell reports it. 141 is SIGPIPE: the reader of a pipe has gone; "
         "the work was finished. 134 and 139 are errors of the program: report them"},
    };
    return rows;
}

/// tests/build/reference.py compares these with the variables that the sources read.
const Rows& environment() {
    static const Rows rows{
        {"`KNURL_RUNTIME_DIR`", "all",
         "folder of the servo's socket, in place of `/run/knurl` (root) or `$XDG_RUNTIME_DIR/knurl`"},
        {"`KNURL_STATE_DIR`", "knurld",
         "folder of flight records, in place of `/var/lib/knurl` (root) or `$XDG_STATE_HOME/knurl`"},
        {"`KNURL_KEY`", "applications", "file with the one line of a bridge's keys that is yours, mode 0600"},
        {"`KNURL_HINTS`", "applications", "`0`: no hints about a forgotten `arm` or `commit`"},
        {"`KNURL_ARMS_DIR`", "knurld, knurl",
         "where arm files are looked for besides those that are built in"},
        {"`KNURL_LIBDHD`", "knurld, knurl devices",
         "Force Dimension's library, or its folder, for devices `dhd:`, where it is not in a usual folder"},
        {"`KNURL_LIBHD`", "knurld, knurl devices",
         "OpenHaptics' libHD.so, or its folder, for devices `hd:`, where it is not in a usual folder"},
        {"`KNURL_DEVICE_PROGRAM`", "knurld", "path of `knurl-device`, where it is not beside knurld"},
        {"`KNURL_AS_SERVO`", "knurl as", "the servo whose devices a program is given; `knurl as` sets it"},
        {"`KNURL_AS_DEVICES`", "knurl as",
         "those devices, `[NAME=][SERVO/]DEVICE` with commas between; `knurl as` sets it"},
        {"`LD_LIBRARY_PATH`", "knurl as, knurld",
         "`knurl as` puts its libraries before it; makers' libraries are looked for there, too"},
        {"`XDG_RUNTIME_DIR`", "all", "of a user without `KNURL_RUNTIME_DIR`"},
        {"`ROS_DOMAIN_ID`", "knurl-dds, applications",
         "number of the DDS domain; for `knurl://SERVO/DEVICE` not set: any of which a registry runs here"},
        {"`XDG_STATE_HOME`", "knurld", "of a user without `KNURL_STATE_DIR`; else `$HOME/.local/state`"},
        {"`HOME`", "knurld", "see `XDG_STATE_HOME`"},
        {"`NO_COLOR`", "knurl top", "set: no colours"},
        {"`TERM`", "knurl top", "`dumb` or not set: no page that is written anew"},
    };
    return rows;
}

Rows bounds() {
    const auto row = [](const char* what, auto value) {
        return std::vector<std::string>{what, fmt::format("{}", value)};
    };
    return {
        row("devices of a servo", protocol::max_devices),
        row("clients of a device", protocol::max_clients),
        row("connections of a servo", servo::broker_bounds::connections),
        row("connections that have not introduced themselves", servo::broker_bounds::half_open),
        row("claims and observers of a connection", protocol::max_claims_of_connection),
        row("representations of a claim", max_representations),
        row("representations of a claim that states nothing", protocol::default_representations),
        row("probes of a claim", max_probes),
        row("bytes of parameters of a representation", max_parameter_bytes),
        row("bytes of parameters of a claim", protocol::max_batch_bytes),
        row("assets of a claim", max_assets),
        row("joints of a device", protocol::max_joints),
        row("cells of commands waiting, of a claim", protocol::max_command_cells),
        row("cells of commands done in a cycle, of a claim", protocol::command_cells_per_cycle),
        row("cells of replies waiting, of a claim", protocol::reply_cells),
        row("reports kept", protocol::report_slots - 1),
        row("characters of a name", protocol::name_bytes - 1),
    };
}

std::string programs() {
    return "# Exit codes, environment, bounds\n\nThe same for all programs. Options are in `--help` of each "
           "program and in "
           "its man page.\n\n## Exit codes\n\n" +
           table({"code", "means"}, exit_codes()) + "\n## Environment variables\n\n" +
           table({"variable", "read by", "meaning"}, environment()) + "\n## Bounds\n\n" +
           table({"what", "at most"}, bounds());
}

constexpr const char* origin =
    "<!-- Printed by knurl_reference from the tables of the code: change those, and run scripts/reference. "
    "-->\n\n";

void write(const std::filesystem::path& path, std::string text) {
    while (text.ends_with("\n\n")) text.pop_back();
    std::ofstream file(path);
    file << origin << text;
    if (!file.flush()) throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
}

}  // namespace

int write_all(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    write(folder / "representations.md", representations());
    write(folder / "report.md", report());
    write(folder / "scene-file.md", scene_file());
    write(folder / "configuration.md", configuration());
    write(folder / "programs.md", programs());
    return 0;
}

}  // namespace knurl::reference

int main(int argc, char** argv) {
    return knurl::commandline::guarded(
        [] { return std::string("knurl_reference"); },
        [&] {
            if (argc != 2) throw knurl::commandline::UsageError("give the folder to write to");
            return knurl::reference::write_all(argv[1]);
        });
}

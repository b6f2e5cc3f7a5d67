// knurl devices: which devices are plugged in, what is missing, and the command that fixes it.

#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/usb_list.hpp>
#include <knurl/drivers/vendor_library.hpp>
#include <knurl/json/json.hpp>
#include <knurl/view/servo_view.hpp>

#include "verbs.hpp"

namespace knurl::cli {

namespace {

using drivers::UsbDevice;
using json = knurl::Json;

struct Seen {
    UsbDevice device;
    std::string held_by;  // "left of knurl:default (pid 12)"
    std::string problem;  // empty: ready
    std::string mend;     // the command
};

std::string holder(const UsbDevice& device, const std::vector<ServoView>& servos) {
    for (const ServoView& servo : servos) {
        for (const DeviceView& view : servo.devices) {
            const std::string_view address = view.info.address;
            const bool named = !device.serial.empty() && view.info.serial == device.serial;
            const bool by_port = address.find("port=" + device.port) != std::string_view::npos;
            if (address.starts_with(device.scheme + ":") && (named || by_port))
                return fmt::format("{} of knurl:{} (pid {})", view.info.name, servo.name, servo.pid);
        }
    }
    return "";
}

Seen inspect(const UsbDevice& device, const std::vector<ServoView>& servos) {
    Seen seen{.device = device, .held_by = holder(device, servos), .problem = {}, .mend = {}};
    if (!seen.held_by.empty()) return seen;
    if (device.claimed) {
        seen.problem = "another program holds it";
        seen.mend = fmt::format("sudo fuser -v {} shows which; end it", device.node);
        return seen;
    }
    if (device.accessible) return seen;
    const drivers::NoRights why = drivers::no_rights(device);
    seen.problem = why.problem;
    seen.mend = why.mend;
    return seen;
}

/// A remark before it is opened; empty: none, or it is open.
std::string note_of(const Seen& seen) {
    if (!seen.held_by.empty() || !seen.problem.empty()) return "";
    for (const drivers::Driver& driver : drivers::drivers())
        if (driver.scheme == seen.device.scheme) return driver.note;
    return "";
}

/// What is known of a maker's library: found as a file, and tried by a process of its own that opens no device.
struct Tried {
    std::string scheme, product, path, version;
    int devices = -1;  // that it sees; -1: it does not tell
    std::string problem, mend;
};

std::string device_program() {
    namespace fs = std::filesystem;
    const fs::path here = fs::read_symlink("/proc/self/exe").parent_path();
    for (const fs::path& candidate :
         {here / "knurl-device", here.parent_path() / "knurl-device" / "knurl-device"})
        if (fs::is_regular_file(candidate)) return candidate.string();
    return "";
}

/// Loads the library in knurl-device, which may crash or hang in it.
void load(Tried& tried) {
    const std::string program = device_program();
    if (program.empty()) {
        tried.problem = "not tried: there is no knurl-device beside this program";
        tried.mend = "sudo apt install knurl-server";
        return;
    }
    const std::string command = fmt::format("timeout 5 '{}' {} --try 2>&1", program, tried.scheme);
    FILE* output = ::popen(command.c_str(), "r");
    if (output == nullptr) return;
    std::string said;
    std::array<char, 256> part{};
    while (std::fgets(part.data(), part.size(), output) != nullptr) said += part.data();
    const int status = ::pclose(output);
    std::istringstream lines(said);
    std::string line, first;
    std::getline(lines, first);
    if (status != 0) {
        const bool late = WIFEXITED(status) && WEXITSTATUS(status) == 124;
        tried.problem = late ? "it does not return within 5 s when it is asked for its version"
                        : first.empty()
                            ? "it crashes when it is asked for its version"
                            : first.substr(first.find(": ") == std::string::npos ? 0 : first.find(": ") + 2);
        return;
    }
    tried.version = first.substr(0, first.find('\t'));
    if (tried.scheme == "hd") return;  // it lists no devices
    tried.devices = 0;
    while (std::getline(lines, line)) tried.devices += line.starts_with("device\t") ? 1 : 0;
}

std::vector<Tried> libraries() {
    std::vector<Tried> all;
    for (const drivers::VendorLibrary& library : drivers::vendor_libraries()) {
        Tried tried{.scheme = library.scheme,
                    .product = library.product,
                    .path = {},
                    .version = {},
                    .problem = {},
                    .mend = {}};
        try {
            const auto found = drivers::find_library(library);
            if (found.empty()) {
                tried.problem = "there is no " + library.names.front() + " where it was looked for";
                tried.mend = library.remedy;
            } else {
                tried.path = found.front().path;
                tried.problem = found.front().problem;
                if (tried.problem.empty()) load(tried);
            }
        } catch (const std::runtime_error& error) {
            tried.problem = error.what();
        }
        all.push_back(tried);
    }
    return all;
}

void print_libraries(const std::vector<Tried>& all) {
    for (const Tried& tried : all) {
        fmt::print(
            "{}:  {}{}{}: {}\n", tried.scheme, tried.product,
            tried.version.empty() ? "" : " " + tried.version, tried.path.empty() ? "" : ", " + tried.path,
            !tried.problem.empty() ? tried.problem
            : tried.devices >= 0
                ? fmt::format("loads; it sees {} device{}", tried.devices, tried.devices == 1 ? "" : "s")
                : "loads; it tells no devices before one is opened");
        if (!tried.mend.empty()) fmt::print("  mend it: {}\n", tried.mend);
    }
}

void print_text(const std::vector<Seen>& plugged, const std::string& no_usb) {
    if (!no_usb.empty()) {
        fmt::print("USB devices cannot be listed: {}\n", no_usb);
    } else if (plugged.empty()) {
        fmt::print("nothing that Knurl drives is plugged into USB\n");
    }
    for (const Seen& seen : plugged) {
        fmt::print("{}  {} at {} ({}): {}\n", seen.device.address(),
                   seen.device.name.empty() ? seen.device.scheme : seen.device.name, seen.device.port,
                   seen.device.node,
                   !seen.problem.empty()  ? seen.problem
                   : seen.held_by.empty() ? "ready"
                                          : "run as " + seen.held_by);
        if (!seen.mend.empty()) fmt::print("  mend it: {}\n", seen.mend);
        if (!note_of(seen).empty()) fmt::print("  {}\n", note_of(seen));
    }
    fmt::print("drivers of this build, for knurld --device:\n");
    for (const drivers::Driver& driver : drivers::drivers())
        fmt::print("  {}:{}\n", driver.scheme, driver.help);
    if (!plugged.empty() && plugged.front().problem.empty())
        fmt::print("try one: knurl device test {}\n", plugged.front().device.address());
}

int list(bool as_json) {
    std::vector<UsbDevice> found;
    std::string no_usb;
    try {
        found = drivers::usb_devices();
    } catch (const std::runtime_error& error) {
        no_usb = error.what();
    }
    const std::vector<ServoView> servos = look_at_all();
    std::vector<Seen> plugged;
    for (const UsbDevice& device : found) plugged.push_back(inspect(device, servos));
    const std::vector<Tried> makers = libraries();
    if (!as_json) {
        print_text(plugged, no_usb);
        fmt::print("libraries of makers, which Knurl loads and does not have:\n");
        print_libraries(makers);
        return 0;
    }
    const auto or_null = [](const std::string& text) { return text.empty() ? json() : json(text); };
    json devices = json::array();
    for (const Seen& seen : plugged) {
        devices.push_back({{"address", seen.device.address()},
                           {"driver", seen.device.scheme},
                           {"name", or_null(seen.device.name)},
                           {"serial", or_null(seen.device.serial)},
                           {"port", seen.device.port},
                           {"node", seen.device.node},
                           {"vendor", seen.device.vendor},
                           {"product", seen.device.product},
                           {"accessible", seen.device.accessible},
                           {"claimed", seen.device.claimed},
                           {"run_as", or_null(seen.held_by)},
                           {"problem", or_null(seen.problem)},
                           {"mend", or_null(seen.mend)},
                           {"note", or_null(note_of(seen))}});
    }
    json known = json::array();
    for (const drivers::Driver& driver : drivers::drivers())
        known.push_back({{"scheme", driver.scheme}, {"help", driver.help}});
    json loaded = json::array();
    for (const Tried& tried : makers)
        loaded.push_back({{"driver", tried.scheme},
                          {"sdk", tried.product},
                          {"path", or_null(tried.path)},
                          {"sdk_version", or_null(tried.version)},
                          {"devices", tried.devices < 0 ? json() : json(tried.devices)},
                          {"problem", or_null(tried.problem)},
                          {"mend", or_null(tried.mend)}});
    fmt::print(
        "{}\n",
        json{{"devices", devices}, {"drivers", known}, {"libraries", loaded}, {"problem", or_null(no_usb)}}
            .dump(2));
    return 0;
}

}  // namespace

void add_devices(commandline::Command& program) {
    auto& verb = program.verb(
        "devices",
        "Lists the devices that are plugged in, what is missing (rights, firmware), and the remedy");
    auto as_json = std::make_shared<bool>(false);
    verb.flag("--json", *as_json, "the same for programs");
    verb.footer("Opens no device. Nothing plugged in is an answer too: exit code 0.");
    verb.action([as_json] { return list(*as_json); });
}

}  // namespace knurl::cli

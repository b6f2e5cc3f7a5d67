// knurl as: starts a program that was written for a vendor's library, with a library of the same name and functions over a
// Knurl servo.

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/commandline/program.hpp>

#include "verbs.hpp"

namespace knurl::cli {

namespace {

namespace fs = std::filesystem;

struct Wish {
    std::string servo = "default";
    std::vector<std::string> devices;
    std::vector<std::string> words;  // the program and its arguments
};

/// The folder of the look-alike, "as-dhd". Throws std::runtime_error.
fs::path folder_of(const std::string& name, const std::string& library) {
    const fs::path here = fs::read_symlink("/proc/self/exe").parent_path();
    // As installed; in a build tree.
    for (const fs::path& candidate : {here.parent_path() / KNURL_LIBDIR / "knurl" / name,
                                      here.parent_path().parent_path() / "runtime" / "lookalike" / name})
        if (fs::exists(candidate / library)) return fs::weakly_canonical(candidate);
    throw std::runtime_error("the library that looks like " + library +
                             " is not installed; it is in the package knurl-lookalikes");
}

/// A device that is named must be there: what the program itself says later is seldom to the point. Throws Error,
/// std::runtime_error.
void require_devices(const Wish& wish) {
    std::vector<std::string> said = wish.devices;
    if (said.empty()) said.emplace_back();
    for (std::string device : said) {
        if (const std::size_t equals = device.find('='); equals != std::string::npos)
            device.erase(0, equals + 1);
        const std::size_t slash = device.rfind('/');
        const std::string name = slash == std::string::npos ? device : device.substr(slash + 1);
        const Client client = Client::connect(
            slash == std::string::npos ? wish.servo : device.substr(0, slash), {.hints = false});
        std::vector<std::string> names;
        for (const DeviceDescription& one : client.devices()) names.push_back(one.name);
        if (names.empty()) throw std::runtime_error("the servo has no device");
        if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end())
            throw std::runtime_error("the servo has no device '" + name + "'; " +
                                     protocol::instead_of_device(name, names));
    }
}

void set(const char* name, const std::string& value) {
    ::setenv(name, value.c_str(), 1);
}

int start(Wish& wish, const std::string& folder, const std::string& library) {
    const fs::path path = folder_of(folder, library);
    require_devices(wish);
    const char* before = std::getenv("LD_LIBRARY_PATH");
    set("LD_LIBRARY_PATH",
        path.string() + (before == nullptr || *before == '\0' ? "" : ":" + std::string(before)));
    if (folder == "as-dhd") {
        // Where Python's bindings look, before they look anywhere else.
        set("FDSDK", path.string());
        set("FORCEDIM_SDK", path.string());
    }
    set("KNURL_AS_SERVO", wish.servo);
    std::string devices;
    for (const std::string& device : wish.devices) devices += (devices.empty() ? "" : ",") + device;
    set("KNURL_AS_DEVICES", devices);

    std::vector<char*> argv;
    for (std::string& word : wish.words) argv.push_back(word.data());
    argv.push_back(nullptr);
    commandline::flush_output();
    ::execvp(argv[0], argv.data());
    const int why = errno;
    std::fprintf(stderr, "knurl as: '%s' cannot be started: %s\n", argv[0], std::strerror(why));
    constexpr int not_found = 127, not_startable = 126;  // as shells have it
    return why == ENOENT ? not_found : not_startable;
}

void add(commandline::Command& as, const std::string& name, const std::string& purpose,
         const std::string& library) {
    auto wish = std::make_shared<Wish>();
    auto& verb = as.verb(name, purpose);
    verb.option("--servo", wish->servo, "The servo's name, or knurl://HOST:PORT")
        .type_name("NAME")
        .shows_default();
    verb.option("--device", wish->devices,
                "A device that the program finds, in this order; repeated for several. All of the servo's "
                "without it")
        .type_name("[SERVO/]DEVICE");
    verb.words_behind_dashes(wish->words);
    verb.footer("The program and its arguments stand behind --: knurl as " + name +
                " --device right -- ./my_program");
    verb.action([wish, name, library] { return start(*wish, "as-" + name, library); });
}

}  // namespace

void add_as(commandline::Command& program) {
    auto& as =
        program.verb("as",
                     "Starts a program that was written for Force Dimension's or 3D Systems' library on a "
                     "Knurl device");
    as.requires_verb();
    add(as, "dhd", "With a libdhd.so.3 and libdrd.so.3 over a Knurl servo", "libdhd.so.3");
    add(as, "hd", "With a libHD.so (OpenHaptics) over a Knurl servo", "libHD.so");
}

}  // namespace knurl::cli

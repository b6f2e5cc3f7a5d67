#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <elf.h>
#include <glob.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/drivers/vendor_library.hpp>

namespace knurl::drivers {

namespace {

#if defined(__x86_64__)
constexpr unsigned this_machine = EM_X86_64;
constexpr const char* this_machine_name = "x86-64";
#elif defined(__aarch64__)
constexpr unsigned this_machine = EM_AARCH64;
constexpr const char* this_machine_name = "aarch64";
#else
constexpr unsigned this_machine = EM_NONE;  // any
constexpr const char* this_machine_name = "this machine";
#endif

std::vector<std::string> matching(const std::string& pattern) {
    std::vector<std::string> paths;
    glob_t found{};
    if (glob(pattern.c_str(), GLOB_TILDE, nullptr, &found) == 0)
        for (std::size_t i = 0; i < found.gl_pathc; ++i) paths.emplace_back(found.gl_pathv[i]);
    globfree(&found);
    std::ranges::reverse(paths);  // the newest version of several
    return paths;
}

std::vector<std::string> parts(const char* text) {
    std::vector<std::string> all;
    for (std::string rest = text == nullptr ? "" : text; !rest.empty();) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        if (end > 0) all.push_back(rest.substr(0, end));
        rest.erase(0, end + 1);
    }
    return all;
}

/// Folders of the loader that every system has, and those of ld.so.conf's simple lines.
std::vector<std::string> system_folders() {
    std::vector<std::string> all;
    for (const std::string& file : matching("/etc/ld.so.conf.d/*.conf")) {
        std::ifstream lines(file);
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with('/')) all.push_back(line);
    }
    for (const char* usual : {"/usr/local/lib", "/usr/lib", "/lib", "/usr/lib64", "/lib64"})
        all.emplace_back(usual);
    return all;
}

bool is_folder(const std::string& path) {
    struct stat info = {};
    return stat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode);
}

std::vector<std::string> places(const VendorLibrary& library) {
    std::vector<std::string> folders = parts(std::getenv("LD_LIBRARY_PATH"));
    const std::vector<std::string> system = system_folders();
    folders.insert(folders.end(), system.begin(), system.end());
    for (const std::string& folder : library.folders)
        for (const std::string& path : matching(folder)) folders.push_back(path);
    std::vector<std::string> files;
    for (const std::string& name : library.names)
        for (const std::string& folder : folders) files.push_back(folder + "/" + name);
    return files;
}

std::vector<std::string> named(const VendorLibrary& library, const std::string& given) {
    if (!is_folder(given)) return {given};
    std::vector<std::string> files;
    for (const std::string& name : library.names)
        if (access((given + "/" + name).c_str(), F_OK) == 0) files.push_back(given + "/" + name);
    if (files.empty())
        throw std::runtime_error(library.variable + "=" + given + ": the folder has no " +
                                 library.names.front() + "; name the folder or the file of the " +
                                 library.product);
    return files;
}

}  // namespace

const std::vector<VendorLibrary>& vendor_libraries() {
    static const std::vector<VendorLibrary> all = {
        {.scheme = "dhd",
         .product = "Force Dimension SDK",
         .variable = "KNURL_LIBDHD",
         .names = {"libdhd.so.3", "libdrd.so.3", "libdhd.so", "libdrd.so"},
         .folders = {"/opt/force-dimension/sdk-*/lib/release/lin-*", "/opt/sdk-3.*/lib/release/lin-*",
                     "/usr/local/sdk-3.*/lib/release/lin-*", "~/sdk-3.*/lib/release/lin-*", "~/.local/lib"},
         .remedy = "unpack the SDK 3.14 to 3.17 from forcedimension.com and set KNURL_LIBDHD to its folder "
                   "lib/release/lin-x86_64-gcc"},
        {.scheme = "hd",
         .product = "OpenHaptics",
         .variable = "KNURL_LIBHD",
         .names = {"libHD.so", "libHD.so.3.4", "libHD.so.3"},
         .folders = {"/opt/OpenHaptics/*/lib", "/opt/OpenHaptics/Developer/*/lib64", "/usr/lib/openhaptics",
                     "~/OpenHaptics/*/lib", "~/openhaptics*/usr/lib"},
         .remedy = "install OpenHaptics for Linux and the Touch device driver from 3D Systems (both: install "
                   "scripts "
                   "in their archives), then name libHD.so or its folder in KNURL_LIBHD if it is elsewhere"},
    };
    return all;
}

const VendorLibrary* vendor_library(const std::string& scheme) {
    const auto found = std::ranges::find(vendor_libraries(), scheme, &VendorLibrary::scheme);
    return found == vendor_libraries().end() ? nullptr : &*found;
}

std::string why_not_loadable(const std::string& path) {
    struct stat info = {};
    if (stat(path.c_str(), &info) != 0) return std::strerror(errno);
    if (!S_ISREG(info.st_mode)) return "it is no file";
    if (access(path.c_str(), R_OK) != 0)
        return std::string(std::strerror(errno)) + "; let this user read it: sudo chmod a+r " + path;
    std::array<unsigned char, 20> head{};
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(head.data()), head.size());
    if (file.gcount() != static_cast<std::streamsize>(head.size()) ||
        std::memcmp(head.data(), ELFMAG, SELFMAG) != 0)
        return "it is no shared library (an archive, a script for the linker, a file that Git LFS left?)";
    const unsigned kind = head[16] | static_cast<unsigned>(head[17]) << 8;
    const unsigned machine = head[18] | static_cast<unsigned>(head[19]) << 8;
    if (head[EI_CLASS] != ELFCLASS64)
        return "it has 32 bits, this program 64: take the maker's 64-bit library";
    if (this_machine != EM_NONE && machine != this_machine)
        return std::string("it is for another processor than ") + this_machine_name;
    return kind == ET_DYN ? "" : "it is no shared library";
}

std::vector<FoundLibrary> find_library(const VendorLibrary& library) {
    const char* given = std::getenv(library.variable.c_str());
    const bool stated = given != nullptr && *given != '\0';
    std::vector<FoundLibrary> found;
    for (const std::string& path : stated ? named(library, given) : places(library)) {
        if (!stated && access(path.c_str(), F_OK) != 0) continue;
        if (std::ranges::find(found, path, &FoundLibrary::path) == found.end())
            found.push_back({path, why_not_loadable(path)});
    }
    std::stable_partition(found.begin(), found.end(),
                          [](const FoundLibrary& one) { return one.problem.empty(); });
    return found;
}

}  // namespace knurl::drivers

#include "library.hpp"

#include <stdexcept>

#include <dlfcn.h>

#include <knurl/drivers/vendor_library.hpp>

namespace knurl::device {

namespace {

/// What to do about "libQt5Core.so.5: cannot open shared object file: ...".
std::string remedy(const std::string& error) {
    const std::size_t end = error.find(": cannot open shared object file");
    if (end == std::string::npos) return "";
    const std::string file = error.substr(0, end);
    std::string package = "apt-file search " + file + " names the package that has it";
    if (file.starts_with("libQt5Core")) package = "sudo apt install libqt5core5a";
    if (file.starts_with("libusb-1.0")) package = "sudo apt install libusb-1.0-0";
    if (file.starts_with("libncurses") || file.starts_with("libtinfo"))
        package = "sudo apt install libtinfo5 libncurses5";
    return "; it wants " + file + ": " + package;
}

}  // namespace

Library::Library(const std::string& path) : path_(path) {
    const std::string problem = drivers::why_not_loadable(path);
    if (!problem.empty()) throw std::runtime_error("cannot use " + path + ": " + problem);
    handle_ = dlopen(path.c_str(), RTLD_NOW | RTLD_GLOBAL);
    if (handle_ != nullptr) return;
    const char* said = dlerror();
    const std::string error = said == nullptr ? "no reason given" : said;
    throw std::runtime_error("cannot load " + path + ": " + error + remedy(error));
}

void* Library::find(const char* name) const {
    return dlsym(handle_, name);
}

void Library::missing(const char* name) const {
    throw std::runtime_error(path_ + " has no function " + name +
                             ": it is another library, or a version that Knurl does not know");
}

}  // namespace knurl::device

#include <filesystem>

#include <knurl/measure/script.hpp>

namespace knurl::measure {

std::string script(const std::string& name) {
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    const auto installed = program.parent_path().parent_path() / "share/knurl/scripts" / name;
    return std::filesystem::exists(installed, unknown) ? installed.string() : "scripts/" + name;
}

}  // namespace knurl::measure

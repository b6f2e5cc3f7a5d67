#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <knurl/measure/output_file.hpp>

namespace knurl::measure {

namespace {

void write_to(const std::string& name, const std::string& text, const std::string& path) {
    errno = 0;
    std::ofstream file(name, std::ios::binary | std::ios::trunc);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (file) return;
    const std::string why = std::strerror(errno);
    if (name != path) std::remove(name.c_str());
    throw std::runtime_error(path + ": cannot be written: " + why);
}

/// The path at which a file is written before it is renamed; a pipe or a device is written directly.
std::string beside(const std::string& path) {
    std::error_code ignored;
    const auto there = std::filesystem::status(path, ignored).type();
    const bool itself =
        there != std::filesystem::file_type::regular && there != std::filesystem::file_type::not_found;
    return itself ? path : path + ".part";
}

}  // namespace

void write_file(const std::string& path, const std::string& text) {
    if (path == "-") {
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
            throw std::runtime_error(std::string("standard output: ") + std::strerror(errno));
        return;
    }
    const std::string part = beside(path);
    write_to(part, text, path);
    if (part != path && std::rename(part.c_str(), path.c_str()) != 0)
        throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
}

void require_writable(const std::string& path) {
    if (path == "-") return;
    const std::string part = beside(path);
    if (part == path) return;
    write_to(part, "", path);
    std::remove(part.c_str());
}

}  // namespace knurl::measure

#pragma once
// A file that is removed at the end.

#include <filesystem>
#include <string>

#include <unistd.h>

namespace knurl::measure {

/// Of this process; gone with it.
struct TemporaryFile {
    explicit TemporaryFile(const std::string& program)
        : name(std::filesystem::temp_directory_path() / (program + "-" + std::to_string(getpid()) + ".csv")) {
    }
    ~TemporaryFile() { unlink(name.c_str()); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string name;
};

}  // namespace knurl::measure

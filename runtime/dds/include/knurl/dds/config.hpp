#pragma once

/// @file
/// The configuration of knurl-dds: a TOML file.

#include <filesystem>
#include <stdexcept>
#include <string>

#include <knurl/dds/domain.hpp>
#include <knurl/dds/robot_side.hpp>

namespace knurl::dds {

/// All that the program is told.
struct Config {
    /// Which domain, and by which network.
    DomainOptions domain{};
    /// What is shown of the servo.
    RobotOptions robot{};
    /// Its name in the registry; empty: made of the servo's and the host's.
    std::string name{};
    /// HOST:PORT of its bridge, as others reach it; empty: none.
    std::string bridge{};
};

/// Reads a file into `config`, over what is there. Throws std::runtime_error, one line: "file:line:column: what; what to do".
void read_config(const std::filesystem::path& file, Config& config);
/// The same of a text; `path` is what it names.
void read_config_text(const std::string& text, const std::string& path, Config& config);

/// "lab" of servo "default" on host "lab"; else the servo's own name.
std::string default_name(const std::string& servo, const std::string& host);

}  // namespace knurl::dds

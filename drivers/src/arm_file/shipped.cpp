// Arms by name: built in, or in folders.

#include "arm_file/shipped.hpp"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/words/nearest.hpp>

namespace knurl::drivers {

std::vector<std::string> shipped_arms() {
    std::vector<std::string> names;
    for (const ShippedArm& arm : shipped) names.emplace_back(arm.name);
    return names;
}

ArmFile find_arm(const std::string& name) {
    if (name.find('/') != std::string::npos || name.ends_with(".toml")) return load_arm(name);
    std::string known;
    for (const ShippedArm& arm : shipped) {
        if (arm.name == name) return parse_arm(arm.text, "arms/" + name + ".toml");
        known += (known.empty() ? "" : ", ") + std::string(arm.name);
    }
    const char* own = std::getenv("KNURL_ARMS_DIR");
    for (const std::string& folder : {std::string(own == nullptr ? "" : own), std::string(installed_arms)}) {
        const std::filesystem::path path = std::filesystem::path(folder) / (name + ".toml");
        std::error_code ignored;
        if (!folder.empty() && std::filesystem::is_regular_file(path, ignored))
            return load_arm(path.string());
    }
    throw std::runtime_error(
        "no arm \"" + name + "\"; there are " + known +
        ", or give a file: ./my_arm.toml (bare names are also looked for in $KNURL_ARMS_DIR and " +
        std::string(installed_arms) + ")" + words::meant(name, shipped_arms()));
}

}  // namespace knurl::drivers

#include "material.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

namespace feel {

namespace {

struct Share {
    const char* name;
    double knurl::AssetMaterial::*of;
    double most;
};
constexpr Share shares[] = {{"stiffness", &knurl::AssetMaterial::stiffness, 1},
                            {"damping", &knurl::AssetMaterial::damping, 1e3},
                            {"friction", &knurl::AssetMaterial::friction, 1e3}};

[[noreturn]] void bad(const std::string& setting, const std::string& text) {
    throw std::runtime_error(fmt::format("--material {}: {}", setting, text));
}

knurl::AssetMaterial read(const std::string& setting, std::string_view rest) {
    knurl::AssetMaterial material;
    for (const Share& share : shares) {
        const std::string_view word = rest.substr(0, rest.find(','));
        double& value = material.*share.of;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !(value >= 0 && value <= share.most))
            bad(setting,
                fmt::format("\"{}\" is no share of {}; give 0 to {:g}", word, share.name, share.most));
        if (word.size() == rest.size()) return material;
        rest.remove_prefix(word.size() + 1);
    }
    bad(setting, "more than three shares; give NAME=STIFFNESS,DAMPING,FRICTION");
}

}  // namespace

std::vector<knurl::AssetMaterial> materials_of(const std::vector<std::string>& names,
                                               const std::vector<std::string>& settings) {
    if (settings.empty()) return {};
    std::vector<knurl::AssetMaterial> materials(names.size());
    for (const std::string& setting : settings) {
        const std::size_t cut = setting.rfind('=');
        if (cut == std::string::npos) bad(setting, "give NAME=STIFFNESS[,DAMPING[,FRICTION]]");
        const auto found = std::find(names.begin(), names.end(), setting.substr(0, cut));
        if (found == names.end())
            bad(setting, fmt::format("the file has no such material; it has {}", fmt::join(names, ", ")));
        materials[static_cast<std::size_t>(found - names.begin())] =
            read(setting, std::string_view(setting).substr(cut + 1));
    }
    return materials;
}

}  // namespace feel

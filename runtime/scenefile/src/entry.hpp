#pragma once
// One [[table]] of a scene file. Its keys are known and its values have the right type, but entries are not
// yet sorted by time. Private to this module.

#include <optional>

#include <knurl/reps/presets.hpp>

#include "toml_value.hpp"

namespace knurl::scenefile {

/// A value for one field of a representation.
struct Setting {
    std::uint32_t field;
    std::vector<double> parts;  // as many as the field has reals; one for a choice or an integer
    toml::source_position at;
};

struct Entry {
    Kind kind = 0;
    toml::source_position where;
    std::string id;
    std::string called;  // its name in errors: "plane 'floor'"
    double at = 0;       // s
    bool remove = false;
    std::optional<std::uint32_t> probe;
    std::optional<OnSilence> on_silence;
    std::optional<double> silence_time;  // s
    toml::source_position options_at;    // of the last of these three
    const Material* material = nullptr;  // applied before the settings, which override it
    std::vector<Setting> settings;
};

/// Options as the entry states them, defaults for the rest.
AddOptions options_of(const Entry& entry);
Entry read_entry(const std::string& path, Kind kind, const toml::table& table);
ProbePlacement read_probe(const std::string& path, std::size_t index, const toml::table& table);
/// Adds a remark for each length that was probably meant in mm.
void doubt_units(const std::string& path, const Entry& entry, std::vector<std::string>& remarks);
AssetEntry read_asset(const std::string& path, std::size_t number, const toml::table& table);

[[noreturn]] void fail_unknown_key(const std::string& path, const Value& value, const std::string& called,
                                   const std::vector<std::string_view>& known);

/// Writes the settings into a kind's parameters and checks the result. Throws SceneError at the faulty
/// setting.
void apply(const std::string& path, const Entry& entry, std::vector<std::byte>& params);

}  // namespace knurl::scenefile

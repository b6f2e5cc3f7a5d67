#pragma once
// One [[table]] of a scene file, its keys known and its values of the right type, but not yet put in order of
// time. Private to this module.

#include <optional>

#include <knurl/reps/presets.hpp>

#include "toml_value.hpp"

namespace knurl::scenefile {

/// A value for one field of a representation.
struct Setting {
    std::uint32_t field;
    std::vector<double> parts;  // as many as the field has reals; a choice or an integer: one
    toml::source_position at;
};

struct Entry {
    Kind kind = 0;
    toml::source_position where;
    std::string id;
    std::string called;  // what errors call it: "plane 'floor'"
    double at = 0;       // s
    bool remove = false;
    std::optional<std::uint32_t> probe;
    std::optional<OnSilence> on_silence;
    std::optional<double> silence_time;  // s
    toml::source_position options_at;    // of the last of these three
    const Material* material = nullptr;  // before the settings, which win
    std::vector<Setting> settings;
};

/// As it states it, the rest by default.
AddOptions options_of(const Entry& entry);
Entry read_entry(const std::string& path, Kind kind, const toml::table& table);
ProbePlacement read_probe(const std::string& path, std::size_t index, const toml::table& table);
/// Lengths that were probably meant in mm: a remark each.
void doubt_units(const std::string& path, const Entry& entry, std::vector<std::string>& remarks);
AssetEntry read_asset(const std::string& path, std::size_t number, const toml::table& table);

[[noreturn]] void fail_unknown_key(const std::string& path, const Value& value, const std::string& called,
                                   const std::vector<std::string_view>& known);

/// Writes the settings into a kind's parameters and checks the result; throws SceneError at the setting to
/// blame.
void apply(const std::string& path, const Entry& entry, std::vector<std::byte>& params);

}  // namespace knurl::scenefile

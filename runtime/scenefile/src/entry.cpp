#include "entry.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

namespace knurl::scenefile {

namespace {

constexpr scenefile::KeyInfo keys_of_entries[] = {
    {"id", "a string or an integer", "names the representation; without one it cannot be changed later"},
    {"at", "s, 0 or more; 0", "when the entry takes effect: in the first cycle at or after it"},
    {"remove", "true, false; false", "the representation goes, over its recovery"},
    {"probe", "0 to 15; 0", "which probe it acts on; fixed when it is added"},
    {"on_silence", "`fade`, `hold`, `move`; `fade`",
     "what it does when its application falls silent; fixed when it is added"},
    {"silence_time", "s; 0.1", "for how long `move` goes on; fixed when it is added"},
    {"material", "a preset's name",
     "of surfaces: stiffness, damping, friction, snags and texture; keys beside it win"},
};

std::string joined(const std::vector<std::string_view>& words) {
    std::string text;
    for (const auto w : words) text += (text.empty() ? "" : ", ") + std::string(w);
    return text;
}

std::uint32_t choice(const std::string& path, const Value& value, const std::string& what,
                     std::span<const std::string_view> names) {
    const std::string chosen = word(path, value, what);
    for (std::uint32_t i = 0; i < names.size(); ++i) {
        if (names[i] == chosen) return i;
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    fail(path, value.at, fmt::format("{} is '{}'; it must be one of: {}", what, chosen, joined(known)));
}

/// Seconds, 0 or more.
double seconds(const std::string& path, const Value& value, const std::string& what) {
    const double time = real(path, value, what, "s");
    if (!std::isfinite(time) || time < 0) {
        fail(path, value.at, fmt::format("{} is {} s; it must be 0 s or more, and finite", what, time));
    }
    return time;
}

std::string identity(const std::string& path, const Value& value, const std::string& what) {
    if (const auto* number = value.node->as_integer()) return std::to_string(number->get());
    if (const auto* text = value.node->as_string(); text != nullptr && !text->get().empty())
        return text->get();
    fail(path, value.at, fmt::format("{} must be a string or an integer; write id = \"floor\"", what));
}

Setting read_setting(const std::string& path, const Value& value, std::uint32_t index, const Field& field,
                     const std::string& what) {
    Setting setting{.field = index, .parts = {}, .at = value.at};
    switch (field.type) {
        case Field::Type::real: {
            if (field.automatic_allowed && value.node->is_string() &&
                value.node->as_string()->get() == "automatic") {
                setting.parts = {automatic};
                break;
            }
            const double number = real(path, value, what, field.unit);
            // Given as a number, the code for "automatic" is just a negative value.
            if (field.automatic_allowed && number == automatic) {
                const std::string unit = field.unit == "1" ? std::string() : fmt::format(" {}", field.unit);
                fail(path, value.at,
                     fmt::format("{} is {}{}; it must be {}{} or more, or \"automatic\"", what, number, unit,
                                 field.minimum, unit));
            }
            setting.parts = {number};
            break;
        }
        case Field::Type::vector:
            setting.parts = numbers(path, value, what, field.unit, 3);
            break;
        case Field::Type::quaternion:
            setting.parts = numbers(path, value, what, "", 4);
            break;
        case Field::Type::matrix:
            setting.parts = square(path, value, what, field.unit, field.count);
            break;
        case Field::Type::points:
            setting.parts = points(path, value, what, field.unit, field.least, field.count);
            break;
        case Field::Type::choice:
            setting.parts = {static_cast<double>(choice(path, value, what, field.choices))};
            break;
        case Field::Type::integer:
            setting.parts = {static_cast<double>(
                integer(path, value, what, 0, std::numeric_limits<std::uint32_t>::max()))};
            break;
    }
    return setting;
}

template <class R>
void make_of(const Material& material, std::vector<std::byte>& params) {
    if constexpr (Surface<R>) {
        R surface{};
        std::memcpy(&surface, params.data(), sizeof surface);
        surface = made_of(material, surface);
        std::memcpy(params.data(), &surface, sizeof surface);
    }
}

template <class... R>
void make_of(const Material& material, Kind kind, std::vector<std::byte>& params, TypeList<R...>) {
    void (*const makers[])(const Material&, std::vector<std::byte>&) = {&make_of<R>...};
    makers[kind](material, params);
}

/// The keys that a table of this kind may have.
std::vector<std::string_view> keys_of(const KindInfo& info) {
    std::vector<std::string_view> known;
    for (const Field& field : info.fields) known.push_back(field.name);
    for (const KeyInfo& key : keys_of_entries)
        if (info.surface || key.name != "material") known.push_back(key.name);
    return known;
}

/// Reads the id, if there is one.
void read_id(const std::string& path, const std::vector<Value>& values, std::string_view kind, Entry& entry) {
    for (const Value& value : values) {
        if (value.key != "id") continue;
        entry.id = identity(path, value, "id of " + entry.called);
        entry.called = fmt::format("{} '{}'", kind, entry.id);
    }
}

/// Reads one of the AddOptions. False: the key is another.
bool read_option(const std::string& path, const Value& value, const std::string& what, Entry& entry) {
    if (value.key == "probe") {
        entry.probe = static_cast<std::uint32_t>(integer(path, value, what, 0, max_probes - 1));
    } else if (value.key == "on_silence") {
        entry.on_silence = static_cast<OnSilence>(choice(path, value, what, silence_names));
    } else if (value.key == "silence_time") {
        entry.silence_time = real(path, value, what, "s");
    } else {
        return false;
    }
    entry.options_at = value.at;
    return true;
}

/// Reads a field of the representation. False: it has no such field.
bool read_field(const std::string& path, const Value& value, const std::string& what, Entry& entry) {
    const auto& fields = kinds()[entry.kind].fields;
    std::uint32_t index = 0;
    while (index < fields.size() && fields[index].name != value.key) ++index;
    if (index == fields.size()) return false;
    entry.settings.push_back(read_setting(path, value, index, fields[index], what));
    return true;
}

}  // namespace

void fail_unknown_key(const std::string& path, const Value& value, const std::string& called,
                      const std::vector<std::string_view>& known) {
    std::vector<std::string_view> inside;  // the word is a table ("friction"), not a value
    for (const auto word : known) {
        if (word.starts_with(fmt::format("{}.", value.key))) inside.push_back(word);
    }
    if (!inside.empty()) {
        fail(path, value.key_at,
             fmt::format("{} in {} is a table, not {}; it has {}", value.key, called, type_name(*value.node),
                         joined(inside)));
    }
    auto meant = words::nearest(value.key, known);
    for (const auto word : known) {  // compares the last part of a dotted name
        if (meant.empty() && word.ends_with(fmt::format(".{}", value.key))) meant = word;
    }
    fail(path, value.key_at,
         fmt::format("unknown key '{}' in {}; {}", value.key, called,
                     meant.empty() ? "it takes " + joined(known) : fmt::format("did you mean '{}'?", meant)));
}

std::span<const KeyInfo> entry_keys() noexcept {
    return keys_of_entries;
}

AddOptions options_of(const Entry& entry) {
    AddOptions options;
    options.probe = entry.probe.value_or(options.probe);
    options.on_silence = entry.on_silence.value_or(options.on_silence);
    options.silence_time = entry.silence_time.value_or(options.silence_time);
    return options;
}

Entry read_entry(const std::string& path, Kind kind, const toml::table& table) {
    const KindInfo& info = kinds()[kind];
    Entry entry;
    entry.kind = kind;
    entry.where = table.source().begin;
    entry.id = fmt::format("(line {})", entry.where.line);
    entry.called = fmt::format("the {} of line {}", info.name, entry.where.line);

    const auto values = values_of(table);
    read_id(path, values, info.name, entry);  // first, so that every other error can contain the name
    for (const Value& value : values) {
        const std::string what = fmt::format("{} of {}", value.key, entry.called);
        if (value.key == "id") continue;
        if (value.key == "at") {
            entry.at = seconds(path, value, what);
        } else if (value.key == "remove") {
            entry.remove = boolean(path, value, what);
        } else if (value.key == "material" && info.surface) {
            entry.material = preset(preset_names()[choice(path, value, what, preset_names())]);
        } else if (!read_option(path, value, what, entry) && !read_field(path, value, what, entry)) {
            fail_unknown_key(path, value, entry.called, keys_of(info));
        }
        if (const Verdict verdict = check_options(options_of(entry));
            !verdict)  // the values read before this one were legal
            fail(path, value.at, describe(verdict, kind, entry.called));
    }
    return entry;
}

void doubt_units(const std::string& path, const Entry& entry, std::vector<std::string>& remarks) {
    constexpr double reach = 2, farthest = 1e3;  // m: of a hand; a world with its own origin lies beyond
    for (const Setting& setting : entry.settings) {
        const Field& field = kinds()[entry.kind].fields[setting.field];
        if (field.unit != "m") continue;
        double length = 0;
        for (const double part : setting.parts)
            if (std::isfinite(part) && std::abs(part) > std::abs(length)) length = part;
        if (!(std::abs(length) > reach && std::abs(length) < farthest)) continue;
        remarks.push_back(
            fmt::format("{}:{}:{}: {} of {} is {:g} m, but a hand reaches {:g} m: lengths are in metres; if "
                        "it is in mm, write {:g}",
                        path, setting.at.line, setting.at.column, field.name,
                        words::printable(entry.called, 60), length, reach, length * 1e-3));
    }
}

ProbePlacement read_probe(const std::string& path, std::size_t index, const toml::table& table) {
    const std::string called = fmt::format("probe {}", index);
    ProbePlacement placement;
    for (const Value& value : values_of(table)) {
        const std::string what = fmt::format("{} of {}", value.key, called);
        if (value.key == "offset") {
            placement.offset = vector(path, value, what, "m");
        } else if (value.key == "radius") {
            placement.radius = real(path, value, what, "m");
        } else {
            fail_unknown_key(path, value, called, {"offset", "radius"});
        }
        if (const Verdict verdict = check_placement(static_cast<std::uint32_t>(index), placement); !verdict)
            fail(path, value.at, describe(verdict, Representations::size, called));
    }
    return placement;
}

void apply(const std::string& path, const Entry& entry, std::vector<std::byte>& params) {
    const KindInfo& info = kinds()[entry.kind];
    if (entry.material) make_of(*entry.material, entry.kind, params, Representations{});
    for (const Setting& setting : entry.settings) {
        const Field& field = info.fields[setting.field];
        std::byte* target = params.data() + field.offset;
        const std::size_t reals = field.reals() * sizeof(double);
        if (reals > 0) {
            std::memset(target, 0, reals);
            std::memcpy(target, setting.parts.data(), setting.parts.size() * sizeof(double));
        }
        if (field.bytes() > reals) {
            // A choice or an integer, which was read within its range; of reals, which may have any value, none.
            const auto whole = field.type == Field::Type::points
                                   ? static_cast<std::uint32_t>(setting.parts.size() / 3)
                                   : static_cast<std::uint32_t>(setting.parts[0]);
            std::memcpy(target + reals, &whole, sizeof whole);
        }
    }
    const Verdict verdict = info.validate(params.data());
    if (verdict) return;
    toml::source_position where = entry.where;
    for (const Setting& setting : entry.settings) {
        if (setting.field == verdict.field) where = setting.at;
    }
    fail(path, where, describe(verdict, entry.kind, entry.called));
}

}  // namespace knurl::scenefile

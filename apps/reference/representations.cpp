// Every kind of representation, from its table of fields (knurl/reps/field.hpp).

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include <fmt/format.h>

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/presets.hpp>

#include "pages.hpp"

namespace knurl::reference {

namespace {

std::string number(double value) {
    return std::isinf(value) ? "infinity" : fmt::format("{:g}", value);
}

std::string choices_of(const Field& field) {
    std::string text;
    for (const std::string_view choice : field.choices)
        text += fmt::format("{}`{}`", text.empty() ? "" : ", ", choice);
    return text;
}

std::string bounds_of(const Field& field) {
    if (std::isinf(field.minimum) && std::isinf(field.maximum)) return "any";
    if (std::isinf(field.maximum)) return fmt::format("{:g} or more", field.minimum);
    if (field.minimum == -field.maximum) return fmt::format("± {:g}", field.maximum);
    return fmt::format("{:g} … {:g}", field.minimum, field.maximum);
}

std::string range_of(const Field& field) {
    switch (field.type) {
        case Field::Type::choice:
            return choices_of(field);
        case Field::Type::integer:
            return std::isinf(field.maximum) ? "0 … 4294967295" : bounds_of(field);
        case Field::Type::quaternion:
            return "w x y z, length ≥ 1e-6";
        case Field::Type::vector:
            return (field.nonzero ? "length ≥ 1e-6, components " : "components ") + bounds_of(field);
        case Field::Type::matrix:
            return fmt::format("{0} × {0}, entries {1}", field.count, bounds_of(field));
        case Field::Type::points:
            return fmt::format("{} to {} points, components {}", field.least, field.count, bounds_of(field));
        case Field::Type::real:
            break;
    }
    return bounds_of(field) + (field.infinity_allowed ? ", or infinity" : "") +
           (field.automatic_allowed ? ", or automatic" : "");
}

template <class T>
T read(const std::byte* params, std::size_t offset) {
    T value;
    std::memcpy(&value, params + offset, sizeof value);
    return value;
}

/// One number if all are equal. Of points, as many as are in use.
std::string reals_of(const Field& field, const std::byte* params) {
    std::size_t count = field.reals();
    if (field.type == Field::Type::points)
        count = 3 * read<std::uint32_t>(params, field.offset + count * sizeof(double));
    std::string text;
    bool alike = true;
    for (std::size_t i = 0; i < count; ++i) {
        const double value = read<double>(params, field.offset + i * sizeof(double));
        alike = alike && value == read<double>(params, field.offset);
        if (field.type == Field::Type::points && i % 3 == 0 && i > 0) text += ";";
        text += (text.empty() ? "" : " ") + number(value);
    }
    return alike && field.type == Field::Type::matrix ? number(read<double>(params, field.offset)) : text;
}

std::string default_of(const Field& field, const std::byte* params) {
    if (field.reals() == 0) {
        const auto whole = read<std::uint32_t>(params, field.offset);
        return field.type == Field::Type::choice ? fmt::format("`{}`", field.choices[whole])
                                                 : fmt::format("{}", whole);
    }
    if (field.automatic_allowed && read<double>(params, field.offset) == automatic) return "automatic";
    return reals_of(field, params);
}

std::vector<std::string> row_of(const Field& field, const std::byte* params) {
    return {fmt::format("`{}`", field.name), std::string(field.unit), range_of(field),
            default_of(field, params), std::string(field.meaning)};
}

using Rows = std::vector<std::vector<std::string>>;

template <class R>
Rows rows_of() {
    const R params{};
    Rows rows;
    for (const Field& field : Describe<R>::fields)
        rows.push_back(row_of(field, reinterpret_cast<const std::byte*>(&params)));
    return rows;
}

/// By kind, in the list's order.
template <class... R>
std::vector<Rows> all_rows(TypeList<R...>) {
    return {rows_of<R>()...};
}

/// The rows that all surfaces share.
Rows common_rows(const std::vector<Rows>& all) {
    Rows common;
    bool first = true;
    for (std::size_t kind = 0; kind < all.size(); ++kind) {
        if (!kinds()[kind].surface) continue;
        if (first) common = all[kind];
        first = false;
        std::erase_if(common, [&](const auto& row) {
            return std::find(all[kind].begin(), all[kind].end(), row) == all[kind].end();
        });
    }
    return common;
}

const std::vector<std::string_view> columns{"key", "unit", "range", "default", "meaning"};

std::string section_of(const KindInfo& info, Rows rows, const Rows& common) {
    std::string text = fmt::format("## {}\n\n", info.name);
    text += fmt::format("{}, {} bytes.", info.surface ? "A surface" : "An effect", info.size);
    if (info.surface) {
        std::erase_if(rows, [&](const auto& row) {
            return std::find(common.begin(), common.end(), row) != common.end();
        });
        text += " Besides these it has the keys of [every surface](#every-surface).";
    }
    text += "\n\n" + table(columns, rows);
    if (info.contradictions.empty()) return text + "\n";
    text += "\nAlso refused; of the field it is said that it\n\n";
    for (const std::string_view reason : info.contradictions) text += fmt::format("- {}\n", reason);
    return text + "\n";
}

std::string presets() {
    std::vector<std::vector<std::string>> rows;
    for (const std::string_view name : preset_names()) {
        const Material& material = *preset(name);
        rows.push_back({fmt::format("`{}`", name), number(material.stiffness), number(material.damping),
                        number(material.friction.dynamic), number(material.snag.d_mean),
                        number(material.texture.amplitude)});
    }
    return table({"material", "stiffness, N/m", "damping, N s/m", "friction.dynamic", "snag.d_mean, m",
                  "texture.amplitude, m"},
                 rows);
}

}  // namespace

std::vector<std::vector<std::string>> probe_keys() {
    return rows_of<ProbePlacement>();
}

std::string representations() {
    const std::vector<Rows> all = all_rows(Representations{});
    const Rows common = common_rows(all);
    std::string text =
        "# Representations\n\n"
        "What an application sends in place of a force. The keys are those of the parameters in C++ and of "
        "the tables in "
        "a\n[scene file](scene-file.md). A value out of its range is refused with field, value and range, "
        "and nothing of "
        "that call is applied.\n*Automatic* times follow the application's update interval; an infinite "
        "stiffness is as "
        "stiff as the device allows.\n\n"
        "[The chapter on representations](../../reps/README.md) says how each of them acts, with formulas "
        "and sources.\n\n";
    text += "## Every surface\n\n" + table(columns, common) + "\n";
    for (std::size_t kind = 0; kind < all.size(); ++kind)
        text += section_of(kinds()[kind], all[kind], common);
    return text +
           "## Materials\n\n`material = \"NAME\"` in a scene file, `made_of(*preset(\"NAME\"), ...)` in C++. "
           "A "
           "preset sets stiffness, damping,\nfriction, snags and texture at once.\n\n" +
           presets();
}

}  // namespace knurl::reference

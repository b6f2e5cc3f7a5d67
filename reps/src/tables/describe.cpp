#include <charconv>
#include <cmath>
#include <span>

#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl {
namespace {

std::string number(double value) {
    char text[32];  // with a point in every locale, which printf's has not
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, 15).ptr};
}

std::string with_unit(double value, std::string_view unit) {
    std::string text = number(value);
    if (!unit.empty() && unit != "1") text.append(" ").append(unit);
    return text;
}

// The legal values: the remedy that ends every refusal of a field.
std::string legal(const Field& field) {
    if (field.type == Field::Type::choice) {
        std::string text = "give one of";
        for (const std::string_view choice : field.choices) text.append(" ").append(choice);
        return text;
    }
    if (field.type == Field::Type::integer && !std::isfinite(field.maximum))
        return "give a whole number from 0 to 4294967295";
    std::string text = field.type == Field::Type::real      ? "give a value"
                       : field.type == Field::Type::integer ? "give a whole number"
                       : field.type == Field::Type::matrix  ? "give entries"
                                                            : "give components";
    const bool below = std::isfinite(field.minimum), above = std::isfinite(field.maximum);
    if (below && above) {
        text += " from " + number(field.minimum) + " to " + with_unit(field.maximum, field.unit);
    } else if (below) {
        text += " of " + with_unit(field.minimum, field.unit) + " or more";
    } else if (above) {
        text += " of " + with_unit(field.maximum, field.unit) + " or less";
    } else {
        text += " that is finite";
    }
    if (field.infinity_allowed)
        text += field.unit == "N/m" ? ", or infinity for as stiff as the device allows" : ", or infinity";
    if (field.automatic_allowed) text += ", or leave it out for automatic";
    return text;
}

std::string reason(const Verdict& verdict, const KindInfo& kind, std::string_view unit) {
    std::string text(kind.contradictions[verdict.reason]);
    const std::size_t gap = text.find("{}");
    return gap == std::string::npos ? text : text.replace(gap, 2, with_unit(verdict.against, unit));
}

struct Blamed {
    const Field* field = nullptr;  // null: the message is about the whole representation
    std::string name;              // "plane.stiffness", "plane", "probe.radius"
};

Blamed blamed(std::uint32_t row, const KindInfo* kind) {
    std::string name(kind ? kind->name : "representation");
    std::span<const Field> fields = kind ? kind->fields : std::span<const Field>{};
    if (row != Verdict::no_field && row >= Verdict::of_placement) {
        name = Describe<ProbePlacement>::name;
        fields = Describe<ProbePlacement>::fields;
        row -= Verdict::of_placement;
    } else if (row != Verdict::no_field && row >= Verdict::of_options) {
        fields = Describe<AddOptions>::fields;
        row -= Verdict::of_options;
    }
    if (row >= fields.size()) return {nullptr, name};
    return {&fields[row], name.append(".").append(fields[row].name)};
}

std::string what(const Verdict& verdict, const KindInfo* kind) {
    const auto [field, name] = blamed(verdict.field, kind);
    const std::string_view unit = field ? field->unit : std::string_view("1");
    const std::string remedy = field ? "; " + legal(*field) : std::string();
    switch (verdict.code) {
        case Verdict::Code::ok:
            return name + ": accepted";
        case Verdict::Code::not_finite:
            return name + " = " + number(verdict.value) + " is not a finite number" + remedy;
        case Verdict::Code::out_of_range:
            return name + " = " + with_unit(verdict.value, unit) + " is out of range" + remedy;
        case Verdict::Code::zero_vector:
            return name + " has length " + number(verdict.value) + " and so no " +
                   (field && field->type == Field::Type::quaternion ? "orientation" : "direction") +
                   "; give a length of 1e-06 or more";
        case Verdict::Code::count:
            return name + " has " + number(verdict.value) + " points" +
                   (field ? "; give from " + std::to_string(field->least) + " to " +
                                std::to_string(field->count)
                          : "");
        case Verdict::Code::no_such_choice:
            return name + " = " + number(verdict.value) + " is none of its choices" + remedy;
        case Verdict::Code::contradiction:
            return name + " = " + with_unit(verdict.value, unit) + " " +
                   (kind && verdict.reason < kind->contradictions.size()
                        ? reason(verdict, *kind, unit)
                        : "contradicts another of its fields" + remedy);
        case Verdict::Code::unknown_kind:
            return "no representation of kind " + number(verdict.value) +
                   " exists; build the application and the servo from the same version";
        case Verdict::Code::wrong_size:
            return name + ": parameters of " + number(verdict.value) + " bytes instead of " +
                   std::to_string(kind ? kind->size : 0) +
                   (kind && kind->geometry_bytes < kind->size
                        ? " (or of " + std::to_string(kind->geometry_bytes) + ", its geometry alone)"
                        : "") +
                   "; build the application and the servo from the same version";
        case Verdict::Code::no_such_slot:
            return name + ": there is none in slot " + number(verdict.value) +
                   ", or no longer the same one; it was removed: add it again";
        case Verdict::Code::slot_in_use:
            return name + ": slot " + number(verdict.value) + " is taken; remove what is there first";
        case Verdict::Code::no_such_probe:
            return name + " = " + number(verdict.value) + ": there is no such probe; give 0 to " +
                   number(verdict.against);
        case Verdict::Code::too_many:
            return name + ": no room for another (limit " + number(verdict.value) + "); remove one first";
        case Verdict::Code::not_armed:
            return name + ": the device is not armed; arm it first";
        case Verdict::Code::refused:
            return name + ": refused in the device's present state (reason " + number(verdict.value) + ")";
    }
    return name + ": refused";
}

}  // namespace

std::string describe(const Verdict& verdict, Kind kind, std::string_view where) {
    return describe(verdict, kind < kinds().size() ? &kinds()[kind] : nullptr, where);
}

std::string describe(const Verdict& verdict, const KindInfo* kind, std::string_view where) {
    const std::string text = what(verdict, kind);
    return where.empty() ? text : std::string(where) + ": " + text;
}

}  // namespace knurl

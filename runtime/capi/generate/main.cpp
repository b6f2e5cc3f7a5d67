// knurl_capi_header FILE: writes knurl_kinds.h from the tables of the representations.

#include <cctype>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "../src/layout.hpp"

namespace knurl::capi {
namespace {

std::string upper(std::string text) {
    for (char& c : text) c = c == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

std::string number(double value) {
    std::ostringstream out;
    out.imbue(std::locale::classic());
    out << value;
    return out.str();
}

std::string range_of(const Field& field) {
    std::string text;
    const bool bounded = field.maximum < std::numeric_limits<double>::infinity();
    if (field.type != Field::Type::choice && bounded)
        text += "; " + number(field.minimum) + " to " + number(field.maximum);
    if (field.infinity_allowed) text += ", or infinity: as stiff as the device allows";
    if (field.automatic_allowed) text += ", or KNURL_AUTOMATIC";
    if (field.nonzero) text += "; of any length but 0";
    if (field.type == Field::Type::points)
        text += "; " + std::to_string(field.least) + " to " + std::to_string(field.count) + " of them";
    return text;
}

std::string declaration(const Field& field) {
    const std::string name = member_name(field);
    switch (field.type) {
        case Field::Type::real:
            return "double " + name + ";";
        case Field::Type::vector:
            return "knurl_vec3 " + name + ";";
        case Field::Type::choice:
        case Field::Type::integer:
            return "uint32_t " + name + ";";
        case Field::Type::quaternion:
            return "knurl_quat " + name + ";";
        case Field::Type::matrix:
            return "double " + name + "[" + std::to_string(field.count * field.count) + "];";
        case Field::Type::points:
            return "knurl_vec3 " + name + "[" + std::to_string(field.count) +
                   "];\n    /// How many of them are used.\n    uint32_t " + name + "_count;";
    }
    return "";
}

std::string unit_of(const Field& field) {
    return field.unit.empty() || field.unit == "1" ? "" : " (" + std::string(field.unit) + ")";
}

void write_choices(std::ostream& out, const std::string& kind, const Field& field) {
    if (field.choices.empty()) return;
    out << "/// Values of knurl_" << kind << "::" << member_name(field) << ": " << field.meaning
        << ".\nenum {\n";
    for (std::size_t i = 0; i < field.choices.size(); ++i)
        out << "    KNURL_" << upper(kind) << "_" << upper(member_name(field)) << "_"
            << upper(std::string(field.choices[i])) << " = " << i
            << (i + 1 < field.choices.size() ? ",\n" : "\n");
    out << "};\n\n";
}

void write_kind(std::ostream& out, const KindInfo& kind, const Layout& layout) {
    const std::string name(kind.name);
    for (const Member& member : layout.members) write_choices(out, name, *member.field);
    out << "/// Parameters of a " << name << (kind.surface ? ", a surface" : ", an effect")
        << ". What each means: reps/README.md.\ntypedef struct knurl_" << name << " {\n    /// sizeof(knurl_"
        << name << ").\n    uint64_t size;\n";
    for (const Member& member : layout.members)
        out << "    /// " << member.field->meaning << unit_of(*member.field) << range_of(*member.field)
            << ".\n    " << declaration(*member.field) << "\n";
    out << "} knurl_" << name << ";\n"
        << "/// Fills in size and defaults.\nstatic inline void knurl_default_" << name << "(knurl_" << name
        << "* params) {\n    (void)knurl_default(KNURL_" << upper(name) << ", params, sizeof *params);\n}\n"
        << "/// As knurl_add.\nstatic inline int knurl_add_" << name << "(knurl_hand* hand, const knurl_"
        << name
        << "* params,\n    const knurl_add_options* options, knurl_id* out) {\n    return knurl_add(hand, "
           "KNURL_"
        << upper(name) << ", params, options, out);\n}\n"
        << "/// As knurl_set.\nstatic inline int knurl_set_" << name
        << "(knurl_hand* hand, knurl_id id, const knurl_" << name
        << "* params) {\n    return knurl_set(hand, id, KNURL_" << upper(name) << ", params);\n}\n"
        << "/// As knurl_get.\nstatic inline int knurl_get_" << name
        << "(knurl_hand* hand, knurl_id id, knurl_" << name
        << "* params) {\n    return knurl_get(hand, id, KNURL_" << upper(name) << ", params);\n}\n\n";
}

void write_all(std::ostream& out) {
    out << "#ifndef KNURL_KINDS_H\n#define KNURL_KINDS_H\n\n"
           "/// @file\n/// The representations, from the tables of the library. Included by knurl.h.\n\n"
           "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n"
           "/// Kinds of representations.\nenum {\n";
    for (std::size_t i = 0; i < kinds().size(); ++i)
        out << "    KNURL_" << upper(std::string(kinds()[i].name)) << " = " << i
            << (i + 1 < kinds().size() ? ",\n" : "\n");
    out << "};\n\n";
    for (std::size_t i = 0; i < kinds().size(); ++i) write_kind(out, kinds()[i], layouts()[i]);
    out << "#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
}

}  // namespace
}  // namespace knurl::capi

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("knurl_capi_header FILE\n", stderr);
        return 2;
    }
    std::ofstream file(argv[1]);
    knurl::capi::write_all(file);
    file.close();
    if (!file) {
        std::fprintf(stderr, "knurl_capi_header: %s cannot be written\n", argv[1]);
        return 1;
    }
    return 0;
}

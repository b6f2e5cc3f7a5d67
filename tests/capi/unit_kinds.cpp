// Kinds, parameters and choices as tables, against what a C compiler makes of the header.

#include <cctype>
#include <limits>
#include <set>

#include "kinds_table.h"
#include "support.hpp"

namespace capi_test {
namespace {

std::string upper(std::string text) {
    for (char& c : text) c = c == '.' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}
std::string member_of(const knurl_field& field) {
    std::string name = field.name;
    for (char& c : name)
        if (c == '.') c = '_';
    return name;
}
std::size_t bytes_of(const knurl_field& field) {
    switch (field.type) {
        case KNURL_TYPE_VECTOR:
            return sizeof(knurl_vec3);
        case KNURL_TYPE_CHOICE:
        case KNURL_TYPE_INTEGER:
            return sizeof(std::uint32_t);
        case KNURL_TYPE_QUATERNION:
            return sizeof(knurl_quat);
        case KNURL_TYPE_MATRIX:
            return field.count * field.count * sizeof(double);
        case KNURL_TYPE_POINTS:
            return field.count * sizeof(knurl_vec3) + sizeof(std::uint32_t);
        default:
            return sizeof(double);
    }
}

TEST(CKinds, are_laid_out_as_a_c_compiler_lays_them_out) {
    const char* name = nullptr;
    std::uint64_t size = 0;
    std::uint32_t kinds = 0;
    for (; knurl_kind_at(kinds, &name, &size) == KNURL_OK; ++kinds) {
        ASSERT_LT(kinds, kind_row_count) << name << " is not in the header";
        const kind_row& row = kind_rows[kinds];
        SCOPED_TRACE(name);
        EXPECT_STREQ(row.name, name);
        EXPECT_EQ(row.kind, kinds);
        EXPECT_EQ(row.size, size);
        std::size_t member = 0;
        knurl_field field = sized<knurl_field>();
        for (std::uint32_t at = 0; knurl_field_at(kinds, at, &field) == KNURL_OK; ++at) {
            ASSERT_LT(member, row.member_count) << field.name;
            EXPECT_EQ(row.members[member].name, member_of(field));
            EXPECT_EQ(row.members[member].offset, field.offset) << field.name;
            EXPECT_EQ(field.size, sizeof field);
            EXPECT_NE(*field.meaning, 0) << field.name;
            std::size_t bytes = row.members[member++].size;
            if (field.type == KNURL_TYPE_POINTS) {  // the number of them is a member of its own
                ASSERT_LT(member, row.member_count);
                EXPECT_EQ(row.members[member].name, member_of(field) + "_count");
                EXPECT_EQ(row.members[member].offset, field.offset + bytes);
                bytes += row.members[member++].size;
            }
            EXPECT_EQ(bytes, bytes_of(field)) << field.name;
        }
        EXPECT_EQ(member, row.member_count);
    }
    EXPECT_EQ(kinds, kind_row_count);
    EXPECT_EQ(knurl_kind_at(~0u, &name, nullptr), KNURL_NOTHING);
    EXPECT_EQ(knurl_kind_at(0, &name, nullptr), KNURL_OK);
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_kind_at(0, nullptr, &size)));
}

TEST(CKinds, name_the_values_of_each_choice) {
    std::set<std::string> in_header, at_run_time;
    for (std::size_t i = 0; i < choice_row_count; ++i) {
        const choice_row& row = choice_rows[i];
        in_header.insert(std::string(row.kind) + "::" + row.member + " " + row.value + " = " +
                         std::to_string(row.number));
    }
    const char *kind_name = nullptr, *value = nullptr;
    for (std::uint32_t kind = 0; knurl_kind_at(kind, &kind_name, nullptr) == KNURL_OK; ++kind) {
        knurl_field field = sized<knurl_field>();
        for (std::uint32_t row = 0; knurl_field_at(kind, row, &field) == KNURL_OK; ++row)
            for (std::uint32_t i = 0; knurl_choice_at(kind, row, i, &value) == KNURL_OK; ++i) {
                EXPECT_EQ(field.type, std::uint32_t{KNURL_TYPE_CHOICE}) << field.name;
                at_run_time.insert(std::string(kind_name) + "::" + member_of(field) + " " + upper(value) +
                                   " = " + std::to_string(i));
            }
    }
    EXPECT_EQ(in_header, at_run_time);
    EXPECT_GT(in_header.size(), 20u);
    EXPECT_EQ(knurl_choice_at(KNURL_PLANE, 1000, 0, &value), KNURL_NOTHING);
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_choice_at(~0u, 0, 0, &value), "kind 4294967295"));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_choice_at(0, 0, 0, nullptr)));
}

TEST(CKinds, begin_with_their_defaults_which_are_legal) {
    for (std::size_t i = 0; i < kind_row_count; ++i) {
        SCOPED_TRACE(kind_rows[i].name);
        std::vector<std::uint64_t> params((kind_rows[i].size + 32) / 8, 0xAAAAAAAAAAAAAAAA);
        ASSERT_TRUE(did(knurl_default(kind_rows[i].kind, params.data(), kind_rows[i].size)));
        EXPECT_EQ(params[0], kind_rows[i].size);
        EXPECT_EQ(params[kind_rows[i].size / 8], 0xAAAAAAAAAAAAAAAA) << "and no byte beyond";
        EXPECT_TRUE(did(knurl_validate(kind_rows[i].kind, params.data())));
        // A caller who knows more members: those this library does not know are 0.
        ASSERT_TRUE(did(knurl_default(kind_rows[i].kind, params.data(), kind_rows[i].size + 24)));
        EXPECT_EQ(params[0], kind_rows[i].size + 24);
        EXPECT_EQ(params[kind_rows[i].size / 8], 0u);
        EXPECT_EQ(params[kind_rows[i].size / 8 + 3], 0xAAAAAAAAAAAAAAAA);
        EXPECT_TRUE(did(knurl_validate(kind_rows[i].kind, params.data())));
        params[kind_rows[i].size / 8 + 1] = 1;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_validate(kind_rows[i].kind, params.data()),
                          "install a newer libknurl"));
        for (const std::uint64_t size :
             {std::uint64_t{0}, std::uint64_t{8}, std::uint64_t{kind_rows[i].size} - 8,
              std::uint64_t{kind_rows[i].size} + 4, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
            EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_default(kind_rows[i].kind, params.data(), size)))
                << size;
            params[0] = size;
            EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_validate(kind_rows[i].kind, params.data()))) << size;
        }
    }
    knurl_plane one;
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_default(~0u, &one, sizeof one)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_default(0, nullptr, sizeof one)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_validate(0, nullptr)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_validate(1000, &one)));
}

TEST(CKinds, say_which_value_is_out_of_range) {
    knurl_plane floor = plane(0, -5);
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_validate(KNURL_PLANE, &floor), "plane.stiffness = -5 N/m"));
    floor = plane(std::numeric_limits<double>::quiet_NaN(), 5);
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_validate(KNURL_PLANE, &floor), "plane.offset"));
    floor = plane(0, std::numeric_limits<double>::infinity());
    EXPECT_TRUE(did(knurl_validate(KNURL_PLANE, &floor)));
    floor.combine = 77;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_validate(KNURL_PLANE, &floor), "combine"));
    knurl_field field = sized<knurl_field>();
    for (std::uint32_t row = 0; knurl_field_at(KNURL_PLANE, row, &field) == KNURL_OK; ++row) {
        if (field.type != KNURL_TYPE_REAL || !(field.maximum < 1e12)) continue;
        SCOPED_TRACE(field.name);
        for (const double value :
             {field.minimum, field.maximum, field.minimum * 2 - 3, field.maximum * 2 + 3}) {
            floor = plane(0, 100);
            std::memcpy(reinterpret_cast<char*>(&floor) + field.offset, &value, sizeof value);
            const bool legal = field.minimum <= value && value <= field.maximum;
            const int code = knurl_validate(KNURL_PLANE, &floor);
            // A legal value may still contradict the others.
            if (!legal || code != KNURL_OK) {
                EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, code, legal ? "" : field.name)) << value;
            }
        }
    }
}

TEST(CKinds, are_made_of_materials) {
    std::set<std::string> materials;
    for (std::uint32_t i = 0; const char* name = knurl_material(i); ++i) materials.insert(name);
    EXPECT_TRUE(materials.contains("rubber"));
    EXPECT_EQ(knurl_material(~0u), nullptr);
    for (const std::string& material : materials) {
        knurl_plane floor = plane(0.25, 100);
        ASSERT_TRUE(did(knurl_made_of(KNURL_PLANE, material.c_str(), &floor)));
        EXPECT_TRUE(did(knurl_validate(KNURL_PLANE, &floor))) << material;
        EXPECT_EQ(floor.offset, 0.25);
        EXPECT_EQ(floor.size, sizeof floor);
    }
    knurl_plane floor = plane(0, 100), before = floor;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_made_of(KNURL_PLANE, "a\nb", &floor), "rubber"));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_made_of(KNURL_PLANE, nullptr, &floor)));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_made_of(KNURL_PLANE, "rubber", nullptr)));
    EXPECT_EQ(std::memcmp(&floor, &before, sizeof floor), 0);
    knurl_spring spring;
    knurl_default_spring(&spring);
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_made_of(KNURL_SPRING, "rubber", &spring), "no surface"));
}

TEST(CKinds, fields_are_described_into_the_room_there_is) {
    for (const std::uint64_t size : wrong_sizes<knurl_field>()) {
        knurl_field field = sized<knurl_field>();
        field.size = size;
        EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_field_at(0, 0, &field))) << size;
    }
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_field_at(0, 0, nullptr)));
    knurl_field field = sized<knurl_field>();
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_field_at(1000, 0, &field)));
    EXPECT_EQ(knurl_field_at(0, 1000, &field), KNURL_NOTHING);
    Later<knurl_field> later;
    later.tail[0] = 7;
    EXPECT_TRUE(did(knurl_field_at(0, 0, &later.known)));
    EXPECT_EQ(later.known.size, sizeof later);
    EXPECT_EQ(later.tail[0], 7u) << "the library fills in what it knows";
}

}  // namespace
}  // namespace capi_test

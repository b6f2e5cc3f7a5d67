// Representations and materials as tables, without a servo.

#include <knurl/reps/all.hpp>
#include <knurl/reps/check.hpp>
#include <knurl/reps/describe.hpp>
#include <knurl/reps/presets.hpp>

#include "call.hpp"

using namespace knurl;
using namespace knurl::capi;

namespace {

template <class R>
bool make(const Material& material, std::span<std::byte> params) {
    if constexpr (requires(R & r) { made_of(material, r).friction; }) {
        R surface;
        std::memcpy(static_cast<void*>(&surface), params.data(), sizeof surface);
        surface = made_of(material, surface);
        std::memcpy(params.data(), &surface, sizeof surface);
        return true;
    }
    return false;
}

template <class... R>
bool make_any(TypeList<R...>, Kind kind, const Material& material, std::span<std::byte> params) {
    return ((kind == kind_of<R> && make<R>(material, params)) || ...);
}

std::string names_of_materials() {
    std::string names;
    for (const std::string_view name : preset_names())
        names += (names.empty() ? "" : ", ") + std::string(name);
    return names;
}

}  // namespace

extern "C" {

int knurl_validate(uint32_t kind, const void* params) {
    return call(nullptr, [&]() -> int {
        const Parameters given(kind, params);
        const Verdict verdict = check_parameters(kind, given.bytes().data(), given.bytes().size());
        if (!verdict) throw Failed(KNURL_BAD_PARAMETERS, describe(verdict, kind, ""));
        return KNURL_OK;
    });
}

int knurl_default(uint32_t kind, void* params, uint64_t size) {
    return call(nullptr, [&]() -> int {
        const Layout& layout = layout_of(kind);
        require_pointer(params, "knurl_default: params");
        require_size(size, layout.first_size, ("parameters of a " + std::string(kinds()[kind].name)).c_str());
        std::memset(params, 0, size);
        std::memcpy(params, &size, sizeof size);
        layout.write(layout.defaults, params);
        return KNURL_OK;
    });
}

int knurl_made_of(uint32_t kind, const char* material, void* params) {
    return call(nullptr, [&]() -> int {
        require_pointer(material, "knurl_made_of: material");
        const Parameters given(kind, params);
        const Material* found = preset(material);
        if (found == nullptr)
            throw Failed(KNURL_BAD_PARAMETERS, std::string("no material is called '") + material +
                                                   "'; there are " + names_of_materials());
        std::vector<std::byte> bytes(given.bytes().begin(), given.bytes().end());
        if (!make_any(Representations{}, kind, *found, bytes))
            throw Failed(KNURL_BAD_PARAMETERS,
                         "a " + std::string(kinds()[kind].name) + " is no surface, and has no material");
        layout_of(kind).write(bytes, params);
        return KNURL_OK;
    });
}

const char* knurl_material(uint32_t index) {
    return index < preset_names().size() ? preset_names()[index].data() : nullptr;
}

int knurl_kind_at(uint32_t kind, const char** name, uint64_t* size) {
    return call(nullptr, [&]() -> int {
        require_pointer(name, "knurl_kind_at: name");
        if (kind >= kinds().size()) return KNURL_NOTHING;
        *name = kinds()[kind].name.data();  // a literal
        if (size != nullptr) *size = layout_of(kind).size;
        return KNURL_OK;
    });
}

int knurl_field_at(uint32_t kind, uint32_t row, knurl_field* out) {
    return call(nullptr, [&]() -> int {
        const Layout& layout = layout_of(kind);
        require_room(out, "knurl_field");
        if (row >= layout.members.size()) return KNURL_NOTHING;
        const Member& member = layout.members[row];
        const Field& field = *member.field;
        // The texts of the tables are literals; one that a table leaves out has no address.
        write_struct(out, knurl_field{.size = 0,
                                      .name = field.name.data(),
                                      .unit = field.unit.empty() ? "" : field.unit.data(),
                                      .meaning = field.meaning.empty() ? "" : field.meaning.data(),
                                      .type = static_cast<std::uint32_t>(field.type),
                                      .count = field.count,
                                      .offset = member.offset,
                                      .minimum = field.minimum,
                                      .maximum = field.maximum,
                                      .infinity_allowed = field.infinity_allowed ? 1u : 0u,
                                      .automatic_allowed = field.automatic_allowed ? 1u : 0u});
        return KNURL_OK;
    });
}

int knurl_choice_at(uint32_t kind, uint32_t row, uint32_t value, const char** name) {
    return call(nullptr, [&]() -> int {
        const Layout& layout = layout_of(kind);
        require_pointer(name, "knurl_choice_at: name");
        if (row >= layout.members.size()) return KNURL_NOTHING;
        const std::span<const std::string_view> choices = layout.members[row].field->choices;
        if (value >= choices.size()) return KNURL_NOTHING;
        *name = choices[value].data();
        return KNURL_OK;
    });
}
}

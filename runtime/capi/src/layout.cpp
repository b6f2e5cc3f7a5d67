#include "layout.hpp"

#include <algorithm>
#include <cstring>

#include <knurl/reps/all.hpp>

namespace knurl::capi {

namespace {

std::size_t aligned(std::size_t offset, std::size_t to) {
    return (offset + to - 1) / to * to;
}

template <class R>
std::vector<std::byte> default_bytes() {
    const R params{};
    const auto bytes = std::as_bytes(std::span(&params, 1));
    return {bytes.begin(), bytes.end()};
}

Layout layout_of(const KindInfo& kind, std::vector<std::byte> defaults) {
    Layout layout;
    layout.defaults = std::move(defaults);
    for (const Field& field : kind.fields) layout.members.push_back({.field = &field});
    std::ranges::stable_sort(layout.members, {}, [](const Member& member) { return member.field->since; });
    std::size_t end = sizeof(std::uint64_t);
    for (Member& member : layout.members) {
        member.offset = aligned(end, member.field->reals() > 0 ? alignof(double) : alignof(std::uint32_t));
        end = member.offset + member.field->bytes();
        layout.size = aligned(end, alignof(double));
        if (member.field->since == 0) layout.first_size = layout.size;
    }
    return layout;
}

template <class... R>
std::vector<Layout> layouts_of(TypeList<R...>) {
    return {layout_of(kinds()[kind_of<R>], default_bytes<R>())...};
}

}  // namespace

std::span<const Layout> layouts() {
    static const std::vector<Layout>& all = *new std::vector<Layout>(layouts_of(Representations{}));
    return all;
}

void Layout::read(const void* params, std::span<std::byte> out) const {
    std::uint64_t given = 0;
    std::memcpy(&given, params, sizeof given);
    std::ranges::copy(defaults, out.begin());
    const auto* from = static_cast<const std::byte*>(params);
    for (const Member& member : members)
        if (member.offset + member.field->bytes() <= given)
            std::memcpy(out.data() + member.field->offset, from + member.offset, member.field->bytes());
}

void Layout::write(std::span<const std::byte> from, void* params) const {
    std::uint64_t room = 0;
    std::memcpy(&room, params, sizeof room);
    auto* to = static_cast<std::byte*>(params);
    for (const Member& member : members)
        if (member.offset + member.field->bytes() <= room)
            std::memcpy(to + member.offset, from.data() + member.field->offset, member.field->bytes());
}

std::string member_name(const Field& field) {
    std::string name(field.name);
    std::ranges::replace(name, '.', '_');
    return name;
}

}  // namespace knurl::capi

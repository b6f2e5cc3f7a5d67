#include <array>
#include <cstring>
#include <utility>

#include <knurl/reps/all.hpp>

#include "tables/field_check.hpp"
#include "tables/ranges.hpp"

namespace knurl {
namespace {

// The table is known at compile time, so each row compiles to a few comparisons.
template <class R, std::size_t Row>
bool check_row(const void* params, Verdict& verdict) noexcept {
    static constexpr Field field = Describe<R>::fields[Row];
    verdict = check_field(field, Row, static_cast<const unsigned char*>(params));
    return static_cast<bool>(verdict);
}

template <class R, std::size_t... Row>
Verdict check_rows(const void* params, std::index_sequence<Row...>) noexcept {
    Verdict verdict;
    (void)(... && check_row<R, Row>(params, verdict));
    return verdict;
}

template <Representation R>
Verdict check_whole(const void* params) noexcept {
    Verdict verdict;
    R copy;  // the bytes may lie anywhere
    std::memcpy(&copy, params, sizeof copy);
    if constexpr (Surface<R>) verdict = check_material(copy);
    if constexpr (requires { Describe<R>::check(copy); }) {
        if (verdict) verdict = Describe<R>::check(copy);
    }
    return verdict;
}

template <Representation R>
Verdict validate(const void* params) noexcept {
    if (!fields_are_legal<R>(params)) {
        const Verdict verdict =
            check_rows<R>(params, std::make_index_sequence<std::size(Describe<R>::fields)>{});
        if (!verdict) return verdict;
    }
    return check_whole<R>(params);
}

template <class R>
constexpr std::span<const std::string_view> contradictions_of() {
    if constexpr (requires { Describe<R>::contradictions; }) {
        return Describe<R>::contradictions;
    } else if constexpr (Surface<R>) {
        return {&static_below_dynamic, 1};
    } else {
        return {};
    }
}

template <class... R>
constexpr auto table(TypeList<R...>) {
    static_assert((... && (Surface<R> != Effect<R>)), "a representation is a surface or an effect");
    static_assert((... && geometry_comes_first<R>()), "geometry and velocity first, then the material");
    return std::array<KindInfo, sizeof...(R)>{KindInfo{.name = Describe<R>::name,
                                                       .fields = Describe<R>::fields,
                                                       .size = sizeof(R),
                                                       .geometry_bytes = geometry_bytes<R>(),
                                                       .surface = Surface<R>,
                                                       .validate = &validate<R>,
                                                       .contradictions = contradictions_of<R>()}...};
}

constexpr auto all_kinds = table(Representations{});

// FNV-1a, 64 bits.
struct Hash {
    std::uint64_t value = 0xcbf29ce484222325u;

    void add(std::string_view text) noexcept {
        for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
        add(text.size());
    }
    void add(std::uint64_t number) noexcept {
        for (int i = 0; i < 8; ++i) value = (value ^ ((number >> (8 * i)) & 0xff)) * 0x100000001b3u;
    }
};

}  // namespace

std::span<const KindInfo> kinds() noexcept {
    return all_kinds;
}

static_assert(Representations::size <= max_kinds);

template <Described R>
Kind kind_number() noexcept {
    return kind_of<R>;
}

namespace {
// Names one kind_number for each kind of the list, so that each is made here.
template <class... R>
constexpr std::array<Kind (*)() noexcept, sizeof...(R)> numbers(TypeList<R...>) {
    return {&kind_number<R>...};
}
[[gnu::used]] constexpr auto all_numbers = numbers(Representations{});
}  // namespace

std::uint64_t layout_hash() noexcept {
    Hash hash;
    for (const KindInfo& kind : all_kinds) {
        hash.add(kind.name);
        hash.add(kind.size);
        hash.add(kind.geometry_bytes);
        for (const Field& field : kind.fields) {
            hash.add(field.name);
            hash.add(static_cast<std::uint64_t>(field.type));
            hash.add(field.offset);
            hash.add(std::uint64_t{field.count});
            for (const std::string_view choice : field.choices) hash.add(choice);
        }
        hash.add(kind.fields.size());
    }
    return hash.value;
}

}  // namespace knurl

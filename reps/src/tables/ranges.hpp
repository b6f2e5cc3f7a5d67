#pragma once
// Whether parameters are legal, in the few comparisons that their table stands for: a constant row folds to
// these. The answer is only yes or no. check_field checks illegal parameters again and finds the message.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "tables/field_check.hpp"

namespace knurl {

namespace detail {

template <class R, std::size_t Row>
bool row_is_legal(const unsigned char* params) noexcept {
    constexpr Field field = Describe<R>::fields[Row];
    if constexpr (field.type == Field::Type::choice) {
        std::uint32_t value;
        std::memcpy(&value, params + field.offset, sizeof value);
        return value < field.choices.size();
    } else if constexpr (field.reals() == 0 || field.type == Field::Type::points) {
        return static_cast<bool>(check_field(field, Row, params));
    } else {
        constexpr double end = std::numeric_limits<double>::infinity();
        constexpr bool unbounded = !field.infinity_allowed && (field.minimum == -end || field.maximum == end);
        double value[field.reals()];
        std::memcpy(value, params + field.offset, sizeof value);
        double square = 0;
        for (const double v : value) {
            if (!legal(field, v) || (unbounded && std::isinf(v))) return false;
            square += v * v;
        }
        const bool needs_length = field.nonzero || field.type == Field::Type::quaternion;
        return !needs_length || square >= least_length * least_length;
    }
}

}  // namespace detail

/// Checks the rows that begin before `Bytes`; the others are known to be legal.
template <class R, std::size_t Bytes = sizeof(R)>
bool fields_are_legal(const void* params) noexcept {
    const auto* at = static_cast<const unsigned char*>(params);
    return [&]<std::size_t... Row>(std::index_sequence<Row...>) {
        return (... && (Describe<R>::fields[Row].offset >= Bytes || detail::row_is_legal<R, Row>(at)));
    }
    (std::make_index_sequence<std::size(Describe<R>::fields)>{});
}

/// Are so many bytes, whole words, equal?
template <std::size_t Bytes>
bool same_words(const void* a, const void* b) noexcept {
    static_assert(Bytes % 8 == 0);
    std::uint64_t differ = 0;
    for (std::size_t i = 0; i < Bytes; i += 8) {
        std::uint64_t x, y;
        std::memcpy(&x, static_cast<const char*>(a) + i, sizeof x);
        std::memcpy(&y, static_cast<const char*>(b) + i, sizeof y);
        differ |= x ^ y;
    }
    return differ == 0;
}

}  // namespace knurl

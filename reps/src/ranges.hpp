#pragma once
// Whether all fields of a kind lie inside their ranges, as one loop over its words without a branch. It only
// ever says "certainly legal": whoever fails is judged field by field, which also finds out what to say.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "field_check.hpp"

namespace knurl {

/// The leading bytes of R's parameters that the plane of a surface that stands follows from; 0: there are
/// none.
template <class R>
constexpr std::size_t shape_bytes_of() {
    if constexpr (requires { Describe<R>::shape_bytes; }) {
        return Describe<R>::shape_bytes;
    } else {
        return 0;
    }
}

template <class R>
struct Ranges {
    static constexpr std::size_t words = sizeof(R) / 8;
    std::array<double, words> low{}, high{}, also{};  // `also`: the one legal value outside of the range
    std::array<std::uint64_t, words> mask{};          // 0 where there is no real number
    bool complete = true;                             // every kind of field is understood

    constexpr Ranges() {
        also.fill(std::numeric_limits<double>::quiet_NaN());
        for (const Field& field : Describe<R>::fields) {
            std::size_t count = 0;
            switch (field.type) {
                case Field::Type::real:
                    count = 1;
                    break;
                case Field::Type::vector:
                    count = 3;
                    break;
                case Field::Type::matrix:
                    count = std::size_t{field.count} * field.count;
                    break;
                case Field::Type::choice:
                case Field::Type::integer:
                    break;
                case Field::Type::quaternion:
                case Field::Type::points:
                    complete = false;
                    break;
            }
            for (std::size_t i = field.offset / 8; i < field.offset / 8 + count; ++i) {
                mask[i] = ~std::uint64_t{0};
                low[i] = field.minimum;
                high[i] = field.maximum;
                if (field.automatic_allowed) also[i] = automatic;
                if (field.infinity_allowed) also[i] = std::numeric_limits<double>::infinity();
                // A range without an end would let infinity pass.
                complete = complete && field.minimum > -std::numeric_limits<double>::infinity() &&
                           field.maximum < std::numeric_limits<double>::infinity() &&
                           !(field.automatic_allowed && field.infinity_allowed);
            }
        }
    }
};

namespace detail {

// Two doubles at once: the compilers that this is built with turn comparisons of these into masks.
using Two = double __attribute__((vector_size(16)));
using TwoWords = std::uint64_t __attribute__((vector_size(16)));

template <class T>
T two(const void* at) noexcept {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

template <class R, std::size_t Row>
bool no_row_objects(const unsigned char* params) noexcept {
    constexpr Field field = Describe<R>::fields[Row];
    if constexpr (field.type == Field::Type::choice) {
        std::uint32_t value;
        std::memcpy(&value, params + field.offset, sizeof value);
        return value < field.choices.size();
    } else if constexpr (field.type == Field::Type::vector && field.nonzero) {
        double v[3];
        std::memcpy(v, params + field.offset, sizeof v);
        return v[0] * v[0] + v[1] * v[1] + v[2] * v[2] >= least_length * least_length;
    } else {
        return true;
    }
}

}  // namespace detail

/// `Bytes`: of the rows that begin before it; the others are known to be legal.
template <class R, std::size_t Bytes = sizeof(R)>
bool certainly_legal(const unsigned char* params) noexcept {
    static constexpr Ranges<R> ranges{};
    if constexpr (!ranges.complete || sizeof(R) % 16 != 0) {
        return false;
    } else {
        using detail::Two, detail::TwoWords, detail::two;
        TwoWords good = ~TwoWords{};
        for (std::size_t i = 0; i < Bytes / 8; i += 2) {
            const auto v = std::bit_cast<Two>(two<TwoWords>(params + 8 * i) & two<TwoWords>(&ranges.mask[i]));
            good &=
                std::bit_cast<TwoWords>(((v >= two<Two>(&ranges.low[i])) & (v <= two<Two>(&ranges.high[i]))) |
                                        (v == two<Two>(&ranges.also[i])));
        }
        if ((good[0] & good[1]) != ~std::uint64_t{0}) return false;
        return [&]<std::size_t... Row>(std::index_sequence<Row...>) {
            return (... &&
                    (Describe<R>::fields[Row].offset >= Bytes || detail::no_row_objects<R, Row>(params)));
        }
        (std::make_index_sequence<std::size(Describe<R>::fields)>{});
    }
}

}  // namespace knurl

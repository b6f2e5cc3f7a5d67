#pragma once

#include <cmath>
#include <cstring>

#include <knurl/reps/field.hpp>

namespace knurl {

inline constexpr double least_length = 1e-6;  // of a vector that is to give a direction

inline bool legal(const Field& field, double value) noexcept {
    return (value >= field.minimum && value <= field.maximum) ||
           (field.automatic_allowed && value == automatic) ||
           (field.infinity_allowed && value == std::numeric_limits<double>::infinity());
}

inline Verdict refuse(std::uint32_t index, double value) noexcept {
    return {std::isfinite(value) ? Verdict::Code::out_of_range : Verdict::Code::not_finite, index, value};
}

/// One field of the parameters at `params` against its row. Where the row is a constant all but the
/// comparisons that it asks for folds away. A range that is unbounded still refuses NaN and, unless allowed,
/// infinity.
inline Verdict check_field(const Field& field, std::uint32_t index, const unsigned char* params) noexcept {
    const unsigned char* at = params + field.offset;
    if (field.type == Field::Type::choice) {
        std::uint32_t value;
        std::memcpy(&value, at, sizeof value);
        if (value < field.choices.size()) return {};
        return {Verdict::Code::no_such_choice, index, static_cast<double>(value)};
    }
    double v[3] = {};
    const std::size_t count = field.type == Field::Type::vector ? 3 : 1;
    std::memcpy(v, at, count * sizeof(double));
    for (std::size_t i = 0; i < count; ++i) {
        if (!legal(field, v[i]) || (std::isinf(v[i]) && !field.infinity_allowed)) return refuse(index, v[i]);
    }
    const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    if (field.nonzero && square < least_length * least_length) {
        return {Verdict::Code::zero_vector, index, std::sqrt(square)};
    }
    return {};
}

}  // namespace knurl

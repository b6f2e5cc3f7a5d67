#pragma once

#include <cmath>
#include <cstring>

#include <knurl/reps/field.hpp>

namespace knurl {

inline constexpr double least_length = 1e-6;  // of a vector that gives a direction

inline bool legal(const Field& field, double value) noexcept {
    return (value >= field.minimum && value <= field.maximum) ||
           (field.automatic_allowed && value == automatic) ||
           (field.infinity_allowed && value == std::numeric_limits<double>::infinity());
}

inline Verdict refuse(std::uint32_t index, double value) noexcept {
    return {std::isfinite(value) ? Verdict::Code::out_of_range : Verdict::Code::not_finite, index, value};
}

/// Checks one field of the parameters at `params` against its row. For a constant row, all but the needed
/// comparisons folds away. An unbounded range still refuses NaN and, unless allowed, infinity.
inline Verdict check_field(const Field& field, std::uint32_t index, const unsigned char* params) noexcept {
    const unsigned char* at = params + field.offset;
    std::size_t reals = field.reals();
    if (reals == 0 || field.type == Field::Type::points) {
        std::uint32_t whole;
        std::memcpy(&whole, at + reals * sizeof(double), sizeof whole);
        const auto value = static_cast<double>(whole);
        if (field.type == Field::Type::choice) {
            if (whole >= field.choices.size()) return {Verdict::Code::no_such_choice, index, value};
        } else if (field.type == Field::Type::integer) {
            if (!legal(field, value)) return refuse(index, value);
        } else {
            if (whole < field.least || whole > field.count) return {Verdict::Code::count, index, value};
            reals = std::size_t{3} * whole;  // entries behind the last one are unused
        }
    }
    double square = 0;
    for (std::size_t i = 0; i < reals; ++i) {
        double value;
        std::memcpy(&value, at + i * sizeof value, sizeof value);
        if (!legal(field, value) || (std::isinf(value) && !field.infinity_allowed))
            return refuse(index, value);
        square += value * value;
    }
    const bool needs_length = field.nonzero || field.type == Field::Type::quaternion;
    if (needs_length && square < least_length * least_length)
        return {Verdict::Code::zero_vector, index, std::sqrt(square)};
    return {};
}

}  // namespace knurl

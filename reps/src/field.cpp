#include <cmath>
#include <cstring>

#include <knurl/reps/field.hpp>

namespace knurl {
namespace {

constexpr double least_length = 1e-6;

Verdict check_real(const Field& field, std::uint32_t index, double value) noexcept {
    if (field.automatic_allowed && value == automatic) return {};
    if (field.infinity_allowed && value == std::numeric_limits<double>::infinity()) return {};
    if (!std::isfinite(value)) return {Verdict::Code::not_finite, index, value};
    if (value < field.minimum || value > field.maximum) return {Verdict::Code::out_of_range, index, value};
    return {};
}

}  // namespace

Verdict validate_fields(std::span<const Field> fields, const void* params) noexcept {
    const auto* bytes = static_cast<const unsigned char*>(params);
    for (std::uint32_t index = 0; index < fields.size(); ++index) {
        const Field& field = fields[index];
        const unsigned char* at = bytes + field.offset;
        switch (field.type) {
            case Field::Type::real: {
                double value;
                std::memcpy(&value, at, sizeof value);
                if (const Verdict v = check_real(field, index, value); !v) return v;
                break;
            }
            case Field::Type::vector: {
                double v[3];
                std::memcpy(v, at, sizeof v);
                for (const double value : v) {
                    if (const Verdict verdict = check_real(field, index, value); !verdict) return verdict;
                }
                const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                if (field.nonzero && length < least_length)
                    return {Verdict::Code::zero_vector, index, length};
                break;
            }
            case Field::Type::choice: {
                std::uint32_t value;
                std::memcpy(&value, at, sizeof value);
                if (value >= field.choices.size()) {
                    return {Verdict::Code::no_such_choice, index, static_cast<double>(value)};
                }
                break;
            }
        }
    }
    return {};
}

}  // namespace knurl

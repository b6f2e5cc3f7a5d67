#include "params_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

namespace knurl::gateway {

namespace {

std::uint32_t whole_at(std::span<const std::byte> params, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, params.data() + at, sizeof value);
    return value;
}

double real_at(std::span<const std::byte> params, std::size_t at) {
    double value = 0;
    std::memcpy(&value, params.data() + at, sizeof value);
    return value;
}

Json field_value(const Field& field, std::span<const std::byte> params) {
    const auto reals = [&](std::size_t n) {
        Json values = Json::array();
        for (std::size_t i = 0; i < n; ++i)
            values.push_back(number_json(real_at(params, field.offset + i * sizeof(double))));
        return values;
    };
    switch (field.type) {
        case Field::Type::real: {
            const double value = real_at(params, field.offset);
            return value == automatic && field.automatic_allowed ? Json("automatic") : number_json(value);
        }
        case Field::Type::choice: {
            const std::uint32_t value = whole_at(params, field.offset);
            return value < field.choices.size() ? Json(std::string(field.choices[value])) : Json(value);
        }
        case Field::Type::integer:
            return whole_at(params, field.offset);
        case Field::Type::points: {
            const std::size_t n = std::min<std::size_t>(
                whole_at(params, field.offset + field.reals() * sizeof(double)), field.count);
            Json points = Json::array();
            for (std::size_t p = 0; p < n; ++p) {
                Json point = Json::array();
                for (std::size_t i = 0; i < 3; ++i)
                    point.push_back(
                        number_json(real_at(params, field.offset + (3 * p + i) * sizeof(double))));
                points.push_back(std::move(point));
            }
            return points;
        }
        default:
            return reals(field.reals());
    }
}

}  // namespace

Json number_json(double value) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? Json() : Json(value > 0 ? "inf" : "-inf");
}

Json params_json(Kind kind, std::span<const std::byte> params) {
    Json values = Json::object();
    for (const Field& field : kinds()[kind].fields) values[field.name] = field_value(field, params);
    return values;
}

}  // namespace knurl::gateway

#include "kind_message.hpp"

#include <array>
#include <cstring>

#include <fmt/format.h>

#include <knurl/reps/vec.hpp>

#include "ros_messages.h"

namespace knurl::dds {

namespace {

/// What every sequence of idlc's begins with.
struct Sequence {
    std::uint32_t maximum;
    std::uint32_t length;
    const double* buffer;  // of doubles, or of three of them
    bool release;
};

void put(std::vector<std::byte>& params, std::size_t at, const void* from, std::size_t bytes) {
    std::memcpy(params.data() + at, from, bytes);
}

/// All zero, where that cannot be.
bool is_unset(const Field& field, const std::vector<std::byte>& params) {
    const bool part = field.name.find('.') != std::string_view::npos;
    const bool never_zero =
        field.type == Field::Type::quaternion ||
        (part && (field.type == Field::Type::vector ? field.nonzero
                                                    : field.type == Field::Type::real && field.minimum > 0));
    if (!never_zero) return false;
    std::array<double, 4> values{};
    std::memcpy(values.data(), params.data() + field.offset, field.reals() * sizeof(double));
    return values == std::array<double, 4>{};
}

/// A sequence of numbers or of points, whose length a peer has stated.
std::string read_many(const KindInfo& kind, const Field& field, const std::byte* at,
                      std::vector<std::byte>& params) {
    Sequence many{};
    std::memcpy(&many, at, sizeof many);
    const bool points = field.type == Field::Type::points;
    const std::size_t most = points ? field.count : field.reals(), least = points ? field.least : most;
    if (many.length < least || many.length > most)
        return fmt::format(
            "{}.{} has {} {}; {}", kind.name, field.name, many.length, points ? "points" : "numbers",
            least == most ? fmt::format("give {}", most) : fmt::format("give {} to {}", least, most));
    const std::size_t doubles = points ? std::size_t{3} * many.length : many.length;
    if (doubles > 0) put(params, field.offset, many.buffer, doubles * sizeof(double));
    if (points) put(params, field.offset + field.reals() * sizeof(double), &many.length, sizeof many.length);
    return {};
}

}  // namespace

static_assert(sizeof(dds_sequence_t) == sizeof(Sequence) &&
              offsetof(dds_sequence_t, _buffer) == offsetof(Sequence, buffer));
static_assert(sizeof(geometry_msgs_msg_dds__Vector3_) == 3 * sizeof(double));
static_assert(sizeof(Vec3) == 3 * sizeof(double));

std::string read_params(const KindMessage& message, const void* sample, std::vector<std::byte>& params) {
    const KindInfo& kind = kinds()[message.kind];
    params.assign(kind.size, std::byte{0});
    const auto* from = static_cast<const std::byte*>(sample);
    for (std::size_t i = 0; i < kind.fields.size(); ++i) {
        const Field& field = kind.fields[i];
        const std::byte* at = from + message.fields[i];
        switch (field.type) {
            case Field::Type::real:
                put(params, field.offset, at, sizeof(double));
                break;
            case Field::Type::vector:
                put(params, field.offset, at, sizeof(Vec3));
                break;
            case Field::Type::quaternion: {
                geometry_msgs_msg_dds__Quaternion_ q;
                std::memcpy(&q, at, sizeof q);
                const Quat ours{.w = q.w, .x = q.x, .y = q.y, .z = q.z};
                put(params, field.offset, &ours, sizeof ours);
                break;
            }
            case Field::Type::choice:
            case Field::Type::integer:
                put(params, field.offset, at, sizeof(std::uint32_t));
                break;
            case Field::Type::matrix:
            case Field::Type::points:
                if (std::string wrong = read_many(kind, field, at, params); !wrong.empty()) return wrong;
                break;
        }
        if (is_unset(field, params))
            put(params, field.offset, message.defaults.data() + field.offset, field.bytes());
    }
    return {};
}

}  // namespace knurl::dds

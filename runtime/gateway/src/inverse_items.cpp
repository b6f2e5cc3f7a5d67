#include "inverse_items.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include <knurl/reps/all.hpp>
#include <knurl/scenefile/scene_file.hpp>
#include <knurl/words/nearest.hpp>
#include <knurl/words/printable.hpp>

#include "params_text.hpp"

namespace knurl::gateway {

namespace {

constexpr std::size_t longest_id = 64;     // bytes
constexpr std::size_t longest_quote = 60;  // bytes of a client's text in our messages

Kind kind_named(const Json& stated) {
    if (!stated.contains("kind") || !stated.at("kind").is_string())
        throw InverseMistake("knurl.add needs a kind; write \"kind\": \"plane\"");
    Kind kind = 0;
    try {
        kind = kind_of_name(stated.at("kind").get<std::string>());
    } catch (const std::runtime_error& error) {
        throw InverseMistake(error.what());
    }
    if (kind == kind_of<Shape>)
        throw InverseMistake(
            "a shape needs a mesh, and this protocol has no way to send one; see knurl-web's page");
    return kind;
}

scenefile::Stated read(Kind kind, const Json& stated, std::span<const std::byte> before) {
    Json fields = stated;
    fields.erase("kind");
    try {
        return scenefile::read_stated(kind, toml_of(fields), before);
    } catch (const std::runtime_error& error) {
        throw InverseMistake(error.what());
    }
}

Eigen::Matrix3d matrix_of(const Axes& axes, bool axial) {
    Eigen::Matrix3d matrix;
    const Vec3 units[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i)
        matrix.col(i) = to_eigen(axial ? axes.axial(units[i]) : axes.direction(units[i]));
    return matrix;
}

template <class T, class Change>
void change_at(std::byte* place, Change change) {
    T value;
    std::memcpy(&value, place, sizeof value);
    value = change(value);
    std::memcpy(place, &value, sizeof value);
}

Vec3 vector_in(const Axes& axes, const Field& field, const Vec3& v) {
    if (field.name == "half_size") {  // of a box along its own axes: no direction, so without a sign
        const Vec3 turned = axes.direction(v);
        return {std::abs(turned.x), std::abs(turned.y), std::abs(turned.z)};
    }
    return field.unit == "N m" || field.unit == "rad/s" ? axes.axial(v) : axes.direction(v);
}

void matrix_in(const Axes& axes, const Field& field, std::byte* place) {
    const Eigen::Matrix3d polar = matrix_of(axes, false), axial = matrix_of(axes, true);
    if (field.count == 3) {
        change_at<Mat3>(place,
                        [&](const Mat3& m) { return to_mat3(polar * to_eigen(m) * polar.transpose()); });
    } else if (field.count == 6) {  // a force and a torque by a displacement and a rotation
        Eigen::Matrix<double, 6, 6> both = Eigen::Matrix<double, 6, 6>::Zero();
        both.topLeftCorner<3, 3>() = polar;
        both.bottomRightCorner<3, 3>() = axial;
        change_at<Mat6>(place, [&](const Mat6& m) { return to_mat6(both * to_eigen(m) * both.transpose()); });
    }
}

void points_in(const Axes& axes, const Field& field, std::byte* place) {
    std::uint32_t used = 0;
    std::memcpy(&used, place + field.reals() * sizeof(double), sizeof used);
    std::vector<Vec3> points(std::min(used, field.count));
    std::memcpy(points.data(), place, points.size() * sizeof(Vec3));
    for (Vec3& point : points) point = axes.direction(point);
    // Their order stays, also where the client's axes are left-handed: "counter-clockwise, seen from the front" is said of
    // what the user sees, not of a cross product.
    std::memcpy(place, points.data(), points.size() * sizeof(Vec3));
}

}  // namespace

std::string read_item_id(const Json& stated) {
    if (!stated.is_object())
        throw InverseMistake("a representation is an object; write {\"id\": \"floor\", ...}");
    if (!stated.contains("id") || !stated.at("id").is_string() || stated.at("id") == "")
        throw InverseMistake(
            "a representation needs an id, by which it is changed later; write \"id\": \"floor\"");
    auto id = stated.at("id").get<std::string>();
    if (id.size() > longest_id)
        throw InverseMistake(fmt::format("an id has {} bytes; give at most {}", id.size(), longest_id));
    return id;
}

InverseItem read_item(const Json& stated) {
    InverseItem item;
    item.id = read_item_id(stated);
    item.kind = kind_named(stated);
    auto read_as = read(item.kind, stated, {});
    item.options = read_as.options.value_or(AddOptions{});
    item.params = std::move(read_as.params);
    return item;
}

InverseItem read_change(const Json& stated, const InverseItem& before) {
    InverseItem item = before;
    if (stated.contains("kind") && stated.at("kind") != std::string(kinds()[before.kind].name))
        throw InverseMistake(fmt::format("'{}' is a {}; its kind stays, add another one instead",
                                         words::printable(item.id, longest_quote),
                                         kinds()[before.kind].name));
    auto read_as = read(item.kind, stated, before.params);
    if (read_as.options)
        throw InverseMistake(
            fmt::format("probe, on_silence and silence_time of '{}' were fixed when it was added; add it "
                        "again to change them",
                        words::printable(item.id, longest_quote)));
    item.params = std::move(read_as.params);
    return item;
}

std::vector<std::byte> in_axes(const Axes& axes, Kind kind, const std::vector<std::byte>& params) {
    std::vector<std::byte> turned = params;
    for (const Field& field : kinds()[kind].fields) {
        std::byte* const place = turned.data() + field.offset;
        switch (field.type) {
            case Field::Type::vector:
                change_at<Vec3>(place, [&](const Vec3& v) { return vector_in(axes, field, v); });
                break;
            case Field::Type::quaternion:
                change_at<Quat>(place, [&](const Quat& q) { return axes.orientation(q); });
                break;
            case Field::Type::points:
                points_in(axes, field, place);
                break;
            case Field::Type::matrix:
                matrix_in(axes, field, place);
                break;
            case Field::Type::real:
            case Field::Type::choice:
            case Field::Type::integer:
                break;
        }
    }
    return turned;
}

}  // namespace knurl::gateway

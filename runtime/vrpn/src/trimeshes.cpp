#include "trimeshes.hpp"

#include <cstring>
#include <unordered_map>

#include <fmt/format.h>

#include "turn.hpp"

namespace knurl::vrpn {

namespace {

std::vector<std::byte> bytes_of(const Shape& shape) {
    std::vector<std::byte> bytes(sizeof shape);
    std::memcpy(bytes.data(), &shape, sizeof shape);
    return bytes;
}

bool rigid(const Eigen::Affine3d& place) {
    const Eigen::Matrix3d turn = place.linear();
    return turn.determinant() > 0 &&
           (turn.transpose() * turn - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-4;
}

/// A matrix of 16 numbers, row by row. Those whose last row is no (0, 0, 0, 1) have it as the last column: row vectors.
std::optional<Eigen::Affine3d> affine(const std::array<float, 16>& values) {
    const Eigen::Matrix4d rows =
        Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(values.data()).cast<double>();
    const Eigen::RowVector4d last(0, 0, 0, 1);
    Eigen::Affine3d place;
    if (rows.row(3).isApprox(last, 1e-6))
        place.matrix() = rows;
    else if (rows.col(3).transpose().isApprox(last, 1e-6))
        place.matrix() = rows.transpose();
    else
        return std::nullopt;
    return place;
}

}  // namespace

Eigen::Affine3d Trimeshes::Object::place() const {
    return Eigen::Translation3d(position) * orientation * Eigen::Scaling(scale) * transform;
}

std::string Trimeshes::name_of(std::int32_t number) {
    return fmt::format("mesh {}", number);
}

Trimeshes::Object* Trimeshes::made(std::int32_t number, std::string& refused) {
    if (const auto found = objects_.find(number); found != objects_.end()) return &found->second;
    if (objects_.size() >= most_objects) {
        refused = fmt::format("object {} is one more than the {} that a client may have; remove one first",
                              number, most_objects);
        return nullptr;
    }
    return &objects_[number];
}

std::string Trimeshes::vertex(const VertexMessage& message) {
    const std::string what = fmt::format("vertex {} of object {}", message.index, message.object);
    std::string refused = refuse_all(what, message.value, farthest);
    if (!refused.empty()) return refused;
    Object* object = made(message.object, refused);
    if (object == nullptr) return refused;
    if (!object->vertices.contains(message.index)) {
        if (vertices_ >= most_vertices)
            return fmt::format("{} is one more than the {} vertices that a client may have", what,
                               most_vertices);
        ++vertices_;
    }
    object->vertices[message.index] = message.value;
    return {};
}

std::string Trimeshes::triangle(const TriangleMessage& message) {
    std::string refused;
    Object* object = made(message.object, refused);
    if (object == nullptr) return refused;
    if (!object->triangles.contains(message.index)) {
        if (triangles_ >= most_triangles)
            return fmt::format(
                "triangle {} of object {} is one more than the {} triangles that a client may have",
                message.index, message.object, most_triangles);
        ++triangles_;
    }
    object->triangles[message.index] = message;
    return {};
}

std::string Trimeshes::update(const TrimeshMessage& message, double max_stiffness) {
    const auto found = objects_.find(message.object);
    if (found == objects_.end())
        return fmt::format("object {} has no triangles; send setVertex and setTriangle first",
                           message.object);
    std::string refused = refuse("kspring", message.stiffness, 0, 1e9);
    if (refused.empty()) refused = refuse("kdamp", message.damping, 0, 1e9);
    if (refused.empty()) refused = refuse("static friction", message.static_friction, 0, 100);
    if (refused.empty()) refused = refuse("dynamic friction", message.dynamic_friction, 0, 100);
    if (!refused.empty()) return fmt::format("object {}: {}", message.object, refused);

    Object& object = found->second;
    auto mesh = std::make_shared<gateway::PeerMesh>();
    std::unordered_map<std::int32_t, std::uint32_t> row;
    for (const auto& [index, at] : object.vertices) {
        row[index] = static_cast<std::uint32_t>(mesh->vertices.size());
        mesh->vertices.push_back({at[0], at[1], at[2]});
    }
    bool smooth = false;
    for (const auto& [index, triangle] : object.triangles) {
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto corner = row.find(triangle.vertices[i]);
            if (corner == row.end())
                return fmt::format(
                    "triangle {} of object {} names vertex {}, which was not set; nothing of the object "
                    "is changed",
                    index, message.object, triangle.vertices[i]);
            corners[i] = corner->second;
        }
        smooth = smooth || triangle.normals[0] >= 0;
        mesh->triangles.push_back(corners);
    }
    if (mesh->triangles.empty())
        return fmt::format("object {} has no triangles; send setTriangle first", message.object);
    object.mesh = std::move(mesh);
    object.shape = {.shading = smooth ? Shading::smooth : Shading::flat,
                    .stiffness = std::min(1.0, double{message.stiffness}) * max_stiffness,
                    .damping = mapping_.damping_unit * double{message.damping},
                    .friction = {.static_ = std::max(message.static_friction, message.dynamic_friction),
                                 .dynamic = message.dynamic_friction}};
    return object.touchable ? send(message.object, object) : std::string{};
}

/// The mesh itself, and where it is.
std::string Trimeshes::send(std::int32_t number, Object& object) {
    const Eigen::Affine3d place = object.place();
    object.baked = !rigid(place);
    const Eigen::Affine3d as_sent = object.baked ? place : Eigen::Affine3d::Identity();
    const Eigen::Matrix3d turn = turn_of(mapping_.axes.back());
    auto mesh = std::make_shared<gateway::PeerMesh>(*object.mesh);
    for (auto& vertex : mesh->vertices) {
        const Eigen::Vector3d at = turn * (as_sent * Eigen::Vector3d(vertex.data()));
        vertex = {at.x(), at.y(), at.z()};
    }
    // What is mirrored has its outside inside.
    if (turn.determinant() * as_sent.linear().determinant() < 0)
        for (auto& triangle : mesh->triangles) std::swap(triangle[1], triangle[2]);
    object.felt = true;
    const std::string refused = hand_.mesh(name_of(number), std::move(mesh), bytes_of(object.shape));
    return refused.empty() ? show(number, object) : refused;
}

/// Where it is.
std::string Trimeshes::show(std::int32_t number, Object& object) {
    if (!object.felt) return {};
    const Eigen::Affine3d place = object.place();
    if (object.baked || !rigid(place)) {
        object.shape.position = {};
        object.shape.orientation = {};
        return hand_.set(name_of(number), bytes_of(object.shape));
    }
    const Eigen::Matrix3d turn = turn_of(mapping_.axes.back());
    object.shape.position = to_plain(Eigen::Vector3d(turn * place.translation()));
    object.shape.orientation =
        to_plain(Eigen::Quaterniond(Eigen::Matrix3d(turn * place.linear() * turn.transpose())).normalized());
    return hand_.set(name_of(number), bytes_of(object.shape));
}

void Trimeshes::hide(std::int32_t number, Object& object) {
    if (object.felt) hand_.remove(name_of(number));
    object.felt = false;
}

void Trimeshes::erase(std::int32_t number) {
    const auto found = objects_.find(number);
    if (found == objects_.end()) return;
    hide(number, found->second);
    vertices_ -= found->second.vertices.size();
    triangles_ -= found->second.triangles.size();
    objects_.erase(found);
}

std::string Trimeshes::place(Type type, Object& object, const ObjectMessage& message) {
    std::string refused =
        refuse_all(fmt::format("the place of object {}", message.object), message.values, farthest);
    if (!refused.empty()) return refused;
    const Eigen::Vector3d vector = to_eigen(vec_of(message.values.data()));
    if (type == Type::object_position) object.position = vector;
    if (type == Type::object_scale) {
        if (vector.cwiseAbs().minCoeff() < 1e-6)
            return fmt::format("the scale of object {} is 0; it must not be", message.object);
        object.scale = vector;
    }
    if (type == Type::object_orientation) {
        if (vector.norm() < 1e-9)
            return fmt::format("the axis of object {} has no direction", message.object);
        object.orientation = Eigen::AngleAxisd(double{message.values[3]}, vector.normalized());
    }
    if (type == Type::transform_trimesh) {
        const auto matrix = affine(message.values);
        if (!matrix || std::abs(matrix->linear().determinant()) < 1e-12)
            return fmt::format(
                "the matrix of object {} is no invertible affine map: its last row must be 0, 0, 0, 1",
                message.object);
        object.transform = *matrix;
    }
    if (!object.felt) return {};
    // The servo moves a mesh; one that is stretched is another mesh.
    if (object.baked || !rigid(object.place())) return send(message.object, object);
    return show(message.object, object);
}

std::string Trimeshes::object(Type type, const ObjectMessage& message) {
    std::string refused;
    if (type == Type::clear_trimesh || type == Type::remove_object) {
        erase(message.object);
        return {};
    }
    if ((type == Type::add_object || type == Type::move_to_parent) && message.number != -1)
        return fmt::format(
            "object {} has the parent {}; only the root, -1, is known here: send its place in the world",
            message.object, message.number);
    Object* object = made(message.object, refused);
    if (object == nullptr) return refused;
    switch (type) {
        case Type::remove_triangle:
            triangles_ -= object->triangles.erase(message.number);
            return {};
        case Type::object_touchable:
            object->touchable = message.number != 0;
            if (!object->touchable) hide(message.object, *object);
            if (object->touchable && object->mesh && !object->felt) return send(message.object, *object);
            return {};
        case Type::object_position:
        case Type::object_scale:
        case Type::object_orientation:
        case Type::transform_trimesh:
            return place(type, *object, message);
        default:
            return {};  // add_object, add_object_outside, set_trimesh_type: it is there
    }
}

}  // namespace knurl::vrpn

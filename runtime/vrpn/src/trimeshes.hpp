#pragma once
// The meshes that a client builds up vertex by vertex. They are felt from updateTrimeshChanges on. Private to this module.

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include <knurl/gateway/peer_hand.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/vrpn/mapping.hpp>
#include <knurl/vrpn/messages.hpp>

namespace knurl::vrpn {

class Trimeshes {
  public:
    Trimeshes(gateway::PeerCommands& hand, const Mapping& mapping) : hand_(hand), mapping_(mapping) {}

    // Each returns why it is refused, in one line; empty: it is not.
    std::string vertex(const VertexMessage& message);
    std::string triangle(const TriangleMessage& message);
    /// `max_stiffness` (N/m): of the device.
    std::string update(const TrimeshMessage& message, double max_stiffness);
    /// What is said of an object in one message.
    std::string object(Type type, const ObjectMessage& message);

  private:
    struct Object {
        std::map<std::int32_t, std::array<float, 3>> vertices;
        std::map<std::int32_t, TriangleMessage> triangles;
        bool smooth = false;  // it names normals
        // Where it is, in the client's axes.
        Eigen::Affine3d transform = Eigen::Affine3d::Identity();
        Eigen::Vector3d position = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
        Eigen::AngleAxisd orientation{0, Eigen::Vector3d::UnitX()};
        bool touchable = true;
        // Of the newest update.
        Shape shape;
        std::shared_ptr<const gateway::PeerMesh> mesh;  // in the client's axes, without its place
        bool felt = false;
        bool baked = false;  // what the servo has is the mesh with its place: the place is no rotation

        Eigen::Affine3d place() const;
    };

    Object* made(std::int32_t number, std::string& refused);
    std::string show(std::int32_t number, Object& object);
    std::string send(std::int32_t number, Object& object);
    void hide(std::int32_t number, Object& object);
    void erase(std::int32_t number);
    std::string place(Type type, Object& object, const ObjectMessage& message);
    static std::string name_of(std::int32_t number);

    gateway::PeerCommands& hand_;
    const Mapping& mapping_;
    std::map<std::int32_t, Object> objects_;
    std::size_t vertices_ = 0, triangles_ = 0;
};

}  // namespace knurl::vrpn

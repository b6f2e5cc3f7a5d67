#include "methods.hpp"

#include <knurl/geometry/proxy.hpp>
#include <knurl/reps/shape.hpp>

#include "active_set.hpp"
#include "mesh_surface.hpp"

#if defined(KNURL_EMBREE)
#include "embree_scene.hpp"
#endif

namespace knurl::test {
namespace {

using Eigen::Vector3d;

class Walk : public Method {
  public:
    Walk(std::string called, const Asset& asset) : Method(std::move(called)), asset_(asset) {}
    void begin(std::size_t, const Vector3d&) override { proxy_ = {}; }
    ProxyPoint step(const Vector3d& hand) override {
        Foot foot;
        Work work;
        const bool touches = follow(asset_, proxy_, hand, 0, foot, work);
        return {touches ? foot.point : hand, touches};
    }

  private:
    const Asset& asset_;
    Proxy proxy_;
};

/// The method of Zilles and Salisbury in every cycle, on the same faces and tree.
class ActiveSet : public Method {
  public:
    explicit ActiveSet(const Mesh& mesh)
        : Method("active set"), data_(mesh.data()), surface_(data_, data_.faces.data(), data_.faces.size()) {}
    void begin(std::size_t, const Vector3d& first) override { at_ = detail::to_vec(first - data_.origin); }
    ProxyPoint step(const Vector3d& hand) override {
        Work work;
        const detail::Held held = hold(surface_, at_, detail::to_vec(hand - data_.origin), work);
        at_ = held.at;
        if (held.faces == 0) return {hand, false};
        return {data_.origin + detail::to_eigen(held.foot), true};
    }

  private:
    const MeshData& data_;
    detail::MeshSurface<Face> surface_;
    detail::Vec at_{0, 0, 0};
};

#if defined(KNURL_EMBREE)
class EmbreePoint : public Method {
  public:
    explicit EmbreePoint(const Relief& relief) : Method("Embree point query"), scene_(relief.shape) {}
    void begin(std::size_t, const Vector3d&) override {}
    ProxyPoint step(const Vector3d& hand) override {
        const EmbreeScene::Nearest nearest = scene_.nearest(hand);
        if (nearest.triangle == RTC_INVALID_GEOMETRY_ID) return {hand, false};
        const Vector3d point = nearest.point.cast<double>();
        const bool behind = (point - hand).dot(scene_.normal(nearest.triangle).cast<double>()) > 0;
        return {behind ? point : hand, behind};
    }

  private:
    EmbreeScene scene_;
};
#endif

/// The walk as the servo runs it, as a representation of a scene.
class InAScene : public Method {
  public:
    explicit InAScene(const Mesh& mesh)
        : Method("mesh in a scene"), scene_({.representations = 4, .probes = 1}, {}) {
        scene_.set_asset(1, &mesh);
    }
    void begin(std::size_t, const Vector3d& first) override {
        scene_.clear();
        (void)scene_.add({0, 1}, Shape{.asset = 1, .stiffness = LocalScene::stiffness});
        scene_.settle();
        probe_ = {};
        probe_.position = first;
    }
    ProxyPoint step(const Vector3d& hand) override {
        probe_.velocity = (hand - probe_.position) / LocalScene::period;
        probe_.smooth_velocity = probe_.velocity;
        probe_.position = hand;
        const Vector3d force = scene_.evaluate(probe_, LocalScene::period).force;
        return {hand + force / LocalScene::stiffness, !force.isZero(0)};
    }

  private:
    Scene scene_;
    Probe probe_;
};

class FromAnApplication : public Method {
  public:
    FromAnApplication(const Local& how, const Mesh& mesh, const std::vector<Hand>& hands)
        : Method(how.cap ? "cap" : "plane"), scene_(how) {
        rate = how.rate, predicted = how.predicted;
        for (const Hand& hand : hands) said_.push_back(said_along(hand, mesh, how));
    }
    void begin(std::size_t hand, const Vector3d&) override { scene_.begin(said_[hand]); }
    ProxyPoint step(const Vector3d& hand) override {
        const Vector3d force = scene_.next(hand);
        return {hand + force / LocalScene::stiffness, !force.isZero(0)};
    }

  private:
    LocalScene scene_;
    std::vector<std::vector<Said>> said_;
};

}  // namespace

Shapes::Shapes(const Relief& relief)
    : mesh({.vertices = relief.shape.vertices, .triangles = relief.shape.triangles, .materials = {}},
           {.budget = std::size_t{1} << 30, .find_crossings = false}),
      field(relief.heights, relief.grid()) {}

Methods walkers(const Shapes& shapes) {
    Methods all;
    all.push_back(std::make_unique<Walk>("walk", shapes.mesh));
    all.push_back(std::make_unique<ActiveSet>(shapes.mesh));
    return all;
}

Methods whole_surfaces([[maybe_unused]] const Relief& relief, const Shapes& shapes) {
    Methods all = walkers(shapes);
    all.push_back(std::make_unique<Walk>("height field", shapes.field));
#if defined(KNURL_EMBREE)
    all.push_back(std::make_unique<EmbreePoint>(relief));
#endif
    return all;
}

Methods in_a_scene(const Shapes& shapes, const std::vector<Hand>& hands) {
    Methods all;
    all.push_back(std::make_unique<InAScene>(shapes.mesh));
    for (const bool cap : {false, true})
        for (const bool predicted : {false, true})
            for (const double rate : {20.0, 60.0, 200.0, 1000.0})
                all.push_back(std::make_unique<FromAnApplication>(
                    Local{.cap = cap, .rate = rate, .predicted = predicted}, shapes.mesh, hands));
    return all;
}

}  // namespace knurl::test

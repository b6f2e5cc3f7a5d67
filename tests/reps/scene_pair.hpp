#pragma once
// Skipping changes nothing: the scene as it is, and its twin in which each surface is evaluated in every cycle.

#include <limits>

#include <knurl/reps/scene.hpp>
#include <knurl/reps/shape.hpp>

namespace knurl::test {

/// No rise rule and automatic = 10 ms, unless a test states otherwise.
inline constexpr FadePolicy test_fade{.automatic = 0.01,
                                      .rise_speed = std::numeric_limits<double>::infinity()};

/// The surface with no bound: a velocity that moves it nowhere, and on a mesh also a relief without height.
template <class R>
R always_evaluated(R surface) {
    surface.velocity.x += 1e-300;
    if constexpr (std::is_same_v<R, Shape>) surface.texture.amplitude = 1e-300;
    return surface;
}

struct ScenePair {
    Scene skipping, exhaustive;

    explicit ScenePair(const Scene::Capacity& capacity = {.representations = 64, .probes = 16},
                       const Limits& limits = {}, const FadePolicy& fade = test_fade)
        : skipping(capacity, limits), exhaustive(capacity, limits) {
        each([&](Scene& scene) { scene.set_fade(fade); });
    }
    template <class Act>
    void each(Act&& act) {
        act(skipping);
        act(exhaustive);
    }
    template <class R>
    bool add(RepresentationId id, const R& surface, const AddOptions& options = {}) {
        return bool(skipping.add(id, surface, options)) &&
               bool(exhaustive.add(id, always_evaluated(surface), options));
    }
    template <class R>
    bool update(RepresentationId id, const R& surface) {
        return bool(skipping.update(id, surface)) && bool(exhaustive.update(id, always_evaluated(surface)));
    }
    bool remove(RepresentationId id) { return bool(skipping.remove(id)) && bool(exhaustive.remove(id)); }
    bool place_probe(std::uint32_t number, const ProbePlacement& placement) {
        return bool(skipping.place_probe(number, placement)) &&
               bool(exhaustive.place_probe(number, placement));
    }
    void set_asset(std::uint32_t number, const Asset* asset) {
        each([&](Scene& scene) { scene.set_asset(number, asset); });
    }
    void settle() {
        each([](Scene& scene) { scene.settle(); });
    }
};

}  // namespace knurl::test

// Worlds of any scale: the hand feels the same, to the last bit for powers of two. Every kind is tested by
// the units of its fields.

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <generators.hpp>
#include <gtest/gtest.h>

#include <knurl/geometry/mesh.hpp>

#include "scene_tools.hpp"

namespace scales_tests {
namespace {

using namespace knurl;
using namespace knurl::test;

/// Metres and newtons of the world for one of the device.
struct Scale {
    double metre = 1, newton = 1;

    /// A value of that unit, converted to the world; seconds, radians and shares stay the same.
    double of(std::string_view unit) const {
        static const std::map<std::string_view, std::pair<int, int>> powers{
            {"1", {0, 0}},    {"s", {0, 0}},      {"Hz", {0, 0}},    {"rad", {0, 0}},  {"rad/s", {0, 0}},
            {"m", {1, 0}},    {"m/s", {1, 0}},    {"m/s^2", {1, 0}}, {"1/m", {-1, 0}}, {"N", {0, 1}},
            {"N/m", {-1, 1}}, {"N s/m", {-1, 1}}, {"kg", {-1, 1}},   {"N m", {1, 1}},  {"N m s/rad", {1, 1}},
        };
        const auto [length, force] = powers.at(unit);  // a new unit has to be named here
        return std::pow(metre, length) * std::pow(newton, force);
    }
};

template <class R>
R scaled(R params, const Scale& scale) {
    for (const Field& field : Describe<R>::fields) {
        for (std::size_t i = 0; i < field.reals(); ++i) {
            double by = 1;
            if (field.unit == "(N, N m) per (m, rad)") {
                const Scale& s = scale;
                by = (i / 6 < 3 ? s.newton : s.of("N m")) / (i % 6 < 3 ? s.metre : 1);
            } else {
                by = scale.of(field.unit);
            }
            Field one = field;
            one.offset += i * sizeof(double);
            set_real(&params, field, by * get_real(&params, one), static_cast<int>(i));
        }
    }
    return params;
}

/// The device's limits in its own units, converted to the world as by limits_for.
Limits scaled(const Limits& device, const Scale& scale) {
    Limits world = device;
    world.max_stiffness *= scale.of("N/m");
    world.max_force *= scale.of("N");
    world.max_torque *= scale.of("N m");
    world.max_torsion *= scale.of("N m");
    world.damping *= scale.of("N s/m");
    world.mass *= scale.of("kg");
    world.resolution *= scale.of("m");
    world.metre = scale.metre;
    world.newton = scale.newton;
    return world;
}

/// A closed body of 60 mm in the device's metres.
std::unique_ptr<Mesh> mesh_of(test::MadeMesh body, const Scale& scale) {
    for (auto& vertex : body.vertices)
        for (auto& coordinate : vertex) coordinate *= scale.metre;
    return std::make_unique<Mesh>(Triangles{.vertices = body.vertices, .triangles = body.triangles},
                                  MeshBuild{.exact = true});
}

struct World {
    Scale scale;
    std::unique_ptr<Mesh> asset;
    Scene scene;

    World(const Scale& size, const Limits& device, const FadePolicy& fade)
        : scale(size),
          asset(mesh_of(cube(6), size)),
          scene({.representations = 16, .probes = 2}, scaled(device, size)) {
        scene.set_fade(fade);
        scene.set_asset(1, asset.get());
    }

    Probe probe_of(Probe hand) const {
        hand.position *= scale.metre;
        hand.velocity *= scale.metre;
        hand.smooth_velocity *= scale.metre;
        return hand;
    }
    /// In the device's units.
    Wrench evaluate(const Probe& hand, double step) {
        Wrench w = scene.evaluate(probe_of(hand), step);
        w.force /= scale.newton;
        w.torque /= scale.of("N m");
        return w;
    }
};

/// With sizes near the device's, so that the values are legal in all worlds.
template <class R>
R some_params(Rng& rng, const std::vector<Scale>& scales) {
    for (;;) {
        R params = random_params<R>(rng, false);
        for (const Field& field : Describe<R>::fields) {
            const bool one = field.reals() == 1 && between(rng, 0, 3) == 0;
            if (one && field.infinity_allowed) set_real(&params, field, infinity);
            if (one && field.automatic_allowed) set_real(&params, field, automatic);
        }
        if constexpr (requires { params.texture.amplitude; }) {
            params.texture.amplitude *= 1e-3;
            params.snag.d_snap *= 0.01;
            params.snag.d_mean *= 0.01;
        }
        if constexpr (requires { params.asset; }) params.asset = 1;
        if constexpr (requires { params.velocity; }) {
            if (between(rng, 0, 2)) params.velocity = {};
        }
        bool legal = true;
        for (const Scale& scale : scales) {
            const R there = scaled(params, scale);
            legal = legal && kinds()[kind_of<R>].validate(&there);
        }
        if (legal) return params;
    }
}

using Send = std::function<bool(World&, RepresentationId, const AddOptions&)>;

template <class... R>
Send some_change(TypeList<R...>, Rng& rng, Kind kind, bool update, const std::vector<Scale>& scales) {
    Send send;
    const auto make = [&]<class One>(One*) {
        if (kind != kind_of<One>) return;
        send = [params = some_params<One>(rng, scales), update](World& world, RepresentationId id,
                                                                const AddOptions& options) {
            const One there = scaled(params, world.scale);
            return static_cast<bool>(update ? world.scene.update(id, there)
                                            : world.scene.add(id, there, options));
        };
    };
    (make(static_cast<R*>(nullptr)), ...);
    return send;
}

/// Random scenes and paths; fails unless all worlds give the same forces.
void compare(std::uint64_t seed, int cycles, std::uint64_t& touched) {
    Rng rng(seed);
    const std::vector<Scale> scales{{},          {0x1p-7, 1},   {0x1p10, 1},     {2, 1},
                                    {0x1p-3, 8}, {0x1p5, 0.25}, {0x1p-1, 0x1p-4}};
    Limits device;
    if (between(rng, 0, 1))
        device = {.max_stiffness = 1200,
                  .max_force = 8.5,
                  .max_torque = 0.3,
                  .max_torsion = 0.5,
                  .damping = 0.2,
                  .mass = between(rng, 0, 1) ? 0.1 : 0,
                  .lag = 0.5e-3};
    const FadePolicy fade{.automatic = 0.01, .rise_speed = between(rng, 0, 1) ? 0.1 : infinity};
    std::vector<World> worlds;
    for (const Scale& scale : scales) worlds.emplace_back(scale, device, fade);
    struct Known {
        std::uint32_t generation = 0;
        Kind kind = 0;
        bool present = false;
    };
    std::array<Known, 16> known;
    Probe hand = at(0.1 * direction(rng));
    for (int i = 0; i < cycles; ++i) {
        const int changes = i == 0 ? 10 : between(rng, 0, 15) == 0;
        for (int c = 0; c < changes; ++c) {
            const auto slot = static_cast<std::uint32_t>(between(rng, 0, 15));
            Known& at = known[slot];
            if (at.present && between(rng, 0, 3) == 0) {
                for (World& world : worlds) ASSERT_TRUE(world.scene.remove({slot, at.generation}));
                at.present = false;
                continue;
            }
            const bool update = at.present;
            if (!update) {
                ++at.generation;
                at.kind = static_cast<Kind>(between(rng, 0, static_cast<int>(Representations::size) - 1));
            }
            at.present = true;
            const AddOptions options{.probe = static_cast<std::uint32_t>(between(rng, 0, 3) == 0),
                                     .on_silence = static_cast<OnSilence>(between(rng, 0, 2))};
            const Send send = some_change(Representations{}, rng, at.kind, update, scales);
            for (World& world : worlds)
                ASSERT_TRUE(send(world, {slot, at.generation}, options)) << "seed " << seed << " cycle " << i;
        }
        if (between(rng, 0, 100) == 0) {
            const double radius = between(rng, 0, 1) ? 0 : scale(rng, 1e-3, 1e-2);
            const Vector offset = 0.02 * direction(rng);
            for (World& world : worlds)
                ASSERT_TRUE(world.scene.place_probe(1, {.offset = to_plain(world.scale.metre * offset),
                                                        .radius = world.scale.metre * radius}));
        }
        if (between(rng, 0, 100) == 0) {
            const double seconds = between(rng, 0, 1) ? 0 : 0.2;
            for (World& world : worlds) world.scene.set_silence(seconds);
        }
        hand.velocity += 0.03 * (2 * direction(rng) - 4 * hand.position - hand.velocity);
        hand.position += dt * hand.velocity;
        hand.smooth_velocity += 0.1 * (hand.velocity - hand.smooth_velocity);
        hand.angular_velocity = direction(rng);
        hand.orientation =
            (hand.orientation * Eigen::Quaterniond(1, 1e-3 * hand.angular_velocity.x(), 0, 1e-3))
                .normalized();
        const double step = between(rng, 0, 20) ? dt : between(rng, 0, 1) ? 0 : 2 * dt;
        const Wrench want = worlds[0].evaluate(hand, step);
        touched += want.force != Vector::Zero();
        std::array<Feedback, 16> told, here;
        const std::size_t count = worlds[0].scene.feedback(told);
        for (World& world : worlds) {
            if (&world == &worlds[0]) continue;
            const Wrench got = world.evaluate(hand, step);
            const auto where = [&] {
                return testing::Message()
                       << "seed " << seed << " cycle " << i << ", a metre is " << world.scale.metre
                       << " and a newton " << world.scale.newton << ": " << got.force.transpose() << "; "
                       << got.torque.transpose() << " instead of " << want.force.transpose() << "; "
                       << want.torque.transpose();
            };
            ASSERT_TRUE(same_bits(got, want)) << where();
            ASSERT_EQ(world.scene.evaluated(), worlds[0].scene.evaluated()) << where();
            ASSERT_EQ(world.scene.feedback(here), count) << where();
            for (std::size_t f = 0; f < count; ++f) {
                ASSERT_EQ(here[f].flags, told[f].flags) << where();
                ASSERT_EQ(here[f].wrench.force, world.scale.newton * told[f].wrench.force) << where();
                ASSERT_EQ(here[f].contact_point, world.scale.metre * told[f].contact_point) << where();
                ASSERT_EQ(here[f].stiffness, world.scale.of("N/m") * told[f].stiffness) << where();
            }
        }
    }
}

}  // namespace

TEST(Scales, InAWorldOfAnySizeEveryKindFeelsTheSame) {
    const int seeds = long_form() ? 1000 : 20;
    std::uint64_t touched = 0;
    for (int i = 0; i < seeds && !testing::Test::HasFatalFailure(); ++i)
        compare(900 + static_cast<std::uint64_t>(i), 600, touched);
    std::printf("seeds 900 to %d, with a force in %llu of %d cycles\n", 899 + seeds,
                static_cast<unsigned long long>(touched), 600 * seeds);
    EXPECT_GT(touched, 100 * static_cast<std::uint64_t>(seeds));
}

}  // namespace scales_tests

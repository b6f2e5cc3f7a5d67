// Every kind of representation, through shared memory to a real servo and back.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "../reps/scene_tools.hpp"
#include "servo_process.hpp"

namespace {

using namespace knurl;
using namespace client_test;
using Vector = Eigen::Vector3d;

template <class... R>
void for_every_kind(TypeList<R...>, const auto& use) {
    (use.template operator()<R>(), ...);
}

template <class R>
bool same_bytes(const R& a, const R& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(Kinds, are_all_added_changed_felt_and_removed) {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    for_every_kind(Representations{}, [&]<class R>() {
        SCOPED_TRACE(std::string(Describe<R>::name));
        test::Rng rng(7);
        const R first = test::random_params<R>(rng, false), second = test::random_params<R>(rng, false);
        auto here = hand.add(first);
        EXPECT_TRUE(same_bytes(here.params(), first));
        here.set(second);
        EXPECT_TRUE(same_bytes(here.params(), second));
        ASSERT_TRUE(hand.wait_applied(hand.commit(), 10s));
        read_until(hand, [&](const HandReport&) { return here.feedback().has_value(); });
        EXPECT_TRUE(here.applied_stiffness().has_value());

        const auto& fields = Describe<R>::fields;
        const Field& field = *std::find_if(std::begin(fields), std::end(fields),
                                           [](const Field& one) { return one.reals() > 0; });
        R bad = second;
        test::set_real(&bad, field, std::numeric_limits<double>::quiet_NaN());
        try {
            here.set(bad);
            ADD_FAILURE() << field.name << " = nan was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind, Error::Kind::bad_parameters);
            const std::string name = std::string(Describe<R>::name) + "." + std::string(field.name);
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
        }
        here.remove();
        EXPECT_THROW(here.set(second), Error) << "removed";
    });
    EXPECT_EQ(hand.timing().refused, 0u);
    EXPECT_NO_THROW(hand.commit()) << "the servo refused nothing";
}

struct Held {
    ServoProcess servo;
    Client client = connect();
    Claim hand = client.claim();
    Vec3 at = hand.device().workspace_centre;  // where the simulated hand rests

    /// Waits until it is so, with force.
    template <class Wanted>
    HandFeedback until(const AnyHandle& what, Wanted wanted) {
        std::optional<HandFeedback> felt;
        read_until(hand, [&](const HandReport& report) {
            felt = what.feedback();
            return is_on(report) && felt && wanted(*felt);
        });
        return *felt;
    }
};

TEST(Kinds, of_surface_push_along_their_own_normal) {
    Held held;
    const Vec3& at = held.at;
    auto ball = held.hand.add(Sphere{
        .center = {at.x, at.y, at.z - 0.099}, .radius = 0.1 /* top 1 mm above the hand */, .stiffness = 200});
    held.hand.arm();
    const HandFeedback up = held.until(ball, [](const HandFeedback& felt) { return felt.force.z > 0.05; });
    EXPECT_LT(std::hypot(up.force.x, up.force.y), 0.1 * up.force.z);
    EXPECT_EQ(up.stiffness, 200);
    ball.remove();
    auto bowl = held.hand.add(
        Cap{.foot = {at.x + 0.002, at.y, at.z}, .normal = {-1, 0, 0}, .curvature = 5, .stiffness = 200});
    bowl.set({.foot = {at.x - 0.002, at.y, at.z}, .normal = {-1, 0, 0}, .curvature = 5, .stiffness = 200});
    const HandFeedback back = held.until(bowl, [](const HandFeedback& felt) { return felt.force.x < -0.05; });
    EXPECT_LT(std::hypot(back.force.y, back.force.z), -0.2 * back.force.x);
}

TEST(Kinds, that_rub_say_how_stiff_their_friction_is) {
    Held held;
    const double under = held.at.z + 0.001;
    auto plane = held.hand.add(Plane{.offset = under, .stiffness = 150});
    held.hand.arm();
    const auto touching = [](const HandFeedback& felt) { return (felt.flags & Feedback::touching) != 0; };
    EXPECT_EQ(held.until(plane, touching).tangential_stiffness, 0) << "smooth";
    plane.set({.offset = under, .stiffness = 150, .friction = {.dynamic = 0.5}});
    EXPECT_EQ(held.until(plane, [](const HandFeedback& felt) { return felt.tangential_stiffness > 0; })
                  .tangential_stiffness,
              150)
        << "N/m, as stiff as the surface";
    plane.set(
        {.offset = under, .stiffness = 150, .snag = {.k_kinetic = 0.2, .k_stick = 1e7, .d_snap = 1e-3}});
    EXPECT_EQ(held.until(plane, [](const HandFeedback& felt) { return felt.tangential_stiffness > 150; })
                  .tangential_stiffness,
              held.hand.limits().max_stiffness)
        << "a snag stiffer than the device allows";
}

TEST(Follow, sends_a_cap_that_curves_as_the_model_says) {
    Held held;
    auto bowl = held.hand.add(Cap{.foot = {0, 0, -1}, .rim = 0.2, .stiffness = 200});
    held.hand.arm();
    read_until(held.hand, is_on);
    const SurfaceModel model = [&](const Vec3& q) {
        return SurfacePoint{.foot = {q.x, q.y, held.at.z + 0.002},
                            .normal = {0, 0, 2},
                            .curvature = 6,
                            .curvature2 = -3,
                            .axis = {0, 1, 0}};
    };
    for (int i = 0; i < 5; ++i) {
        const Followed followed = bowl.follow(model);
        EXPECT_EQ(followed.faces.count, 1u);
        EXPECT_FALSE(followed.undersampled) << "a hand at rest";
        ASSERT_TRUE(held.hand.wait_applied(held.hand.commit(), 10s));
    }
    const Cap sent = bowl.params();
    EXPECT_EQ(sent.foot.z, held.at.z + 0.002);
    EXPECT_EQ(sent.normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(sent.curvature, 6);
    EXPECT_EQ(sent.curvature2, -3);
    EXPECT_EQ(sent.axis, (Vec3{0, 1, 0}));
    EXPECT_EQ(sent.rim, 0.2) << "the rest stays";
    EXPECT_EQ(sent.stiffness, 200);
    held.until(bowl, [](const HandFeedback& felt) { return felt.force.z > 0; });
}

TEST(Follow, sends_both_sides_of_a_corner_and_takes_them_back) {
    Held held;
    auto floor = held.hand.add(Plane{.offset = -1, .stiffness = 200});
    held.hand.arm();
    read_until(held.hand, is_on);
    double wall = 0.02;  // m, how far before the hand
    const SurfaceModel corner = [&](const Vec3& q) -> SurfacePoint {
        const double over = q.z - (held.at.z + 0.002), before = held.at.x + wall - q.x;
        if (before < over) return {.foot = {held.at.x + wall, q.y, q.z}, .normal = {-1, 0, 0}};
        return {.foot = {q.x, q.y, held.at.z + 0.002}, .normal = {0, 0, 1}};
    };
    const auto follow_until = [&](auto wanted) {
        Followed followed;
        const HandFeedback felt = held.until(floor, [&](const HandFeedback& now) {
            followed = floor.follow(corner);
            return wanted(now);
        });
        return std::pair(followed, felt);
    };
    EXPECT_EQ(follow_until([](const HandFeedback& felt) { return felt.force.z > 0.05; }).first.faces.count,
              1u);
    wall = -0.006;
    const auto [both, felt] =
        follow_until([](const HandFeedback& now) { return now.force.z > 0.05 && now.force.x < -0.05; });
    EXPECT_EQ(both.faces.count, 2u);
    EXPECT_NE(felt.flags & Feedback::touching, 0u);
    wall = 0.05;
    EXPECT_EQ(follow_until([](const HandFeedback& now) { return now.force.x == 0; }).first.faces.count, 1u)
        << "the wall has gone";
    wall = -0.006;
    follow_until([](const HandFeedback& now) { return now.force.x < -0.05; });
    floor.set({.offset = held.at.z + 0.002, .stiffness = 200});
    held.until(floor, [](const HandFeedback& now) { return now.force.x == 0 && now.force.z > 0; });
    follow_until([](const HandFeedback& now) { return now.force.x < -0.05; });
    floor.remove();
    read_until(held.hand, [](const HandReport& report) {
        return report.scene_force.x == 0 && report.scene_force.z == 0;
    });
    EXPECT_THROW(floor.follow(corner), Error);
}

TEST(Follow, counts_the_updates_that_come_too_seldom) {
    Held held;
    auto floor = held.hand.add(Plane{.offset = -1, .stiffness = 200});
    held.hand.arm();
    read_until(held.hand, is_on);
    // An inclined floor, which pushes the hand along, and a curvature too large for that speed.
    const auto inclined = [&](double curvature) -> SurfaceModel {
        const Vector n = Vector(0.6, 0, 0.8), through = to_eigen(held.at) + 0.003 * n;
        return [=](const Vec3& q) {
            const Vector p = to_eigen(q);
            return SurfacePoint{.foot = to_plain(Vector(p - n.dot(p - through) * n)),
                                .normal = to_plain(n),
                                .curvature = -curvature};
        };
    };
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(floor.follow(inclined(1e-9)).undersampled);
        ASSERT_TRUE(held.hand.wait_applied(held.hand.commit(), 10s));
    }
    EXPECT_EQ(held.hand.timing().undersampled, 0u);
    std::uint64_t told = 0;
    read_until(held.hand, [&](const HandReport&) {
        told += floor.follow(inclined(1e9)).undersampled ? 1 : 0;
        return told >= 3;
    });
    EXPECT_EQ(held.hand.timing().undersampled, told);
}

}  // namespace

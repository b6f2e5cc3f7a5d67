// What changes a claim, from connecting to the force felt.

#include <cmath>
#include <limits>
#include <random>

#include <knurl/reps/all.hpp>

#include "../reps/scene_tools.hpp"
#include "e2e_support.hpp"
#include "kinds_table.h"

namespace capi_test {
namespace {

TEST_F(CHand, is_described) {
    std::int32_t pid = 0;
    std::uint32_t connected = 0;
    ASSERT_TRUE(did(knurl_servo_pid(client, &pid)));
    EXPECT_EQ(pid, servo->pid());
    ASSERT_TRUE(did(knurl_connected(client, &connected)));
    EXPECT_EQ(connected, 1u);
    connected = 0;
    ASSERT_TRUE(did(knurl_connected(hand, &connected)));
    EXPECT_EQ(connected, 1u);
    knurl_device first = sized<knurl_device>();
    ASSERT_TRUE(did(knurl_device_at(client, 0, &first)));
    EXPECT_STREQ(first.name, "cartesian3");
    EXPECT_STREQ(first.address, "sim:cartesian3");
    EXPECT_EQ(first.rate, rate);
    EXPECT_GT(first.peak_force, 0);
    EXPECT_EQ(std::memcmp(&first, &device, sizeof first), 0) << "as knurl_device_of says";
    EXPECT_EQ(knurl_device_at(client, 1, &first), KNURL_NOTHING);
    knurl_limits limits = sized<knurl_limits>();
    ASSERT_TRUE(did(knurl_limits_of(hand, &limits)));
    EXPECT_EQ(limits.max_stiffness, device.max_stiffness);
    EXPECT_EQ(limits.max_force, device.peak_force);
    EXPECT_EQ(limits.metre, 1);
    EXPECT_EQ(limits.newton, 1);
    EXPECT_GT(limits.period, 0);
    std::uint64_t reattachments = 1;
    ASSERT_TRUE(did(knurl_reattachments(hand, &reattachments)));
    EXPECT_EQ(reattachments, 0u);
}

TEST_F(CHand, is_held_and_says_by_whom) {
    knurl_client* const other = connect();
    knurl_hand *second = nullptr, *observer = nullptr;
    EXPECT_TRUE(fails(KNURL_DEVICE_HELD, knurl_claim(other, nullptr, nullptr, &second)));
    EXPECT_EQ(knurl_holder(), servo->claimant());
    EXPECT_EQ(second, nullptr);
    EXPECT_TRUE(fails(KNURL_NO_SUCH_DEVICE, knurl_claim(other, "no\nsuch", nullptr, &second)));
    EXPECT_EQ(knurl_holder(), 0);
    EXPECT_TRUE(fails(KNURL_NO_SUCH_DEVICE, knurl_observe(other, "left", &second)));
    ASSERT_TRUE(did(knurl_observe(other, nullptr, &observer)));
    knurl_report report = sized<knurl_report>();
    EXPECT_TRUE(did(knurl_next_report(observer, 20 * s, &report)));
    // An observer changes nothing.
    knurl_plane floor = plane(0, 100);
    knurl_id id = 0;
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_add(observer, KNURL_PLANE, &floor, nullptr, &id), "observer"));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_arm(observer)));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_commit(observer, nullptr)));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_keep_alive(observer, 0)));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_forget(observer, 1)));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_set(observer, 1, KNURL_PLANE, &floor)));
    // Shared by two who both say so.
    claim(60 * s, 1);
    knurl_claim_options options;
    knurl_default_claim_options(&options);
    options.shared = 1;
    ASSERT_TRUE(did(knurl_claim(other, "cartesian3", &options, &second)));
    EXPECT_TRUE(did(knurl_close(other)));
}

template <class... R>
void for_every_kind(knurl::TypeList<R...>, const auto& use) {
    (use.template operator()<R>(), ...);
}

/// The parameters of the C++ client as the C struct of that kind, by the names of the fields.
template <class R>
std::vector<std::uint64_t> to_c(const R& params) {
    const knurl::Kind kind = knurl::kind_of<R>;
    std::vector<std::uint64_t> bytes(kind_rows[kind].size / 8);
    bytes[0] = kind_rows[kind].size;
    knurl_field row = sized<knurl_field>();
    for (std::uint32_t i = 0; knurl_field_at(kind, i, &row) == KNURL_OK; ++i)
        for (const knurl::Field& field : knurl::Describe<R>::fields)
            if (field.name == row.name)
                std::memcpy(reinterpret_cast<std::byte*>(bytes.data()) + row.offset,
                            reinterpret_cast<const std::byte*>(&params) + field.offset, field.bytes());
    return bytes;
}

TEST_F(CHand, every_kind_comes_back_as_it_was_set) {
    const std::uint64_t seed = std::random_device{}();
    SCOPED_TRACE("seed " + std::to_string(seed));
    knurl::test::Rng rng(seed);
    for_every_kind(knurl::Representations{}, [&]<class R>() {
        const std::uint32_t kind = knurl::kind_of<R>;
        SCOPED_TRACE(std::string(knurl::Describe<R>::name));
        const std::vector<std::uint64_t> first = to_c(knurl::test::random_params<R>(rng, true)),
                                         second = to_c(knurl::test::random_params<R>(rng, false));
        std::vector<std::uint64_t> back(first.size() + 2, 0xAAAAAAAAAAAAAAAA);
        knurl_id id = 0;
        ASSERT_TRUE(did(knurl_validate(kind, first.data())));
        const auto added = [&] {
            EXPECT_TRUE(did(knurl_add(hand, kind, first.data(), nullptr, &id)));
            EXPECT_NE(id, 0u);
            knurl_commit(hand, nullptr);
            EXPECT_TRUE(did(knurl_wait_applied(hand, 0, 20 * s)));
            back[0] = back.size() * 8;
            return knurl_get(hand, id, kind, back.data());
        };
        // An instrumented servo may have no time for it on a busy machine, or shed the claim: it is asked again.
        ASSERT_TRUE(eventually([&] {
            const int code = added();
            if (!instrumented_servo || code != KNURL_STALE) return did(code);
            knurl_arm(hand);
            return testing::AssertionFailure() << knurl_error(nullptr);
        }));
        // Into more room than there is of it.
        std::fill(back.begin(), back.end(), 0);
        back[0] = back.size() * 8;
        back.back() = 7;
        ASSERT_TRUE(did(knurl_get(hand, id, kind, back.data())));
        EXPECT_EQ(std::memcmp(&back[1], &first[1], (first.size() - 1) * 8), 0);
        EXPECT_EQ(back[0], back.size() * 8);
        EXPECT_EQ(back.back(), 7u);
        ASSERT_TRUE(did(knurl_set(hand, id, kind, second.data())));
        back.assign(second.size(), 0);
        back[0] = second.size() * 8;
        ASSERT_TRUE(did(knurl_get(hand, id, kind, back.data())));
        EXPECT_EQ(back, second);
        apply();
        // Of another kind.
        const std::uint32_t other = kind == KNURL_PLANE ? KNURL_SPRING : KNURL_PLANE;
        std::vector<std::uint64_t> others(kind_rows[other].size / 8);
        ASSERT_TRUE(did(knurl_default(other, others.data(), kind_rows[other].size)));
        EXPECT_TRUE(
            fails(KNURL_BAD_ARGUMENT, knurl_set(hand, id, other, others.data()), kind_rows[kind].name));
        EXPECT_TRUE(
            fails(KNURL_BAD_ARGUMENT, knurl_get(hand, id, other, others.data()), kind_rows[kind].name));
        ASSERT_TRUE(did(knurl_remove(hand, id)));
        EXPECT_TRUE(fails(KNURL_STALE, knurl_remove(hand, id)));
        EXPECT_TRUE(fails(KNURL_STALE, knurl_set(hand, id, kind, second.data())));
        EXPECT_TRUE(fails(KNURL_STALE, knurl_get(hand, id, kind, back.data())));
    });
    knurl_timing timing = sized<knurl_timing>();
    ASSERT_TRUE(did(knurl_timing_of(hand, &timing)));
    EXPECT_EQ(timing.refused, 0u);
}

TEST_F(CHand, each_wrapper_of_the_header_is_a_call) {
    for (std::size_t i = 0; i < kind_row_count; ++i) {
        knurl_id id = 0;
        EXPECT_TRUE(did(kind_rows[i].use(hand, &id))) << kind_rows[i].name;
        EXPECT_NE(id, 0u);
    }
    apply();
}

TEST_F(CHand, bad_parameters_change_nothing) {
    const knurl_id floor = add(KNURL_PLANE, plane(-0.5, 300));
    knurl_plane bad = plane(-0.25, -1);
    EXPECT_TRUE(
        fails(KNURL_BAD_PARAMETERS, knurl_set(hand, floor, KNURL_PLANE, &bad), "plane.stiffness = -1 N/m"));
    EXPECT_NE(std::string(knurl_error(hand)), "");
    knurl_id id = 7;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_add(hand, KNURL_PLANE, &bad, nullptr, &id)));
    EXPECT_EQ(id, 7u);
    knurl_plane now = sized<knurl_plane>();
    ASSERT_TRUE(did(knurl_get_plane(hand, floor, &now)));
    EXPECT_EQ(now.offset, -0.5);
    knurl_add_options options;
    knurl_default_add_options(&options);
    options.probe = 16;
    bad = plane(0, 1);
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_add(hand, KNURL_PLANE, &bad, &options, &id), "16"));
    options.probe = 0;
    options.on_silence = 3;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_add(hand, KNURL_PLANE, &bad, &options, &id)));
    options.on_silence = KNURL_SILENCE_MOVE;
    options.silence_time = -1;
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_add(hand, KNURL_PLANE, &bad, &options, &id)));
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_place_probe(hand, 16, nullptr, 0)));
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_place_probe(hand, 0, nullptr, -1)));
    EXPECT_TRUE(did(knurl_place_probe(hand, 1, nullptr, 0.001)));
    apply();
}

TEST_F(CHand, a_group_takes_effect_in_one_cycle_or_not_at_all) {
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_end_group(hand), "begin_group"));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_cancel_group(hand), "begin_group"));
    knurl_hand* watch = nullptr;
    ASSERT_TRUE(did(knurl_observe(client, nullptr, &watch)));
    ASSERT_TRUE(did(knurl_begin_group(hand)));
    add(KNURL_CONSTANT_FORCE, at_once(0.1, 0, 0));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_commit(hand, nullptr)));
    ASSERT_TRUE(did(knurl_begin_group(hand)));  // within the other
    add(KNURL_CONSTANT_FORCE, at_once(0, 0.1, 0));
    ASSERT_TRUE(did(knurl_end_group(hand)));
    ASSERT_TRUE(did(knurl_begin_group(hand)));
    const knurl_id forgotten = add(KNURL_CONSTANT_FORCE, at_once(9, 9, 9));
    ASSERT_TRUE(did(knurl_cancel_group(hand)));
    EXPECT_TRUE(fails(KNURL_STALE, knurl_remove(hand, forgotten)));
    ASSERT_TRUE(did(knurl_arm(hand)));
    add(KNURL_CONSTANT_FORCE, at_once(0, 0, 0.1));
    ASSERT_TRUE(did(knurl_end_group(hand)));
    feel(0.1);
    std::vector<knurl_report> some(64, sized<knurl_report>());
    std::size_t count = 1;
    while (count > 0) {
        const int code = knurl_reports(watch, some.data(), some.size(), &count);
        ASSERT_GE(code, 0);
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(some[i].scene_force.x, some[i].scene_force.y) << "cycle " << some[i].cycle;
            ASSERT_EQ(some[i].scene_force.x, some[i].scene_force.z) << "cycle " << some[i].cycle;
            ASSERT_LE(some[i].scene_force.x, 0.1);
        }
    }
    // A group that the servo refuses leaves what it would have removed.
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.1, 0, 0));
    ASSERT_TRUE(did(knurl_begin_group(hand)));
    ASSERT_TRUE(did(knurl_remove(hand, push)));
    ASSERT_TRUE(did(knurl_reset_fault(hand)));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_end_group(hand)));
    knurl_constant_force more = at_once(0.2, 0, 0);
    EXPECT_TRUE(did(knurl_set(hand, push, KNURL_CONSTANT_FORCE, &more)));
    feel(0.3);
}

TEST_F(CHand, is_armed_disarmed_and_reset) {
    add(KNURL_CONSTANT_FORCE, at_once(0.2, 0, 0));
    ASSERT_TRUE(did(knurl_arm(hand)));
    feel(0.2);
    ASSERT_TRUE(did(knurl_disarm(hand)));
    read_until(hand, [](const knurl_report& report) {
        return report.state == KNURL_STATE_IDLE && report.sent_force.x == 0;
    });
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_reset_fault(hand), "fault"));
    EXPECT_TRUE(fails(KNURL_REFUSED, knurl_reset_fault_of(client, nullptr)));
    EXPECT_TRUE(fails(KNURL_NO_SUCH_DEVICE, knurl_reset_fault_of(client, "no such")));
}

TEST_F(CHand, force_and_stiffness_come_back) {
    const knurl_id floor =
        add(KNURL_PLANE, plane(device.workspace_centre.z + 0.001, std::numeric_limits<double>::infinity()));
    ASSERT_TRUE(did(knurl_arm(hand)));
    knurl_feedback felt = sized<knurl_feedback>();
    read_until(hand, [&](const knurl_report& report) {
        return is_on(report) && knurl_feedback_of(hand, floor, &felt) == KNURL_OK && felt.force.z > 0;
    });
    EXPECT_EQ(felt.force.x, 0);
    EXPECT_NE(felt.flags & KNURL_FEEDBACK_TOUCHING, 0u);
    EXPECT_NE(felt.flags & KNURL_FEEDBACK_STIFFNESS_CLAMPED, 0u);
    EXPECT_EQ(felt.stiffness, device.max_stiffness);
    EXPECT_GT(felt.cycle, 0u);
    double stiffness = 0;
    ASSERT_TRUE(did(knurl_applied_stiffness(hand, floor, &stiffness)));
    EXPECT_EQ(stiffness, device.max_stiffness);
    knurl_timing timing = sized<knurl_timing>();
    ASSERT_TRUE(did(knurl_timing_of(hand, &timing)));
    EXPECT_EQ(timing.refused, 0u);
    EXPECT_GT(timing.interval_ns, 0);
    knurl_vec3 ahead{};
    ASSERT_TRUE(did(knurl_predicted_position(hand, &ahead)));
    EXPECT_NEAR(ahead.z, device.workspace_centre.z, 0.05);
}

TEST_F(CHand, batches_are_numbered_and_waited_for) {
    const knurl_id push = add(KNURL_CONSTANT_FORCE, at_once(0.1, 0, 0));
    std::uint64_t first = 0, second = 0;
    ASSERT_TRUE(did(knurl_commit(hand, &first)));
    const knurl_constant_force more = at_once(0.2, 0, 0);
    ASSERT_TRUE(did(knurl_set(hand, push, KNURL_CONSTANT_FORCE, &more)));
    ASSERT_TRUE(did(knurl_commit(hand, &second)));
    EXPECT_EQ(second, first + 1);
    EXPECT_TRUE(did(knurl_wait_applied(hand, second, KNURL_FOREVER)));
    EXPECT_TRUE(did(knurl_wait_applied(hand, 0, 0)));
    EXPECT_EQ(knurl_wait_applied(hand, second + 1, 5 * ms), KNURL_NOTHING);
    EXPECT_EQ(knurl_wait_applied(hand, second + 1, -1), KNURL_NOTHING);
}

/// A plane at `height`, of which the last question is kept.
struct Floor {
    double height;
    int calls = 0, fails_with = 0;
    static int nearest(void* user, const knurl_vec3* near, knurl_surface_point* out) {
        Floor& floor = *static_cast<Floor*>(user);
        ++floor.calls;
        EXPECT_EQ(out->curvature, 0) << "it comes as zeros";
        out->foot = {near->x, near->y, floor.height};
        out->normal = {0, 0, 2};
        return floor.fails_with;
    }
};

TEST_F(CHand, follows_a_model_and_says_when_the_model_fails) {
    const knurl_id face = add(KNURL_PLANE, plane(-1, 500)), spring = add(KNURL_SPRING, [] {
                                                                knurl_spring params;
                                                                knurl_default_spring(&params);
                                                                return params;
                                                            }());
    ASSERT_TRUE(did(knurl_arm(hand)));
    read_until(hand, is_on);
    Floor floor{.height = device.workspace_centre.z + 0.002};
    knurl_followed followed = sized<knurl_followed>();
    for (const double step : {0.0, 0.001}) {
        ASSERT_TRUE(did(knurl_follow(hand, face, Floor::nearest, &floor, step, &followed)));
        EXPECT_EQ(followed.faces, 1u);
        EXPECT_GT(followed.asked, 0u);
        EXPECT_LE(followed.asked, static_cast<std::uint32_t>(floor.calls));
        EXPECT_EQ(followed.undersampled, 0u);
        apply();
    }
    ASSERT_TRUE(did(knurl_follow(hand, face, Floor::nearest, &floor, 0, nullptr)));
    knurl_plane now = sized<knurl_plane>();
    ASSERT_TRUE(did(knurl_get_plane(hand, face, &now)));
    EXPECT_NEAR(now.offset, floor.height, 1e-12);
    EXPECT_EQ(now.normal.z, 1);
    EXPECT_EQ(now.stiffness, 500);

    floor.height = 0.25;
    floor.fails_with = -42;
    EXPECT_TRUE(
        fails(KNURL_CALLBACK_FAILED, knurl_follow(hand, face, Floor::nearest, &floor, 0, &followed), "-42"));
    ASSERT_TRUE(did(knurl_get_plane(hand, face, &now)));
    EXPECT_NE(now.offset, 0.25) << "nothing was set";
    floor.fails_with = 0;
    EXPECT_TRUE(fails(KNURL_CALLBACK_FAILED,
                      knurl_follow(
                          hand, face, [](void*, const knurl_vec3*, knurl_surface_point*) { return 0; },
                          nullptr, 0, nullptr),
                      "without a normal"));
    EXPECT_TRUE(fails(KNURL_BAD_PARAMETERS, knurl_follow(hand, spring, Floor::nearest, &floor, 0, &followed),
                      "spring"));
    EXPECT_TRUE(fails(KNURL_BAD_ARGUMENT, knurl_follow(hand, face, nullptr, &floor, 0, &followed)));
    for (const double step : {-1.0, std::nan(""), HUGE_VAL})
        EXPECT_TRUE(
            fails(KNURL_BAD_PARAMETERS, knurl_follow(hand, face, Floor::nearest, &floor, step, &followed)));
    const auto nowhere = [](void*, const knurl_vec3*, knurl_surface_point*) {
        return 0;
    };  // a normal of no length
    EXPECT_LT(knurl_follow(hand, face, nowhere, nullptr, 0, &followed), 0);
    EXPECT_TRUE(one_line(knurl_error(hand)));
    apply();
}

TEST_F(CHand, from_within_a_callback_the_hand_may_be_used) {
    const knurl_id face = add(KNURL_PLANE, plane(-1, 500));
    read_until(hand, [](const knurl_report&) { return true; });
    struct Both {
        knurl_hand* hand;
        int code = -1;
    } both{.hand = hand};
    const auto model = [](void* user, const knurl_vec3* near, knurl_surface_point* out) {
        Both& it = *static_cast<Both*>(user);
        knurl_vec3 ahead;
        it.code = knurl_predicted_position(it.hand, &ahead);
        out->foot = {near->x, near->y, -0.5};
        out->normal = {0, 0, 1};
        return 0;
    };
    ASSERT_TRUE(did(knurl_follow(hand, face, model, &both, 0, nullptr)));
    EXPECT_EQ(both.code, KNURL_OK);
}

TEST_F(CHand, all_places_taken_is_an_error_and_one_free_is_a_place) {
    ASSERT_TRUE(did(knurl_close(hand)));
    hand = nullptr;
    knurl_claim_options options;
    knurl_default_claim_options(&options);
    options.representations = 2;
    ASSERT_TRUE(
        eventually([&] { return knurl_claim(client, nullptr, &options, &hand) != KNURL_DEVICE_HELD; }));
    const knurl_id a = add(KNURL_PLANE, plane(-1, 1));
    add(KNURL_PLANE, plane(-1, 1));
    const knurl_plane one = plane(-1, 1);
    knurl_id id = 0;
    EXPECT_LT(knurl_add(hand, KNURL_PLANE, &one, nullptr, &id), 0);
    EXPECT_TRUE(one_line(knurl_error(hand)));
    ASSERT_TRUE(did(knurl_remove(hand, a)));
    EXPECT_TRUE(eventually([&] {
        knurl_commit(hand, nullptr);
        return knurl_add(hand, KNURL_PLANE, &one, nullptr, &id) == KNURL_OK;
    }));
    options.representations = 4096;
    knurl_hand* other = nullptr;
    EXPECT_LT(knurl_claim(client, nullptr, &options, &other), 0);
    EXPECT_TRUE(one_line(knurl_error(client)));
}

}  // namespace
}  // namespace capi_test

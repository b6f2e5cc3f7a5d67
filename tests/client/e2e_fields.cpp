// A height field from an application's memory to the hand, and the refusals on the way.

#include <cmath>
#include <vector>

#include <knurl/geometry/height_field.hpp>
#include <knurl/geometry/proxy.hpp>

#include "sent_shapes.hpp"

namespace {

using namespace client_test;
using knurl::Feedback;
using knurl::HandReport;
using knurl::HeightGrid;
using knurl::Heights;
using knurl::SentShape;
using knurl::Vec3;

/// 8 by 6 cm of hills of 2 mm, centred at x = y = 0; the hand rests over or under them.
template <class Real>
struct Hills {
    HeightGrid grid{.columns = 81, .rows = 61, .dx = 1e-3, .dy = 1e-3, .corner = {-0.04, -0.03, 0}};
    std::vector<Real> z;
    explicit Hills(double rise = 0, double high = 1e-3) {
        for (std::uint32_t j = 0; j < grid.rows; ++j)
            for (std::uint32_t i = 0; i < grid.columns; ++i)
                z.push_back(static_cast<Real>(rise + high * std::sin(0.2 * i) * std::cos(0.25 * j + 1)));
    }
    Heights heights() const { return {.grid = grid, .heights = z}; }
};

struct SentField : Sent {
    /// Sets it and waits. Returns the first cycle with it in force; older reports may still be unread.
    std::uint64_t set_now(auto& shape, const knurl::Shape& params) {
        shape.set(params);
        EXPECT_TRUE(hand->wait_applied(hand->commit(), 10s));
        return shape.feedback()->cycle;
    }
    /// The point 1 mm above the asset's origin at its middle comes to lie `deep` m above the hand.
    knurl::Shape under_the_hand(std::uint32_t asset, double deep) const {
        return {
            .asset = asset, .position = {at.x, at.y, at.z - 0.001 + deep}, .stiffness = 200, .recovery = 0};
    }
};

TEST_F(SentField, it_is_felt_as_in_process) {
    const Hills<float> hills;
    const SentShape sent = hand->send(hills.heights());
    EXPECT_EQ(sent.faces, 2u * 80 * 60);
    EXPECT_LE(static_cast<double>(sent.bytes), 2.1 * static_cast<double>(sent.faces) + 1024);
    EXPECT_NEAR(sent.low.x, -0.04, 1e-12);
    EXPECT_LE(sent.high.z, 1.001e-3);

    auto shape = hand->add(under_the_hand(sent.asset, -0.005));
    hand->arm();
    read_until(*hand, is_active);
    const knurl::Shape pressed = under_the_hand(sent.asset, 0.002);
    const std::uint64_t from = set_now(shape, pressed);

    const knurl::HeightField here(hills.z, hills.grid);
    knurl::Proxy proxy;
    int compared = 0;
    double greatest = 0, sideways = 0;
    const auto in_asset = [&](const Vec3& p) {
        return Eigen::Vector3d(p.x - pressed.position.x, p.y - pressed.position.y, p.z - pressed.position.z);
    };
    read_until(*hand, [&](const HandReport& report) {
        if (report.cycle < from) return false;
        const Eigen::Vector3d place = in_asset(report.position);
        knurl::Foot foot;
        knurl::Work work;
        if (proxy.phase == knurl::Proxy::Phase::fresh)  // the hand came from above
            knurl::follow(here, proxy, {place.x(), place.y(), 0.005}, 0, foot, work);
        const bool touches = knurl::follow(here, proxy, place, 0, foot, work);
        const Eigen::Vector3d wanted =
            touches ? Eigen::Vector3d(200 * foot.depth * foot.normal) : Eigen::Vector3d(0, 0, 0);
        const Eigen::Vector3d felt = knurl::to_eigen(report.scene_force);
        EXPECT_LT((felt - wanted).norm(), 1e-9)
            << "cycle " << report.cycle << ", " << felt.transpose() << " instead of " << wanted.transpose();
        greatest = std::max(greatest, felt.z());
        sideways = std::max(sideways, felt.head<2>().norm());
        return ++compared == 300 || HasFailure();
    });
    EXPECT_GT(greatest, 0.05) << "N: it was pressed";
    EXPECT_GT(sideways, 1e-3) << "N: on a slope";
}

TEST_F(SentField, heights_in_double_keep_their_digits_far_above_sea_level) {
    // As floats they would be rounded to 0.24 mm there, a quarter of the hills.
    const Hills<double> low(0), high(4000);
    const SentShape a = hand->send(low.heights()), b = hand->send(high.heights());
    EXPECT_NEAR(b.low.z - a.low.z, 4000, 1e-8);
    EXPECT_NEAR(b.high.z - a.high.z, 4000, 1e-8);
}

TEST_F(SentField, its_material_is_felt) {
    const Hills<float> hills(0, 0);
    Heights soft = hills.heights();
    soft.material = {.stiffness = 0.5};
    const SentShape whole = hand->send(hills.heights()), half = hand->send(soft);
    knurl::Shape params = under_the_hand(whole.asset, -0.005);
    auto shape = hand->add(params);
    hand->arm();
    read_until(*hand, is_active);
    params.position.z = at.z + 0.002;
    const auto force_over_depth = [&](std::uint32_t asset) {
        params.asset = asset;
        const std::uint64_t from = set_now(shape, params);
        const HandReport report =
            read_until(*hand, [&](const HandReport& r) { return r.cycle >= from && r.scene_force.z > 0.02; });
        return report.scene_force.z / (params.position.z - report.position.z);
    };
    EXPECT_NEAR(force_over_depth(whole.asset), 200, 1e-6);
    EXPECT_NEAR(force_over_depth(half.asset), 100, 1e-6);
}

TEST_F(SentField, it_replaces_a_mesh_under_the_hand_and_a_mesh_replaces_it) {
    const knurl::test::MadeMesh flat = knurl::test::grid(40, 30, 2e-3, 2e-3);
    const Hills<float> hills(0, 0);
    const std::uint32_t mesh = hand->send(triangles_of(flat)).asset,
                        field = hand->send(hills.heights()).asset;
    knurl::Shape params = under_the_hand(mesh, -0.005);
    params.stiffness = 200;
    auto shape = hand->add(params);
    hand->arm();
    read_until(*hand, is_active);
    params.position.z = at.z + 0.002;
    shape.set(params);
    hand->commit();
    read_until(*hand, [&](const HandReport& r) { return r.scene_force.z > 0.1; });
    for (const std::uint32_t next : {field, mesh, field}) {
        params.asset = next;
        shape.set(params);
        hand->commit();
        // Both are the same plane: the difference shows in no cycle.
        int cycles = 0;
        read_until(*hand, [&](const HandReport& r) {
            EXPECT_NEAR(r.scene_force.z, 200 * (params.position.z - r.position.z), 1e-6)
                << "to asset " << next << ", cycle " << r.cycle;
            return ++cycles == 50 || HasFailure();
        });
    }
    hand->forget(mesh);
}

TEST_F(SentField, a_restarted_servo_gets_it_again) {
    const Hills<float> hills(0, 0);
    const SentShape sent = hand->send(hills.heights());
    auto shape = hand->add(under_the_hand(sent.asset, -0.2));
    hand->commit();
    servo->end(SIGKILL);
    servo->start();
    ASSERT_TRUE(eventually([&] { return hand->reattachments() == 1 && hand->connected(); }));
    hand->arm();
    press(shape, under_the_hand(sent.asset, 0), 0, 0.001);
    EXPECT_GT(until_touched(shape).force.z, 0);
}

TEST_F(SentField, what_is_none_is_refused_in_one_line_and_nothing_is_lost) {
    Hills<float> bad;
    const auto why = [&](const Heights& heights) {
        const std::string text = answer_to([&] { hand->send(heights); });
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text;
    };
    EXPECT_NE(why({}).find("0 by 0"), std::string::npos);
    EXPECT_NE(why({.grid = bad.grid, .heights = std::span(bad.z).first(100)}).find("with 100 heights"),
              std::string::npos);
    Heights squeezed = bad.heights();
    squeezed.grid.dx = 0;
    EXPECT_NE(why(squeezed).find("1e-9 m or more"), std::string::npos);
    Heights lost = bad.heights();
    lost.grid.corner.y() = NAN;
    EXPECT_NE(why(lost).find("corner"), std::string::npos);
    Heights steel = bad.heights();
    steel.material.stiffness = 2;
    EXPECT_NE(why(steel).find("stiffness = 2"), std::string::npos);
    bad.z[3 * 81 + 17] = NAN;
    EXPECT_NE(why(bad.heights()).find("column 17, row 3"), std::string::npos);
    Hills<double> far;
    far.z[2 * 81 + 5] = -1e300;
    EXPECT_NE(why(far.heights()).find("column 5, row 2"), std::string::npos);
    const std::vector<float> row(1000, 0.0f);
    EXPECT_NE(why({.grid = {.columns = 1000, .rows = 1, .dx = 1, .dy = 1}, .heights = row}).find("1000 by 1"),
              std::string::npos);

    auto sending = hand->begin_sending(Hills<float>().heights());
    std::optional<SentShape> sent;
    ASSERT_TRUE(eventually([&] {
        hand->commit();
        sent = sending.done();
        return sent.has_value();
    }));
    EXPECT_EQ(sent->asset, 1u) << "the refused ones took no number";
}

TEST_F(SentField, its_number_is_given_back_and_a_mesh_may_have_it) {
    const SentShape sent = hand->send(Hills<double>().heights());
    hand->forget(sent.asset);
    std::optional<SentShape> again;
    ASSERT_TRUE(eventually([&] {
        hand->commit();
        const std::string why =
            answer_to([&] { again = hand->send(triangles_of(knurl::test::icosphere(1, 0.1))); });
        EXPECT_TRUE(again || why.find("taken") != std::string::npos) << why;
        return again.has_value();
    }));
    EXPECT_EQ(again->asset, sent.asset);
    EXPECT_EQ(again->faces, 80u);
}

}  // namespace

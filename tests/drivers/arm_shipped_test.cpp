// The arms that are shipped: against closed forms and published poses, each figure with its source.

#include <cmath>
#include <random>

#include <knurl/drivers/reach.hpp>

#include "arm_example.hpp"

namespace knurl::drivers {
namespace {

using namespace arms;
using Eigen::Vector3d;

JointArray random_joints(std::mt19937_64& engine, const JointArray& centre, double away = 1) {
    std::uniform_real_distribution<double> one(-away, away);
    JointArray q = centre;
    for (double& joint : q) joint += one(engine);
    return q;
}

TEST(ShippedArms, ReadAndHaveTheirNamesAndASourceForEachFigure) {
    EXPECT_EQ(shipped_arms(), (std::vector<std::string>{"generic6", "generic7", "omni", "premium15",
                                                        "premium15_wrist", "woodenhaptics"}));
    for (const std::string& name : shipped_arms()) {
        const ArmFile arm = find_arm(name);
        EXPECT_EQ(arm.name, name);
        EXPECT_FALSE(arm.description.empty());
        EXPECT_GT(arm.figures.size(), arm.joints()) << name;
        for (const ArmFigure& figure : arm.figures) {
            EXPECT_FALSE(figure.source.empty()) << name << ": " << figure.name;
            if (!name.starts_with("generic")) {
                EXPECT_EQ(figure.source.find("invented"), std::string::npos) << name << ": " << figure.name;
            }
        }
        EXPECT_LT(tip(arm, arm.centre).norm(), 1e-15) << "the origin is the workspace's centre";
    }
}

TEST(ShippedArms, ForwardOfTheInverseIsThePlaceThatWasAskedFor) {
    constexpr unsigned seed = 20261122;
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> one(0, 1);
    for (const std::string& name : shipped_arms()) {
        const ArmFile arm = find_arm(name);
        const SerialChain mechanism(arm.table);
        const auto forward = [&](const JointArray& q) {
            TipPose pose;
            Jacobian jacobian;
            EXPECT_TRUE(mechanism.forward({q.data(), arm.joints()}, pose, jacobian));
            return pose;
        };
        for (int trial = 0; trial < 1000; ++trial) {  // anywhere in the workspace, from its centre
            const Vector3d direction = Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
            const Vector3d place = arm.workspace_radius * std::cbrt(one(engine)) * direction;
            const auto q = reach(mechanism, arm.centre, place);
            ASSERT_TRUE(q) << name << " does not reach " << place.transpose();
            EXPECT_LT((forward(*q).position - place).norm(), 1e-9) << name;
        }
        for (int trial = 0; trial < 1000 && arm.joints() >= 6; ++trial) {
            const TipPose wanted = forward(random_joints(engine, arm.centre, 0.5));
            const auto q = reach(mechanism, arm.centre, wanted.position, wanted.orientation);
            ASSERT_TRUE(q) << name << " does not reach " << wanted.position.transpose();
            EXPECT_LT((forward(*q).position - wanted.position).norm(), 1e-9) << name;
            EXPECT_LT(forward(*q).orientation.angularDistance(wanted.orientation), 1e-6) << name;
        }
    }
}

TEST(ShippedArms, PremiumsHaveThePhantomsClosedForm) {
    // Cavusoglu et al. 2002, with x away from the base and z up.
    const auto closed = [](const JointArray& q) {
        const double out = 0.215 * std::cos(q[1]) + 0.170 * std::sin(q[2]);
        return Vector3d(std::cos(q[0]) * out, std::sin(q[0]) * out,
                        0.215 * std::sin(q[1]) - 0.170 * std::cos(q[2]));
    };
    std::mt19937_64 engine(1);
    for (const char* name : {"premium15", "premium15_wrist"}) {
        const ArmFile arm = find_arm(name);
        for (int trial = 0; trial < 300; ++trial) {
            const JointArray q = random_joints(engine, arm.centre);
            EXPECT_LT((tip(arm, q) - (closed(q) - closed(arm.centre))).norm(), 1e-15) << name;
        }
        EXPECT_EQ(link_of(arm).peak_force, 8.5);
        EXPECT_EQ(link_of(arm).continuous_force, 1.4);
    }
    const LinkConfig wrist = link_of(find_arm("premium15_wrist"));
    EXPECT_EQ(wrist.sensed_joints, 6);
    EXPECT_EQ(wrist.actuated_joints, 3);
    EXPECT_TRUE(wrist.senses_orientation);
    EXPECT_FALSE(wrist.renders_torque);
    const LinkConfig bare = link_of(find_arm("premium15"));
    EXPECT_EQ(bare.sensed_joints, 3);
    EXPECT_FALSE(bare.senses_orientation);
}

TEST(ShippedArms, OmniIsThePublishedUrdf) {
    // Its joints one after another: origin (xyz, rpy about x alone), then the turn about the axis.
    struct Urdf {
        Vector3d wrist, stylus;  // where wrist2 turns; the pen's direction
    };
    const auto urdf = [](const JointArray& q) -> Urdf {
        Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
        const auto joint = [&](const Vector3d& xyz, double about_x, const Vector3d& axis, double angle) {
            t.translate(xyz).rotate(Eigen::AngleAxisd(about_x, Vector3d::UnitX()));
            t.rotate(Eigen::AngleAxisd(angle, axis));
        };
        const double shoulder = q[1] - 0.23, elbow = q[2] - q[1] + 2.15 - std::numbers::pi / 2;
        joint({0, 0, 0.09}, 0, Vector3d::UnitZ(), q[0]);
        joint({-0.0075, 0, 0.035}, 0.23, Vector3d::UnitX(), shoulder);
        joint({0.0075, 0.134, 0}, -2.15, Vector3d::UnitX(), elbow);
        joint({0, 0.08, 0}, 0, Vector3d::UnitY(), q[3]);
        joint({0, 0.0525, 0}, -0.85, Vector3d::UnitX(), q[4] + 0.85);
        return {t.translation(), t.linear() * Vector3d::UnitY()};
    };
    // The URDF's y points away from the base; the file's x does.
    const Eigen::Matrix3d turned =
        Eigen::AngleAxisd(-std::numbers::pi / 2, Vector3d::UnitZ()).toRotationMatrix();
    const ArmFile omni = find_arm("omni");
    std::mt19937_64 engine(2);
    for (int trial = 0; trial < 300; ++trial) {
        const JointArray q = random_joints(engine, omni.centre);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(SerialChain(omni.table).forward(q, pose, jacobian));
        EXPECT_LT((pose.position - turned * (urdf(q).wrist - urdf(omni.centre).wrist)).norm(), 1e-15);
        EXPECT_LT((pose.orientation * Vector3d::UnitZ() - turned * urdf(q).stylus).norm(), 1e-15);
    }
    // Counts of the protocol at the links of the URDF are the data sheet's 450 dpi.
    EXPECT_NEAR(link_of(omni).radians_per_count[1] * 0.134, 25.4e-3 / 450, 0.5e-6);
    EXPECT_NEAR(omni.axes[1].limits.least, 0.23 - 0.24, 1e-12);
    EXPECT_NEAR(omni.axes[4].limits.least, -2.07 - 0.85, 1e-12);
    EXPECT_NEAR(omni.axes[4].limits.greatest, 0.23 - 0.85, 1e-12);
    EXPECT_NEAR(omni.row_limits[2].least, -0.2 - 2.15 + std::numbers::pi / 2, 1e-3);
    EXPECT_NEAR(omni.row_limits[2].greatest, 1.95 - 2.15 + std::numbers::pi / 2, 1e-3);
}

TEST(ShippedArms, WoodenHapticsHasItsClosedForm) {
    const auto closed = [](const JointArray& q) {
        const double out = 0.205 * std::sin(q[1]) + 0.245 * std::sin(q[2]);
        return Vector3d(std::cos(q[0]) * out, std::sin(q[0]) * out,
                        0.080 + 0.205 * std::cos(q[1]) - 0.245 * std::cos(q[2]));
    };
    const ArmFile arm = find_arm("woodenhaptics");
    EXPECT_LT((closed(arm.centre) - Vector3d(0.220, 0, 0.080)).norm(), 1e-4)
        << "the centre that its code states";
    std::mt19937_64 engine(3);
    for (int trial = 0; trial < 300; ++trial) {
        const JointArray q = random_joints(engine, arm.centre);
        EXPECT_LT((tip(arm, q) - (closed(q) - closed(arm.centre))).norm(), 1e-15);
    }
    const LinkConfig link = link_of(arm);
    EXPECT_NEAR(link.radians_per_count[0], 2 * std::numbers::pi / 2000 / (0.160 / 0.010), 1e-18);
    EXPECT_NEAR(link.effort_limit[1], 0.0259 * 3 * (0.120 / 0.010), 1e-12);
    EXPECT_NEAR(*arm.axes[2].effort_per_count, 0.0259 * 1e-3 * 12, 1e-15);
    EXPECT_TRUE(link.has_watchdog);
}

}  // namespace
}  // namespace knurl::drivers

// Singular postures and joint limits: the force on a hand that moves through them. Efforts are J^T F, never
// with an inverse, and scaled down together where one motor is at its limit, as in the servo's last stage.

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include <knurl/drivers/arm_file.hpp>
#include <knurl/drivers/conditioning.hpp>
#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/sim_device.hpp>

namespace knurl::drivers {
namespace {

using Eigen::Vector3d;
using Efforts = Eigen::Matrix<double, 8, 1>;

Efforts scaled(Efforts efforts, const LinkConfig& link) {
    double scale = 1;
    for (Eigen::Index i = 0; i < 8; ++i) {
        if (i >= link.actuated_joints) {
            efforts[i] = 0;
        } else if (const double limit = link.effort_limit[static_cast<std::size_t>(i)];
                   std::abs(efforts[i]) * scale > limit) {
            scale = limit / std::abs(efforts[i]);
        }
    }
    return scale * efforts;
}

struct Random {
    std::mt19937_64 engine;
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    Vector3d direction() {
        for (;;) {
            const Vector3d v = Vector3d::NullaryExpr([&] { return (*this)(-1, 1); });
            if (v.norm() < 1 && v.norm() > 0.1) return v.normalized();
        }
    }
};

/// A posture with the arm stretched, or the wrist, or both: as near to singular as a search finds.
JointArray most_singular(const SimProfile& profile, Random& random) {
    JointArray best = profile.centre;
    double least = 2;
    const auto look = [&](const JointArray& q) {
        TipPose pose;
        Jacobian jacobian;
        if (!profile.mechanism->forward({q.data(), static_cast<std::size_t>(profile.joints)}, pose, jacobian))
            return;
        const double here = conditioning(jacobian, profile.joints);
        if (here < least) {
            least = here;
            best = q;
        }
    };
    for (int i = 0; i < 300; ++i) {
        JointArray q = profile.centre;
        for (double& joint : q) joint += random(-1.5, 1.5);
        look(q);
    }
    for (double size = 0.3; size > 1e-9; size *= 0.9) {
        for (int i = 0; i < 12; ++i) {
            JointArray q = best;
            for (double& joint : q) joint += size * random(-1, 1);
            look(q);
        }
    }
    return best;
}

class Singular : public testing::TestWithParam<std::string> {};

TEST_P(Singular, EffortsOnAPathThroughTheWorstPostureNeverJumpAndAreBounded) {
    constexpr std::uint64_t seed = 31;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    const SimDevice device(sim_profile(GetParam()));
    const SimProfile& profile = device.profile();
    const LinkConfig& link = device.link();
    const auto joints = static_cast<std::size_t>(profile.joints);
    double nearest = 1;
    for (int path = 0; path < 40; ++path) {
        const JointArray worst = most_singular(profile, random);
        const Vector3d force = link.peak_force * random.direction();
        JointArray way{};
        for (std::size_t i = 0; i < joints; ++i) way[i] = random(-1, 1);
        constexpr double step = 1e-4;  // rad: 0.1 rad/s at 1 kHz
        Efforts before = Efforts::Zero();
        Jacobian j_before = Jacobian::Zero();
        bool had_pose = false;
        for (int i = -1000; i <= 1000; ++i) {
            JointArray q = worst;
            for (std::size_t k = 0; k < joints; ++k) q[k] += step * i * way[k];
            TipPose pose;
            Jacobian jacobian;
            const bool pose_here = profile.mechanism->forward({q.data(), joints}, pose, jacobian);
            const Efforts efforts =
                pose_here ? scaled(jacobian.topRows<3>().transpose() * force, link) : Efforts::Zero();
            ASSERT_TRUE(efforts.allFinite());
            for (int k = 0; k < link.actuated_joints; ++k) {
                ASSERT_LE(std::abs(efforts[k]), link.effort_limit[static_cast<std::size_t>(k)] * (1 + 1e-12));
            }
            if (pose_here) nearest = std::min(nearest, conditioning(jacobian, profile.joints));
            if (pose_here && had_pose) {
                // The change is at most that of the Jacobian itself.
                const double change = (jacobian - j_before).topRows<3>().norm() * force.norm();
                const double largest = *std::max_element(link.effort_limit.begin(), link.effort_limit.end());
                ASSERT_LE((efforts - before).norm(), 3 * std::min(change, largest) + 1e-12) << GetParam();
                if (GetParam() != "falcon") {
                    // ... and a chain's links are so short that a hand could not feel it.
                    ASSERT_LT((efforts - before).norm(), 1e-3 * largest * profile.joints) << GetParam();
                }
            }
            before = efforts;
            j_before = jacobian;
            had_pose = pose_here;
        }
    }
    EXPECT_LT(nearest, 0.02) << "the paths did come near";
}

TEST_P(Singular, AHandThatDragsTheTipPastItsReachIsHeldWithoutAKick) {
    // The hand wants to be half a metre away; the servo pulls back to the centre with a spring.
    constexpr std::uint64_t seed = 32;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed)};
    for (int trial = 0; trial < 6; ++trial) {
        const Vector3d away = 0.5 * random.direction();
        SimProfile profile = sim_profile(GetParam() + ",hand=40");
        // Only the arm's own stops; but no delta is built to reach the place where its legs are stretched.
        if (GetParam() != "falcon") profile.stop_radius = 1;
        SimDevice device(profile,
                         Motion({{.t = 0, .position = Vector3d::Zero()}, {.t = 1, .position = away}}));
        const LinkConfig& link = device.link();
        JointSample sample;
        device.read(0, sample);
        device.notify(Notice::claim_active);
        double fastest = 0;
        for (Nanoseconds now = 1'000'000; now < 2'000'000'000; now += 1'000'000) {
            device.read(now, sample);
            TipPose pose;
            Jacobian jacobian;
            Efforts efforts = Efforts::Zero();
            if (device.mechanism().forward(
                    {sample.position.data(), static_cast<std::size_t>(link.sensed_joints)}, pose, jacobian)) {
                efforts = scaled(jacobian.topRows<3>().transpose() * Vector3d(-100 * pose.position), link);
            }
            JointEfforts out;
            Efforts::Map(out.data()) = efforts;
            device.write(now, out);
            ASSERT_TRUE(device.state().position.allFinite() && std::isfinite(device.state().kinetic_energy));
            fastest = std::max(fastest, device.state().velocity.norm());
        }
        EXPECT_LT(fastest, 2.0) << GetParam() << " towards " << away.transpose();
        EXPECT_LT(device.state().velocity.norm(), 0.3) << GetParam() << ": comes to rest";
    }
}

INSTANTIATE_TEST_SUITE_P(Arms, Singular,
                         testing::Values("premium15", "falcon", "generic6", "generic7", "omni",
                                         "premium15_wrist", "woodenhaptics"),
                         [](const auto& arm) { return arm.param; });

TEST(DeltasEdge, WhereItSaysNoPoseTheMotorsCouldHoldLittleInTheLostDirection) {
    // Just before the legs cease to hold the platform, the limits scale away the force in the lost direction.
    // So zero efforts beyond are a small jump (1.1 N of 8 at most), and it lies beyond the stops.
    const SimDevice device(sim_profile("falcon"));
    const auto& delta = *device.profile().mechanism;
    Random random{std::mt19937_64(33)};
    int edges = 0;
    for (int path = 0; path < 200; ++path) {
        JointArray q = device.profile().centre, way{};
        for (std::size_t i = 0; i < 3; ++i) way[i] = random(-1, 1);
        TipPose pose;
        Jacobian jacobian = Jacobian::Zero();
        double step = 1e-3;  // rad; halved at the edge until it is found
        for (int i = 0; i < 4'000 && step > 1e-9; ++i) {
            JointArray ahead = q;
            Jacobian next;
            for (std::size_t k = 0; k < 3; ++k) ahead[k] += step * way[k];
            if (delta.forward({ahead.data(), 3}, pose, next)) {
                q = ahead;
                jacobian = next;
            } else {
                step /= 2;
            }
        }
        const Eigen::JacobiSVD<Eigen::Matrix3d> parts(jacobian.topLeftCorner<3, 3>(),
                                                      Eigen::ComputeFullU | Eigen::ComputeFullV);
        if (parts.singularValues()[0] < 10 * 0.0672) continue;  // the walk ended before an edge
        ++edges;
        const Vector3d lost = parts.matrixU().col(0);
        double force = 1e9;
        for (Eigen::Index i = 0; i < 3; ++i) {
            force = std::min(force, device.link().effort_limit[static_cast<std::size_t>(i)] /
                                        std::abs(jacobian.col(i).head<3>().dot(lost)));
        }
        EXPECT_LT(force, 0.15 * device.link().peak_force);
    }
    EXPECT_GT(edges, 20);
}

TEST(Conditioning, IsTheRatioOfSingularValues) {
    Random random{std::mt19937_64(34)};
    for (int trial = 0; trial < 1000; ++trial) {
        const int joints = 3 + trial % 6;
        Jacobian jacobian = Jacobian::Zero();
        for (int i = 0; i < joints; ++i) jacobian.col(i).head<3>() = random(0, 1) * random.direction();
        if (trial % 10 == 0) jacobian.row(2).setZero();
        const auto values =
            Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian.topRows<3>().leftCols(joints)).singularValues();
        EXPECT_NEAR(conditioning(jacobian, joints), values[2] / values[0], 2e-7);
    }
    Jacobian same = Jacobian::Zero();
    same.topLeftCorner<3, 3>() = 0.2 * Eigen::Matrix3d::Identity();
    EXPECT_EQ(conditioning(same, 3), 1);
    EXPECT_EQ(conditioning(Jacobian::Zero(), 3), 0);
}

}  // namespace
}  // namespace knurl::drivers

// Mechanisms, compared with independent references: 4x4 matrices in long double with exact derivatives,
// central differences, and the PHANToM's closed form.

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include <knurl/drivers/cartesian.hpp>
#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/pose_mechanism.hpp>
#include <knurl/drivers/serial_chain.hpp>
#include <knurl/drivers/sim_profile.hpp>

#include "../refusal.hpp"

namespace knurl::drivers {
namespace {

using Real = long double;
using Matrix4 = Eigen::Matrix<Real, 4, 4>;
using Vector3 = Eigen::Matrix<Real, 3, 1>;

/// A transform and its derivative along a direction of the motors: forward-mode differentiation, exact.
struct Moving {
    Matrix4 value = Matrix4::Identity();
    Matrix4 rate = Matrix4::Zero();
};

Moving operator*(const Moving& a, const Moving& b) {
    return {.value = a.value * b.value, .rate = a.rate * b.value + a.value * b.rate};
}

Moving turn(int axis, Real angle, Real rate) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    Moving m;
    m.value(i, i) = m.value(j, j) = std::cos(angle);
    m.value(j, i) = std::sin(angle);
    m.value(i, j) = -std::sin(angle);
    m.rate(i, i) = m.rate(j, j) = -std::sin(angle) * rate;
    m.rate(j, i) = std::cos(angle) * rate;
    m.rate(i, j) = -std::cos(angle) * rate;
    return m;
}

Moving slide(int axis, Real length, Real rate) {
    Moving m;
    m.value(axis, 3) = length;
    m.rate(axis, 3) = rate;
    return m;
}

/// The chain by its definition: Rz Tz Tx Rx per row.
Moving reference(const SerialChainTable& table, const JointArray& q, const JointArray& rates) {
    const auto n = static_cast<Eigen::Index>(table.rows.size());
    Moving tip;
    tip.value = table.base.matrix().cast<Real>();
    for (Eigen::Index i = 0; i < n; ++i) {
        Real variable = 0, rate = 0;
        for (Eigen::Index m = 0; m < n; ++m) {
            const Real share = table.coupling.size() == 0 ? static_cast<Real>(i == m) : table.coupling(i, m);
            variable += share * q[static_cast<std::size_t>(m)];
            rate += share * rates[static_cast<std::size_t>(m)];
        }
        const DhRow& row = table.rows[static_cast<std::size_t>(i)];
        const Moving joint = row.prismatic ? turn(2, row.theta, 0) * slide(2, row.d + variable, rate)
                                           : turn(2, row.theta + variable, rate) * slide(2, row.d, 0);
        tip = tip * joint * slide(0, row.a, 0) * turn(0, row.alpha, 0);
    }
    Moving tool;
    tool.value = table.tool.matrix().cast<Real>();
    return tip * tool;
}

Vector3 angular_velocity(const Moving& tip) {
    const Eigen::Matrix<Real, 3, 3> w =
        tip.rate.topLeftCorner<3, 3>() * tip.value.topLeftCorner<3, 3>().transpose();
    return {w(2, 1), w(0, 2), w(1, 0)};
}

struct Random {
    std::mt19937_64 engine;
    double operator()(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine);
    }
    JointArray joints(double size) {
        JointArray q;
        for (double& joint : q) {
            joint = (*this)(-size, size);
        }
        return q;
    }
    Eigen::Isometry3d transform() {
        Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
        t.linear() = Eigen::Quaterniond(Eigen::Vector4d::NullaryExpr([&] { return (*this)(-1, 1); }))
                         .normalized()
                         .toRotationMatrix();
        t.translation() = Eigen::Vector3d::NullaryExpr([&] { return (*this)(-0.3, 0.3); });
        return t;
    }
    SerialChainTable table(std::size_t rows) {
        SerialChainTable t;
        for (std::size_t i = 0; i < rows; ++i) {
            t.rows.push_back({.theta = (*this)(-3, 3),
                              .d = (*this)(-0.3, 0.3),
                              .a = (*this)(-0.3, 0.3),
                              .alpha = (*this)(-3, 3),
                              .prismatic = (*this)(0, 1) < 0.25});
        }
        const auto n = static_cast<Eigen::Index>(rows);
        if ((*this)(0, 1) < 0.7) {  // diagonally dominant: never singular
            t.coupling = Eigen::MatrixXd::NullaryExpr(
                n, n, [&] { return (*this)(-0.5, 0.5) / static_cast<double>(n); });
            t.coupling.diagonal().array() += 1;
        }
        t.base = transform();
        t.tool = transform();
        return t;
    }
};

class RandomChains : public testing::TestWithParam<std::size_t> {};

TEST_P(RandomChains, AgreeWithLongDoubleMatricesAndConserveWork) {
    const std::size_t rows = GetParam();
    constexpr std::uint64_t seed = 20240501;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed + rows)};
    for (int trial = 0; trial < 300; ++trial) {
        const SerialChainTable table = random.table(rows);
        const SerialChain chain(table);
        const JointArray q = random.joints(3), rates = random.joints(2);
        const Moving expected = reference(table, q, rates);

        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(chain.forward(q, pose, jacobian));
        const Vector3 position = expected.value.topRightCorner<3, 1>();
        EXPECT_LT((pose.position.cast<Real>() - position).norm(), 1e-13L);
        EXPECT_LT(
            (pose.orientation.toRotationMatrix().cast<Real>() - expected.value.topLeftCorner<3, 3>()).norm(),
            1e-13L);
        EXPECT_TRUE(jacobian.rightCols(8 - static_cast<Eigen::Index>(rows)).isZero(0));

        // Power at the motors is power at the tip: tau.q' = F.v + T.w, with v and w from the reference.
        const Eigen::Matrix<double, 6, 1> wrench =
            Eigen::Matrix<double, 6, 1>::NullaryExpr([&] { return random(-5, 5); });
        const Eigen::Matrix<double, 8, 1> tau = jacobian.transpose() * wrench;
        Real motors = 0;
        for (std::size_t i = 0; i < rows; ++i) {
            motors += static_cast<Real>(tau[static_cast<Eigen::Index>(i)]) * rates[i];
        }
        const Vector3 velocity = expected.rate.topRightCorner<3, 1>();
        const Real tip = wrench.head<3>().cast<Real>().dot(velocity) +
                         wrench.tail<3>().cast<Real>().dot(angular_velocity(expected));
        EXPECT_NEAR(static_cast<double>(motors - tip), 0, 1e-12);
    }
}

TEST_P(RandomChains, JacobianIsTheDerivativeOfThePose) {
    const std::size_t rows = GetParam();
    constexpr std::uint64_t seed = 77;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random{std::mt19937_64(seed + rows)};
    for (int trial = 0; trial < 50; ++trial) {
        const SerialChainTable table = random.table(rows);
        const SerialChain chain(table);
        const JointArray q = random.joints(3);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(chain.forward(q, pose, jacobian));
        for (std::size_t joint = 0; joint < rows; ++joint) {
            // Positions in long double: only the difference quotient's own error (h^2) remains.
            constexpr double h = 1e-5;
            JointArray ahead = q, behind = q;
            ahead[joint] += h;
            behind[joint] -= h;
            const Real step = static_cast<Real>(ahead[joint]) - behind[joint];
            const Matrix4 change =
                (reference(table, ahead, {}).value - reference(table, behind, {}).value) / step;
            const auto column = static_cast<Eigen::Index>(joint);
            const Vector3 linear = change.topRightCorner<3, 1>();
            EXPECT_LT((jacobian.block<3, 1>(0, column).cast<Real>() - linear).norm(), 1e-7L);
            const Moving turning{.value = reference(table, q, {}).value, .rate = change};
            EXPECT_LT((jacobian.block<3, 1>(3, column).cast<Real>() - angular_velocity(turning)).norm(),
                      1e-7L);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Rows, RandomChains, testing::Range<std::size_t>(1, 9));

TEST(Premium15, IsThePhantomsClosedForm) {
    const SimProfile profile = sim_profile("premium15");
    TipPose centre;
    Jacobian jacobian;
    ASSERT_TRUE(profile.mechanism->forward(profile.centre, centre, jacobian));
    EXPECT_LT(centre.position.norm(), 1e-15) << "the device frame's origin is the workspace's centre";

    // Both arm angles are measured from the base: tip = Rz(q1) (l1 cos q2 + l2 sin q3, 0, l1 sin q2 - l2 cos
    // q3).
    constexpr double l1 = 0.215, l2 = 0.170;
    const auto closed_form = [](const JointArray& q) {
        const double out = l1 * std::cos(q[1]) + l2 * std::sin(q[2]);
        return Eigen::Vector3d(std::cos(q[0]) * out, std::sin(q[0]) * out,
                               l1 * std::sin(q[1]) - l2 * std::cos(q[2]));
    };
    Random random{std::mt19937_64(5)};
    for (int trial = 0; trial < 1000; ++trial) {
        const JointArray q = random.joints(1.5);
        TipPose pose;
        ASSERT_TRUE(profile.mechanism->forward(q, pose, jacobian));
        EXPECT_LT((pose.position - (closed_form(q) - closed_form(profile.centre))).norm(), 1e-15);
        EXPECT_TRUE(jacobian.bottomRows<3>().isZero(0)) << "no torque passes through the gimbal";
        // Each motor moves only its own arm: q3 turns the forearm about its own elbow, for any q2.
        EXPECT_NEAR((jacobian.block<3, 1>(0, 1).norm()), l1, 1e-15);
        EXPECT_NEAR((jacobian.block<3, 1>(0, 2).norm()), l2, 1e-15);
    }
}

TEST(PhantomWithWrist, RowsOfTheTableGiveTheArmsTip) {
    constexpr double l1 = 0.133, l2 = 0.133, quarter = 1.5707963267948966;
    SerialChainTable table;
    table.rows = {{.alpha = quarter},           {.a = l1},          {.alpha = quarter},
                  {.d = l2, .alpha = -quarter}, {.alpha = quarter}, {.d = 0}};
    table.coupling = Eigen::MatrixXd::Identity(6, 6);
    table.coupling(2, 1) = -1;
    const SerialChain chain(table);
    Random random{std::mt19937_64(9)};
    for (int trial = 0; trial < 100; ++trial) {
        const JointArray q = random.joints(1.5);
        TipPose pose;
        Jacobian jacobian;
        ASSERT_TRUE(chain.forward(q, pose, jacobian));
        const double out = l1 * std::cos(q[1]) + l2 * std::sin(q[2]);
        const Eigen::Vector3d arm(std::cos(q[0]) * out, std::sin(q[0]) * out,
                                  l1 * std::sin(q[1]) - l2 * std::cos(q[2]));
        EXPECT_LT((pose.position - arm).norm(), 1e-15);
    }
}

TEST(SerialChain, SaysWhatIsWrongWithATable) {
    const auto refusal = [](const SerialChainTable& table) -> std::string {
        return test::refusal_of([&] { SerialChain chain(table); });
    };
    SerialChainTable table;
    EXPECT_EQ(refusal(table), "serial chain: 0 rows; give 1 to 8");
    table.rows.assign(9, {});
    EXPECT_EQ(refusal(table), "serial chain: 9 rows; give 1 to 8");
    table.rows = {{.a = 1}, {.a = 215}};
    EXPECT_EQ(refusal(table), "serial chain: row 2: a link of 215.000000 m; lengths are in metres");
    table.rows[1].a = std::nan("");
    EXPECT_EQ(refusal(table), "serial chain: row 2 holds a number that is not finite");
    table.rows[1].a = 0.2;
    table.coupling = Eigen::MatrixXd::Identity(3, 3);
    EXPECT_EQ(refusal(table),
              "serial chain: coupling is 3 x 3; give 2 x 2, one row per joint, one column per motor");
    table.coupling = Eigen::MatrixXd::Ones(2, 2);
    EXPECT_EQ(refusal(table),
              "serial chain: the coupling is singular: two motors would move the same joints");
    table.coupling = {};
    EXPECT_EQ(refusal(table), "accepted");
}

TEST(Mechanisms, HaveNoPoseForJointsThatAreNotFinite) {
    const SerialChain chain({.rows = {{.a = 1}, {.a = 1}, {.a = 1}}});
    const Cartesian cartesian;
    const PoseMechanism free;
    const Delta delta(falcon_delta());
    for (const Mechanism* mechanism :
         {static_cast<const Mechanism*>(&delta), static_cast<const Mechanism*>(&chain),
          static_cast<const Mechanism*>(&cartesian), static_cast<const Mechanism*>(&free)}) {
        JointArray q = {0.1, 0.2, 0.3, 1};
        TipPose pose;
        Jacobian jacobian;
        const auto count = static_cast<std::size_t>(mechanism->joints());
        EXPECT_TRUE(mechanism->forward({q.data(), count}, pose, jacobian));
        EXPECT_FALSE(mechanism->forward({q.data(), count - 1}, pose, jacobian));
        for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
            q[1] = bad;
            EXPECT_FALSE(mechanism->forward({q.data(), count}, pose, jacobian));
        }
    }
}

TEST(PoseMechanism, PassesAUnitPoseThroughToTheBitAndNormalisesOthers) {
    const PoseMechanism mechanism;
    TipPose pose;
    Jacobian jacobian;
    const JointArray q = {0.1, -0.2, 0.3, 0.5, 0.5, -0.5, 0.5};
    ASSERT_TRUE(mechanism.forward(q, pose, jacobian));
    EXPECT_EQ(pose.position, Eigen::Vector3d(0.1, -0.2, 0.3));
    EXPECT_EQ(pose.orientation.coeffs(), Eigen::Vector4d(0.5, -0.5, 0.5, 0.5));
    EXPECT_EQ((jacobian.leftCols<6>()), (Eigen::Matrix<double, 6, 6>::Identity()));
    EXPECT_TRUE((jacobian.rightCols<2>().isZero(0)));

    ASSERT_TRUE(mechanism.forward(JointArray{0, 0, 0, 2, 0, 0, 0}, pose, jacobian));
    EXPECT_EQ(pose.orientation.w(), 1);
    EXPECT_FALSE(mechanism.forward(JointArray{0, 0, 0, 0, 0, 0, 0}, pose, jacobian));
}

}  // namespace
}  // namespace knurl::drivers

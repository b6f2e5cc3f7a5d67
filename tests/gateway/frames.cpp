// Maps to the frames of others: rotations that keep lengths, handedness and what a pose does to a vector.

#include <random>

#include <gtest/gtest.h>

#include <knurl/gateway/frames.hpp>

namespace {

using namespace knurl;
using gateway::Axes;
namespace frames = gateway::frames;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Named {
    const char* name;
    Axes axes;
    double metre;
    Matrix3d matrix;  // of directions, written down a second time as rows
};

Matrix3d rows(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    Matrix3d m;
    m << a.transpose(), b.transpose(), c.transpose();
    return m;
}

const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();

std::vector<Named> all() {
    return {{"haply", frames::haply, 1, rows(y, -x, z)},
            {"openhaptics", frames::openhaptics, 1000, rows(y, z, x)},
            {"force dimension", frames::force_dimension, 1, Matrix3d::Identity()},
            {"ros base", frames::ros_base, 1, Matrix3d::Identity()},
            {"ros user", frames::ros_user, 1, rows(-x, -y, z)}};
}

/// Each of the 48 ways to name three axes and their signs.
std::vector<std::string> permutations() {
    std::vector<std::string> made;
    std::string order = "XYZ";
    do {
        for (int signs = 0; signs < 8; ++signs) {
            std::string text;
            for (int i = 0; i < 3; ++i) {
                if (signs >> i & 1) text += '-';
                text += order[static_cast<std::size_t>(i)];
            }
            made.push_back(text);
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return made;
}

class Frames : public ::testing::Test {
  protected:
    Frames() { RecordProperty("seed", std::to_string(seed)); }
    Vec3 vector() { return {number(), number(), number()}; }
    double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
    Quat orientation() {
        return to_plain(Eigen::Quaterniond(number(), number(), number(), number()).normalized());
    }

    const unsigned seed = std::random_device{}();
    std::mt19937 random{seed};
    ::testing::ScopedTrace trace{__FILE__, __LINE__, "seed " + std::to_string(seed)};
};

Vector3d turned(const Quat& by, const Vector3d& v) {
    return to_eigen(by) * v;
}

TEST_F(Frames, known_points_are_where_a_person_expects_them) {
    // 10 cm to the right, 20 cm towards the user, 5 cm up.
    const Vec3 point{0.2, 0.1, 0.05};
    EXPECT_EQ(frames::haply.position(point), (Vec3{0.1, -0.2, 0.05}));
    EXPECT_EQ(frames::openhaptics.position(point), (Vec3{100, 50, 200}));
    EXPECT_EQ(frames::force_dimension.position(point), point);
    EXPECT_EQ(frames::ros_user.position(point), (Vec3{-0.2, -0.1, 0.05}));
    EXPECT_EQ(frames::openhaptics.direction({1, 2, 3}), (Vec3{2, 3, 1})) << "newtons stay newtons";
    EXPECT_NEAR(frames::degrees(frames::radians(30)), 30, 1e-12);
    EXPECT_NEAR(frames::radians(180), std::numbers::pi, 1e-15);
}

TEST_F(Frames, each_is_a_proper_rotation_that_the_matrix_states_too) {
    for (const Named& named : all()) {
        SCOPED_TRACE(named.name);
        EXPECT_EQ(named.matrix.determinant(), 1);
        EXPECT_FALSE(named.axes.mirrored());
        for (int i = 0; i < 100; ++i) {
            const Vec3 v = vector();
            EXPECT_EQ(to_eigen(named.axes.direction(v)), named.matrix * to_eigen(v));
            EXPECT_EQ(to_eigen(named.axes.position(v)), named.metre * (named.matrix * to_eigen(v)));
        }
    }
}

TEST_F(Frames, there_and_back_is_where_one_was) {
    for (const Named& named : all()) {
        SCOPED_TRACE(named.name);
        for (int i = 0; i < 100; ++i) {
            const Vec3 v = vector();
            const Quat q = orientation();
            EXPECT_EQ(named.axes.back().direction(named.axes.direction(v)), v);
            EXPECT_EQ(named.axes.back().axial(named.axes.axial(v)), v);
            EXPECT_EQ(named.axes.back().orientation(named.axes.orientation(q)), q);
            EXPECT_LT((to_eigen(named.axes.back().position(named.axes.position(v))) - to_eigen(v)).norm(),
                      1e-15);
        }
    }
}

TEST_F(Frames, an_orientation_turns_a_mapped_vector_as_it_turned_the_vector) {
    for (const std::string& text : permutations()) {
        SCOPED_TRACE(text);
        const Axes axes = frames::haply.then(Axes::parse(text).value());
        for (int i = 0; i < 20; ++i) {
            const Quat q = orientation();
            const Vec3 v = vector();
            const Vector3d there = turned(axes.orientation(q), to_eigen(axes.direction(v)));
            const Vector3d mapped = to_eigen(axes.direction(to_plain(turned(q, to_eigen(v)))));
            EXPECT_LT((there - mapped).norm(), 1e-14);
        }
    }
}

TEST_F(Frames, a_cross_product_is_axial) {
    for (const std::string& text : permutations()) {
        SCOPED_TRACE(text);
        const Axes axes = Axes::parse(text).value();
        for (int i = 0; i < 20; ++i) {
            const Vec3 arm = vector(), force = vector();
            const Vec3 torque = to_plain(to_eigen(arm).cross(to_eigen(force)));
            const Vector3d there = to_eigen(axes.direction(arm)).cross(to_eigen(axes.direction(force)));
            EXPECT_LT((there - to_eigen(axes.axial(torque))).norm(), 1e-15);
        }
    }
}

TEST_F(Frames, permutations_are_read_as_the_service_documents_them) {
    const Vec3 v{1, 2, 3};
    EXPECT_EQ(Axes::parse("XYZ")->direction(v), v);
    EXPECT_EQ(Axes::parse("XZY")->direction(v), (Vec3{1, 3, 2})) << "their y is up";
    EXPECT_EQ(Axes::parse("YZX")->direction(v), (Vec3{2, 3, 1})) << "their x is Haply's y";
    EXPECT_EQ(Axes::parse("X-YZ")->direction(v), (Vec3{1, -2, 3}));
    EXPECT_EQ(Axes::parse("+X+Y-Z")->direction(v), (Vec3{1, 2, -3}));
    EXPECT_TRUE(Axes::parse("XZY")->mirrored());
    EXPECT_FALSE(Axes::parse("XZ-Y")->mirrored());
    EXPECT_EQ(permutations().size(), 48u);
    int mirrored = 0;
    for (const std::string& text : permutations()) mirrored += Axes::parse(text)->mirrored() ? 1 : 0;
    EXPECT_EQ(mirrored, 24);
    for (const char* wrong :
         {"", "XY", "XYZX", "XXY", "X-XY", "xyz", "--XYZ", "XYZ-", "+-XYZ", "XYW", "X Y Z"})
        EXPECT_FALSE(Axes::parse(wrong)) << wrong;
}

TEST_F(Frames, one_after_the_other_is_both) {
    const auto texts = permutations();
    for (int i = 0; i < 200; ++i) {
        const Axes a = Axes::parse(texts[random() % texts.size()]).value();
        const Axes b = Axes::parse(texts[random() % texts.size()]).value();
        const Vec3 v = vector();
        EXPECT_EQ(a.then(b).direction(v), b.direction(a.direction(v)));
        EXPECT_EQ(a.then(b).mirrored(), a.mirrored() != b.mirrored());
        EXPECT_EQ(a.then(a.back()), Axes{});
    }
}

}  // namespace

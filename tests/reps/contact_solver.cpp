// The joint contact solution is the optimum: in corners, among copies, at large distances and at the
// micrometre scale.

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <knurl/reps/contact_solver.hpp>

#include "kkt.hpp"

using namespace knurl;
using namespace knurl::test;
using Status = ContactSolution::Status;

namespace {

ContactSolution solve(const PlaneSet::Shifted& at, double give, const ActiveSet& guess = {}) {
    ContactSolution out;
    out.active = guess;
    solve_contact(at.planes, at.worst, give, out);
    return out;
}

ContactSolution solve(const PlaneSet& set, const ActiveSet& warm = {}) {
    return solve(set.shifted(), 0, warm);
}

testing::AssertionResult is_optimum(const PlaneSet& set, const ContactSolution& got) {
    const PlaneSet::Shifted at = set.shifted();
    if (got.status != Status::solved) {
        return testing::AssertionFailure() << set.family << ": status " << static_cast<int>(got.status)
                                           << ", " << set.size() << " planes, all satisfied by a known point";
    }
    const Kkt ref = kkt(at.planes, got.active);
    // 1e-12 of the largest length for corners down to 0.01 degrees; sharper ones amplify the rounding of
    // their normals.
    const Real allowed = 1e-12L * ref.size * std::max(1.0L, 1.7e-4L / ref.sharpness);
    const Real error = (got.dx.cast<Real>() - ref.x).norm();
    // Weights of nearly parallel planes are large and may be off by their own rounding.
    Real weights = 0;
    for (std::uint32_t i = 0; i < got.active.count; ++i) weights += std::abs(Real(got.multiplier[i]));
    if (error <= allowed && ref.violation <= allowed && ref.weight >= -1e-12L * (ref.size + weights)) {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure()
           << set.family << ", " << set.size() << " planes, " << got.active.count << " active, "
           << got.iterations << " iterations: off by " << double(error) << " m, violates by "
           << double(ref.violation) << " m, least weight " << double(ref.weight) << " m, size "
           << double(ref.size) << " m";
}

}  // namespace

TEST(ContactSolver, FindsTheOptimumOfRandomAndHostileSetsColdAndWarm) {
    const std::uint64_t seed = 20240501;
    Rng rng(seed);
    const int cases = long_form() ? 1'000'000 : 100'000;
    std::uint32_t most = 0;
    int failed = 0;
    for (int i = 0; i < cases && failed < 10; ++i) {
        PlaneSet set = any_set(rng);
        const ContactSolution cold = solve(set);
        most = std::max(most, cold.iterations);
        const auto good = is_optimum(set, cold);
        EXPECT_TRUE(good) << "seed " << seed << " case " << i;
        failed += !good;
        // A cycle later the probe has moved a little: last cycle's planes are the guess.
        set.probe += 1e-3 * set.probe.norm() * uniform(rng, 0, 0.1) * direction(rng);
        const auto warm = is_optimum(set, solve(set, cold.active));
        EXPECT_TRUE(warm) << "warm, seed " << seed << " case " << i;
        failed += !warm;
    }
    EXPECT_LT(most, max_contact_iterations) << "the bound on iterations was hit";
    RecordProperty("largest_number_of_iterations", static_cast<int>(most));
}

TEST(ContactSolver, FindsTheOptimumAmongUpTo1024Planes) {
    const std::uint64_t seed = 7;
    Rng rng(seed);
    const int cases = long_form() ? 20'000 : 1'000;
    std::uint32_t most = 0;
    for (int i = 0; i < cases; ++i) {
        const int count = between(rng, 16, 1024);
        const PlaneSet set = i % 2 ? corner(rng, count, 0.01) : cavity(rng, count, 0.05);
        const ContactSolution got = solve(set);
        most = std::max(most, got.iterations);
        ASSERT_TRUE(is_optimum(set, got)) << "seed " << seed << " case " << i;
    }
    EXPECT_LT(most, max_contact_iterations);
}

TEST(ContactSolver, NoPlaneIsViolatedOutsideOfContactAndNothingIsDone) {
    PlaneSet set;
    set.add({0, 0, 1}, 0);
    set.probe = {1, 2, 0.001};
    const ContactSolution got = solve(set);
    EXPECT_EQ(got.active.count, 0u);
    EXPECT_EQ(got.iterations, 0u);
    EXPECT_EQ(got.dx.norm(), 0.0);
}

TEST(ContactSolver, ANonsenseWarmSetIsOnlyAWrongGuess) {
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        const PlaneSet set = corner(rng, 6, 0.01);
        ActiveSet warm;
        warm.count = static_cast<std::uint32_t>(between(rng, 0, 5));
        for (auto& plane : warm.plane) plane = static_cast<std::uint32_t>(between(rng, 0, 8));
        ASSERT_TRUE(is_optimum(set, solve(set, warm))) << "case " << i;
    }
}

TEST(ContactSolver, AGuessFromElsewhereIsWhereTheSearchGoesOn) {
    // Last cycle's planes still push, but another plane is violated too: most of the work is already done.
    const std::uint64_t seed = 4;
    Rng rng(seed);
    std::uint32_t cold = 0, warm = 0;
    for (int i = 0; i < (long_form() ? 200'000 : 20'000); ++i) {
        PlaneSet set = any_set(rng);
        const ContactSolution before = solve(set);
        set.probe += set.probe.norm() * uniform(rng, 0, 1) * direction(rng);
        if (set.shifted().worst <= 0) continue;
        const ContactSolution got = solve(set, before.active);
        ASSERT_TRUE(is_optimum(set, got)) << "seed " << seed << " case " << i;
        cold += solve(set).iterations;
        warm += got.iterations;
    }
    EXPECT_LT(warm, cold * 3 / 4);
}

TEST(ContactSolver, AWarmStartGivesTheColdSolution) {
    Rng rng(11);
    int accepted = 0;
    for (int i = 0; i < 10'000; ++i) {
        const PlaneSet set = corner(rng, between(rng, 1, 9), 0.01);
        const ContactSolution cold = solve(set), warm = solve(set, cold.active);
        ASSERT_LE((cold.dx - warm.dx).norm(), 1e-15) << "case " << i;
        accepted += warm.iterations == 0;
    }
    EXPECT_EQ(accepted, 10'000) << "the right guess must be taken without a search";
}

TEST(ContactSolver, MicrometresStayExactAThousandKilometresAway) {
    Rng rng(5);
    for (int i = 0; i < 1000; ++i) {
        PlaneSet near = corner(rng, 3, 1e-6);
        PlaneSet far = near;
        const Eigen::Vector3d away = 1e6 * direction(rng);
        for (std::size_t k = 0; k < far.c.size(); ++k) far.c[k] += far.normal(k).dot(away);
        far.probe += away;
        const ContactSolution got = solve(far);
        ASSERT_TRUE(is_optimum(far, got));
        // The coordinates themselves are rounded to 1e-10 m there; a corner amplifies that by its sharpness.
        ASSERT_LE((got.dx - solve(near).dx).norm(), 1e-6);
    }
}

TEST(ContactSolver, TheScanGivesTheSameBitsAtEveryWidth) {
    // One plane at a time uses the scalar code, a few the narrow code, many the wide code, if the processor
    // has it.
    Rng rng(17);
    for (int round = 0; round < 500; ++round) {
        const PlaneSet set = cavity(rng, between(rng, 1, 70), 0.05);
        const PlaneSet::Shifted all = set.shifted();
        double worst = -INFINITY;
        for (std::uint32_t i = 0; i < set.size(); ++i) {
            double s = 0;
            worst = std::max(worst,
                             shift_to_probe(&set.nx[i], &set.ny[i], &set.nz[i], &set.c[i], 1, set.probe, &s));
            ASSERT_EQ(s, all.s[i]);
        }
        ASSERT_EQ(worst, all.worst);
        const Eigen::Vector3d dx = 0.01 * direction(rng);
        double left = -INFINITY;
        for (std::uint32_t i = 0; i < set.size(); ++i) {
            left = std::max(left, worst_violation({&set.nx[i], &set.ny[i], &set.nz[i], &all.s[i], 1}, dx));
        }
        ASSERT_EQ(left, worst_violation(all.planes, dx));
    }
}

TEST(ContactSolver, FacingPlanesThatOverlapMeetHalfway) {
    PlaneSet set;
    set.add({0, 0, 1}, 0.001);   // floor, 1 mm up
    set.add({0, 0, -1}, 0.001);  // ceiling, 1 mm down: they overlap by 2 mm
    for (const double z : {-0.01, -0.001, 0.0, 0.0005, 0.02}) {
        set.probe = {0.3, 0, z};
        const PlaneSet::Shifted at = set.shifted();
        EXPECT_EQ(solve(at, 0).status, Status::infeasible);
        double give = 0;
        ContactSolution got;
        solve_contact_relaxed(at.planes, at.worst, give, got);
        EXPECT_EQ(got.status, Status::solved);
        EXPECT_NEAR(give, 0.001, 1e-17);
        EXPECT_NEAR(z + got.dx.z(), 0, 1e-17);
        EXPECT_NEAR(got.dx.x(), 0, 1e-12);
    }
}

TEST(ContactSolver, ContradictorySetsAlwaysFindTheSmallestWayOut) {
    const std::uint64_t seed = 99;
    Rng rng(seed);
    int contradictory = 0;
    for (int i = 0; i < (long_form() ? 100'000 : 5'000); ++i) {
        PlaneSet set;
        const int count = between(rng, 2, 12);
        for (int k = 0; k < count; ++k) set.add(direction(rng), uniform(rng, -0.002, 0.01));
        set.probe = 0.02 * direction(rng);
        const PlaneSet::Shifted at = set.shifted();
        if (solve(at, 0).status != Status::infeasible) continue;
        ++contradictory;
        double give = 0;
        ContactSolution got;
        solve_contact_relaxed(at.planes, at.worst, give, got);
        ASSERT_EQ(got.status, Status::solved) << "seed " << seed << " case " << i;
        ASSERT_GT(give, 0);
        // This is the smallest: slightly less, and they contradict each other again.
        ASSERT_EQ(solve(at, give - 1e-13 * at.worst).status, Status::infeasible)
            << "seed " << seed << " case " << i << " give " << give;
        // Wherever the probe moves then, there is a solution, the same up to rounding.
        for (int k = 0; k < 20; ++k) {
            set.probe = scale(rng, 1e-6, 1) * direction(rng);
            const PlaneSet::Shifted there = set.shifted();
            double again = give;
            solve_contact_relaxed(there.planes, there.worst, again, got);
            ASSERT_EQ(got.status, Status::solved) << "seed " << seed << " case " << i;
            ASSERT_NEAR(again, give, 1e-14 * std::max(at.worst, there.worst));
        }
    }
    EXPECT_GT(contradictory, 500);
}

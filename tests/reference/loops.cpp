// Where the model is conservative, the work over a closed loop is zero: planes of any mix of stiffness,
// curved surfaces, springs, fields whose Jacobian is symmetric. For loops of about 3 mm at 1000 N/m: at most
// 1e-8 J.

#include <knurl/reps/box.hpp>
#include <knurl/reps/cap.hpp>
#include <knurl/reps/capsule.hpp>
#include <knurl/reps/constraint.hpp>
#include <knurl/reps/cylinder.hpp>
#include <knurl/reps/magnet.hpp>
#include <knurl/reps/sphere.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/reps/taylor.hpp>
#include <knurl/reps/torus.hpp>

#include "plane_scenes.hpp"

using namespace judge;

namespace {

constexpr Real most_work = 1e-8L;  // J

/// A smooth closed curve: three harmonics about a point.
struct Loop {
    Vector about, a[3], b[3];
    Loop(Rng& rng, const Vector& p, double size) : about(p) {
        for (int h = 0; h < 3; ++h) {
            a[h] = size / (h + 1) * rng.direction();
            b[h] = size / (h + 1) * rng.direction();
        }
    }
    Vector at(double t) const {
        Vector p = about;
        for (int h = 0; h < 3; ++h) p += a[h] * std::cos((h + 1) * t) + b[h] * std::sin((h + 1) * t);
        return p;
    }
    Vector slope(double t) const {
        Vector v = Vector::Zero();
        for (int h = 0; h < 3; ++h)
            v += (h + 1) * (b[h] * std::cos((h + 1) * t) - a[h] * std::sin((h + 1) * t));
        return v;
    }
};

/// Compares the work on the hand over one loop (J, by the trapezium rule) with zero.
void go_round(Case& c, Scene& scene, const Loop& loop,
              const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity()) {
    constexpr int steps = 8192;
    scene.settle();
    Real work = 0, touched = 0;
    for (int i = 0; i < steps; ++i) {
        const double t = 2 * M_PI * i / steps;
        Probe hand = at(loop.at(t));
        hand.orientation = orientation;
        const Vector force = scene.evaluate(hand, 1e-3).force;
        c.require(force.allFinite(), "finite");
        touched += force.norm() > 0;
        work += Real(force.dot(loop.slope(t))) * (2 * exact::pi / steps);
    }
    c.say("  work %Lg J, felt in %Lg of %d\n", work, touched, steps);
    c.compare({static_cast<double>(work), 0, 0}, {}, 1);
    if (touched == 0) c.skip();
}

void loops(const std::string& kind, const std::function<void(Case&, Scene&, Vector&)>& build,
           std::uint64_t share = 40) {
    run(
        "work, " + kind, share,
        [&](Case& c) {
            Scene scene({16, 1}, {});
            Vector about = Vector::Zero();
            build(c, scene, about);
            go_round(c, scene, Loop(c.rng, about, 0.001));
        },
        most_work, 2'000);
}

template <class R>
void add(Case& c, Scene& scene, R r, std::uint32_t slot = 0) {
    c.require(bool(scene.add({slot, 1}, r)), "added");
}

}  // namespace

TEST(Loops, OfPlanesOfAnyMixOfStiffnessReturnTheirWork) {
    loops("planes", [](Case& c, Scene& scene, Vector& about) {
        PlaneScene s;
        s.size = 0.003;
        switch (c.rng.between(0, 3)) {
            case 0:
                wedge(c.rng, s);
                break;
            case 1:
                fan(c.rng, s);
                break;
            case 2:
                slab(c.rng, s);
                break;
            default:
                corner(c.rng, s);
        }
        for (std::uint32_t i = 0; i < s.planes.size(); ++i) {
            s.planes[i].stiffness = c.rng.of(200, 500, 1000, 1000);
            add(c, scene, s.planes[i], i);
        }
        about = s.probe;
    });
    loops("planes, contradictory", [](Case& c, Scene& scene, Vector& about) {
        PlaneScene s;
        s.size = 0.003;
        contradictory(c.rng, s);
        for (std::uint32_t i = 0; i < s.planes.size(); ++i) {
            s.planes[i].stiffness = c.rng.of(300, 700, 2000);
            add(c, scene, s.planes[i], i);
        }
        about = s.probe;
    });
}

TEST(Loops, OnCapsReturnTheirWork) {
    loops("cap, one curvature", [](Case& c, Scene& scene, Vector& about) {
        knurl::Cap cap{.normal = knurl::to_plain(c.rng.direction()),
                       .curvature = c.rng.of(-1, 1) * c.rng.uniform(10, 100),
                       .rim = c.rng.uniform(0, 0.4),
                       .stiffness = 1000};
        add(c, scene, cap);
        about = -0.001 * knurl::to_eigen(cap.normal);
    });
    loops("cap, two curvatures", [](Case& c, Scene& scene, Vector& about) {
        knurl::Cap cap{.normal = knurl::to_plain(c.rng.direction()),
                       .curvature = c.rng.of(-1, 1) * c.rng.uniform(10, 100)};
        cap.curvature2 = c.rng.of(-1, 1) * c.rng.uniform(10, 100);
        cap.axis = knurl::to_plain(c.rng.across(knurl::to_eigen(cap.normal)));
        cap.rim = c.rng.uniform(0, 0.4);
        cap.stiffness = 1000;
        add(c, scene, cap);
        about = -0.001 * knurl::to_eigen(cap.normal);
    });
}

TEST(Loops, OnSolidsAndInHollowsReturnTheirWork) {
    const auto side = [](Rng& rng) { return rng.one_in(2) ? knurl::Side::inside : knurl::Side::outside; };
    // Places a probe with or without a radius. Returns how far outside of the surface its centre begins to
    // touch.
    const auto any_finger = [](Case& c, Scene& scene, knurl::Side where) {
        const double radius = c.rng.of(0, 0.004);
        c.require(bool(scene.place_probe(0, {.offset = {}, .radius = radius})), "placed");
        return where == knurl::Side::inside ? -radius : radius;
    };
    loops("sphere", [&](Case& c, Scene& scene, Vector& about) {
        knurl::Sphere s{.radius = c.rng.uniform(0.012, 0.03), .side = side(c.rng), .stiffness = 1000};
        add(c, scene, s);
        about = (s.radius + any_finger(c, scene, s.side)) * c.rng.direction();
    });
    loops("capsule", [&](Case& c, Scene& scene, Vector& about) {
        const Vector axis = c.rng.direction();
        knurl::Capsule s{.axis = knurl::to_plain(axis),
                         .half_length = 0.01,
                         .radius = c.rng.uniform(0.012, 0.03),
                         .side = side(c.rng),
                         .stiffness = 1000};
        add(c, scene, s);
        about = c.rng.of(0, 0.01) * axis + (s.radius + any_finger(c, scene, s.side)) * c.rng.across(axis);
    });
    loops("cylinder", [&](Case& c, Scene& scene, Vector& about) {
        const Vector axis = c.rng.direction();
        knurl::Cylinder s{.axis = knurl::to_plain(axis),
                          .radius = c.rng.uniform(0.012, 0.03),
                          .half_length = 0.02,
                          .side = side(c.rng),
                          .stiffness = 1000};
        add(c, scene, s);
        c.require(bool(scene.place_probe(0, {.offset = {}, .radius = 0.004})), "placed");
        // At the wall, or in the corner of a hollow. A solid's edge is left out, where the probe would be
        // deeper than its radius.
        const bool hollow = s.side == knurl::Side::inside;
        about = (hollow ? 0.016 * c.rng.of(0, 1) : 0.0) * axis +
                (hollow ? s.radius - 0.004 : s.radius + 0.004) * c.rng.across(axis);
    });
    loops("torus", [&](Case& c, Scene& scene, Vector& about) {
        const Vector axis = c.rng.direction(), out = c.rng.across(axis);
        knurl::Torus s{.axis = knurl::to_plain(axis),
                       .radius = c.rng.uniform(0.03, 0.05),
                       .tube = c.rng.uniform(0.012, 0.02),
                       .side = side(c.rng),
                       .stiffness = 1000};
        add(c, scene, s);
        const double angle = c.rng.uniform(-M_PI, M_PI);
        about = s.radius * out +
                (s.tube + any_finger(c, scene, s.side)) * (std::cos(angle) * out + std::sin(angle) * axis);
    });
    loops("box, hollow", [&](Case& c, Scene& scene, Vector& about) {
        knurl::Box s{.half_size = {0.01, 0.01, 0.01}, .side = knurl::Side::inside, .stiffness = 1000};
        add(c, scene, s);
        about = {0.01, c.rng.of(0, 0.01), c.rng.of(0, 0.01)};
    });
}

TEST(Loops, OfSpringsAndFieldsReturnTheirWork) {
    loops("springs", [](Case& c, Scene& scene, Vector&) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const double length = c.rng.scale(1e-4, 0.05);
            knurl::Spring s{.anchor = knurl::to_plain(length * c.rng.direction()),
                            .rest_length = c.rng.one_in(3) ? 0 : c.rng.scale(1e-3, 0.05),
                            .stiffness = 300};
            add(c, scene, s, i);
        }
    });
    loops("taylor, symmetric", [](Case& c, Scene& scene, Vector&) {
        knurl::Taylor t{.force = knurl::to_plain(c.rng.direction())};
        for (int row = 0; row < 3; ++row) {
            for (int col = 0; col <= row; ++col) {
                t.jacobian.at[3 * row + col] = t.jacobian.at[3 * col + row] = c.rng.uniform(-1000, 1000);
            }
        }
        add(c, scene, t);
    });
    loops("magnet", [](Case& c, Scene& scene, Vector& about) {
        knurl::Magnet m{
            .radius = c.rng.one_in(2) ? 0 : 0.01, .stiffness = 1000, .max_force = 1, .max_distance = 0.003};
        add(c, scene, m);
        about = (m.radius + 0.001) * c.rng.direction();
    });
    loops("constraint", [](Case& c, Scene& scene, Vector&) {
        knurl::Constraint k{.direction = knurl::to_plain(c.rng.direction()), .stiffness = 1000};
        k.shape = static_cast<knurl::ConstraintShape>(c.rng.between(0, 2));
        add(c, scene, k);
    });
}

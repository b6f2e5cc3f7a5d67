#pragma once
// Friction implemented again from the manual's text, in long double. It tracks the stretch of the spring (tip
// minus anchor) and the way since the last snag instead of an anchor, and finds a snag's place by bisection.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <knurl/reps/friction.hpp>

namespace knurl::test {

class FrictionModel {
  public:
    using Real = long double;
    using RealVector = Eigen::Matrix<Real, 3, 1>;

    struct Law {
        enum { coulomb, passive, paper } kind = coulomb;
        Real stiffness = 0;  // N/m; paper: 1/m
        Real holds = 0, slides = 0;
        Real d_snap = 0, d_mean = 0, d_spread = 0;
        std::uint64_t seed = 1;
        Real max_stiffness = std::numeric_limits<Real>::infinity();
        Real count = 0;  // m, of the encoder
    };

    explicit FrictionModel(const Law& law) : law_(law), generator_(law.seed) {}

    /// The force after the tip went to `tip`, seen from the moving surface.
    RealVector step(const RealVector& tip, const RealVector& normal, Real normal_force,
                    const RealVector& moved) {
        if (!(normal_force > 0)) {
            touching_ = false;
            return RealVector::Zero();
        }
        if (!touching_) {
            touching_ = true;
            sliding_ = false;
            stretch_.setZero();
            left_.setZero();
        } else {
            stretch_ += tip - last_tip_ - moved;
            left_ += tip - last_tip_ - moved;
        }
        last_tip_ = tip;
        flatten(stretch_, normal);
        way_ = left_;
        flatten(way_, normal);
        const Real k = std::min(law_.max_stiffness,
                                law_.kind == Law::paper ? law_.stiffness * normal_force : law_.stiffness);
        const RealVector force = law_.kind == Law::paper ? paper(k, normal_force) : anchored(k, normal_force);
        const Real most = std::max(law_.holds, law_.slides) * normal_force;
        return force.norm() > most ? RealVector(force * (most / force.norm())) : force;
    }

    int snags() const { return snags_; }

  private:
    static void flatten(RealVector& v, const RealVector& normal) { v -= normal.dot(v) * normal; }

    Real draw() {
        generator_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = generator_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        const Real even = static_cast<Real>((z ^ (z >> 31)) >> 11) / 9007199254740992.0L;
        return std::max(Real(0), law_.d_mean + law_.d_spread * (even - 0.5L));
    }

    // `way_`: from the last snag's release to the tip; the anchor's way is that minus the stretch.
    RealVector anchored(Real k, Real n) {
        const auto lets_go = [&] {
            sliding_ = true;
            way_ = left_ = stretch_;
            if (law_.kind == Law::passive) next_ = draw();
        };
        if (!sliding_ && k * stretch_.norm() > law_.holds * n) lets_go();
        if (sliding_) {
            const Real longest = law_.slides * n / k, length = stretch_.norm();
            const RealVector before = way_ - stretch_;  // the anchor's, in this cycle
            const RealVector far = stretch_;
            if (length < 0.7L * longest) sliding_ = false;
            if (length > longest) stretch_ *= longest / length;
            if (sliding_ && law_.kind == Law::passive && (way_ - stretch_).norm() >= next_)
                catch_at(before, far, k, n);
        }
        return -k * stretch_;
    }

    void catch_at(const RealVector& before, const RealVector& far, Real k, Real n) {
        const RealVector slid = stretch_;
        Real none = 0, all = 1;  // of the anchor's way in this cycle
        for (int i = 0; i < 200; ++i) {
            const Real half = (none + all) / 2;
            ((before + half * (far - slid)).norm() < next_ ? none : all) = half;
        }
        stretch_ = far + all * (slid - far);
        ++snags_;
        if (k * stretch_.norm() <= law_.holds * n) {
            sliding_ = false;
        } else {  // held and let go at once
            stretch_ = slid;
            way_ = left_ = slid;
            next_ = draw();
        }
    }

    RealVector paper(Real k, Real n) {
        if (!sliding_ && stretch_.norm() > law_.d_snap) {
            if (law_.d_snap > 0 && law_.d_mean == 0) {
                stretch_ *= law_.d_snap / stretch_.norm();
            } else {
                sliding_ = true;
                farthest_ = 0;
                next_ = draw();
                if (law_.d_snap == 0) next_ = std::numeric_limits<Real>::infinity();
            }
        }
        if (!sliding_) return -k * stretch_;
        const Real r = stretch_.norm();
        farthest_ = std::max(farthest_, r);
        if (r >= next_) {
            stretch_ -= stretch_ / r * next_;
            sliding_ = false;
            ++snags_;
        } else if (farthest_ > r + 2 * law_.count) {
            stretch_.setZero();
            sliding_ = false;
            ++snags_;
        }
        if (!sliding_) return -k * stretch_;
        return -law_.slides * n / r * stretch_;
    }

    Law law_;
    std::uint64_t generator_;
    RealVector stretch_ = RealVector::Zero(), last_tip_ = RealVector::Zero();
    // tip minus snag; and along the surface
    RealVector left_ = RealVector::Zero(), way_ = RealVector::Zero();
    Real next_ = 0, farthest_ = 0;
    bool touching_ = false, sliding_ = false;
    int snags_ = 0;
};

}  // namespace knurl::test

#pragma once
// The god-object of Zilles and Salisbury on one surface: the point at which the surface holds a probe while
// the hand goes on. It has no limits of work and uses no approximation.

#include "surface.hpp"

namespace exact {

class GodObject {
  public:
    explicit GodObject(const Surface& surface) : surface_(&surface) {}

    /// Moves the hand there. True: the surface holds it.
    bool step(const V& hand);

    const V& at() const { return at_; }
    bool touching() const { return touching_; }
    int face() const { return face_; }
    /// The direction of free space at `at`.
    V normal() const { return surface_->pseudonormal(face_, surface_->nearest(face_, at_)); }
    /// Moves the god-object to that place and face, to which another path could have led as well.
    void put(const V& at, int face);
    void let_go(const V& hand);
    /// How often 1000 rounds of going on from face to face did not come to rest: must be 0.
    int unsettled() const { return unsettled_; }

  private:
    Nearest3 descend(const V& hand);
    bool held(const Nearest3& rest, const V& hand) const;

    const Surface* surface_;
    V at_, last_;
    int face_ = -1;
    bool touching_ = false, met_ = false;
    int unsettled_ = 0;
};

}  // namespace exact

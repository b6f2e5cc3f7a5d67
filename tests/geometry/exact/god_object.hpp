#pragma once
// The god-object of Zilles and Salisbury on one surface: where a probe that may not go through is held while
// the hand goes on. No step of it is bounded in number, and it never guesses.

#include "surface.hpp"

namespace exact {

class GodObject {
  public:
    explicit GodObject(const Surface& surface) : surface_(&surface) {}

    /// The hand is there now. True: held back.
    bool step(const V& hand);

    const V& at() const { return at_; }
    bool touching() const { return touching_; }
    int face() const { return face_; }
    /// Where free space is as seen from `at`.
    V normal() const { return surface_->pseudonormal(face_, surface_->nearest(face_, at_)); }
    /// It is held there by that face now: another way to have come here was as good.
    void put(const V& at, int face);
    void let_go(const V& hand);
    /// Rounds of going on after having been held by another face that did not come to rest: must be 0.
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

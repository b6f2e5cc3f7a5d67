#pragma once

#include <algorithm>
#include <cstdint>

namespace bodies {

/// What went between a hand and a body, J since the beginning.
struct Account {
    double hand = 0;          // put in by the hand, less what it got back
    double hand_in = 0;       // put in by the hand
    double body = 0;          // given to the body: force times way
    double spring = 0;        // in the servo's springs now
    double lost = 0;          // thrown away
    double most_created = 0;  // the most that body + spring + lost was above hand
    std::uint64_t frames = 0,
                  short_of = 0;  // with a force on the body; with one that the account made smaller

    double left() const { return hand - body - spring - lost; }
    void put_in(double work) {
        hand += work;
        hand_in += std::max(0.0, work);
    }
    void settle() { most_created = std::max(most_created, -left()); }
    /// No more than `reserve` is kept for later.
    void keep(double reserve) { lost += std::max(0.0, left() - reserve); }
    void operator+=(const Account& other) {
        hand += other.hand;
        hand_in += other.hand_in;
        body += other.body;
        spring += other.spring;
        lost += other.lost;
        most_created += other.most_created;
        frames += other.frames;
        short_of += other.short_of;
    }
};

}  // namespace bodies

#pragma once

#include <algorithm>
#include <cstdint>

namespace knurl {

/// What went between a hand and a simulated body by springs or contacts that belong together, J in the hand's
/// units since the beginning. One spring's delay makes energy that another of them takes out: what acts on
/// one body has one account.
struct EnergyAccount {
    double hand = 0;     // put in by the hand, less what it got back
    double hand_in = 0;  // put in by the hand
    double body = 0;     // given to the body: sum of force times way
    double spring = 0;   // in the servo's springs now
    double lost = 0;     // thrown away: beyond a reserve, or with a spring that faded; less what was forgiven
    // body + spring + lost - hand: as the newest frame came, when what the one before had sent had arrived;
    // and the most at any time, of which a frame under way is the larger part.
    double created = 0, most_created = 0;

    double left() const { return hand - body - spring - lost; }
    void put_in(double work) {
        hand += work;
        hand_in += std::max(0.0, work);
    }
    void settle() { most_created = std::max(most_created, -left()); }
    /// No more than `reserve` is kept for later.
    void keep(double reserve) { lost += std::max(0.0, left() - reserve); }
    /// A debt is struck off, since the body has lost what it owes. `most_created` still tells how much that was.
    void forgive() { lost += std::min(0.0, left()); }
    /// The springs fade, and what is in them goes.
    void drop_springs() {
        lost += spring;
        spring = 0;
    }
    void operator+=(const EnergyAccount& other) {
        hand += other.hand;
        hand_in += other.hand_in;
        body += other.body;
        spring += other.spring;
        lost += other.lost;
        created += other.created;
        most_created += other.most_created;
    }
};

}  // namespace knurl

#pragma once

#include <algorithm>
#include <cstdint>

namespace knurl {

/// Energy that went between a hand and a simulated body through springs or contacts that belong together (J
/// of the hand, since the beginning). One spring's delay makes energy that another of them takes out: what
/// acts on one body has one account.
struct EnergyAccount {
    /// Put in by the hand, less what it got back (J).
    double hand = 0;
    /// Put in by the hand (J).
    double hand_in = 0;
    /// Given to the body (J): sum of force times way.
    double body = 0;
    /// In the servo's springs now (J).
    double spring = 0;
    /// Thrown away (J): beyond a reserve, or with a spring that faded; less what was forgiven.
    double lost = 0;
    /// body + spring + lost - hand (J), as the newest frame came, when the force that the one before had sent
    /// had arrived.
    double created = 0;
    /// Largest body + spring + lost - hand at any time (J), of which a frame under way is the larger part.
    double most_created = 0;

    /// What is left to give (J).
    double left() const { return hand - body - spring - lost; }
    /// The hand has done this work (J); negative: it got it back.
    void put_in(double work) {
        hand += work;
        hand_in += std::max(0.0, work);
    }
    /// Brings most_created up to date.
    void settle() { most_created = std::max(most_created, -left()); }
    /// No more than `reserve` is kept for later.
    void keep(double reserve) { lost += std::max(0.0, left() - reserve); }
    /// A debt is struck off, since the body has lost what it owes. `most_created` still tells how much that
    /// was.
    void forgive() { lost += std::min(0.0, left()); }
    /// The springs fade, and what is in them goes.
    void drop_springs() {
        lost += spring;
        spring = 0;
    }
    /// The sum of both accounts, for reports.
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

#pragma once
// The plan of a simulated hand: where it goes, and when it takes and releases.

#include <string>
#include <vector>

#include <knurl/drivers/motion.hpp>

#include "world.hpp"

namespace bodies {

class Script {
  public:
    struct Event {
        double t;  // s
        bool take;
    };

    explicit Script(const Vector3d& start);
    /// Straight on, from rest to rest (minimum jerk); `speed`: maximum, m/s.
    Script& to(const Vector3d& where, double speed);
    Script& rest(double seconds);
    Script& take();
    Script& let_go();

    double end() const { return rows_.back().t; }  // s
    const std::vector<Event>& events() const { return events_; }
    knurl::drivers::Motion motion() const { return knurl::drivers::Motion(rows_); }
    /// As `knurld --hand` plays it. Throws std::runtime_error.
    void write(const std::string& path) const;

  private:
    std::vector<knurl::drivers::MotionRow> rows_;
    std::vector<Event> events_;
};

/// Pushes the cube along the floor, takes it, sets it on the slab and leaves it there (usual_bodies).
Script push_take_and_stack();

}  // namespace bodies

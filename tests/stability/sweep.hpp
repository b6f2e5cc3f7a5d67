#pragma once
// The questions of the sweep: one factor at a time about the centre, which Conditions' defaults state, or the
// full grid.

#include "search.hpp"
#include "table.hpp"

namespace stability {

/// Servo-evaluated planes against forces from the application, on a flat wall.
Table wall_table(Seeds seeds);
/// Each method by each criterion, on one ridge at 0.15 m/s.
Table method_table(const char* key, const char* title, const Ridge& ridge, Seeds seeds);
/// The goals' measure (jump and kick) of each method by ridge and speed.
Table speed_table(Seeds seeds);
/// The static limit of a wall against b / (T/2 + tau) and the exact eigenvalue.
Table bound_table(Seeds seeds);
/// Virtual damping counted and not, and hand present and released.
Table damping_table(Seeds seeds);
Table released_table(Seeds seeds);
/// One factor at a time; a table each.
std::vector<Table> factor_tables(Seeds seeds);
/// The real servo and simulated devices.
Table device_table(Seeds seeds);
/// 2100 N/m, the paper's own value, on premium15: the quality of a stroke.
Table paper_wall_table(Seeds seeds);
/// Force error against the true surface, by application rate.
Table error_table(Seeds seeds);
/// A remote application: stiffness by the network's delay, its swing, its loss; a table each.
std::vector<Table> network_tables(Seeds seeds);
/// All combinations.
Table full_grid(Seeds seeds);

}  // namespace stability

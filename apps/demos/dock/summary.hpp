#pragma once
// The figures of a run.

#include <string>

#include "dock.hpp"

namespace dock {

/// In newtons, metres, seconds. Energies are joules of the hand, unless named kJ/mol.
struct Summary {
    double seconds = 0;  // held
    double frames_per_second = 0;
    double rms_force = 0, peak_force = 0;
    double step = 0;                               // N, largest in a cycle
    double end_step = 0;                           // N, the part that the hand's motion does not explain
    double rms_length = 0;                         // m, of the spring: hand to atom
    double moved = 0;                              // nm, farthest that the atom got from where it was taken
    double temperature = 0, peak_temperature = 0;  // K; mean
    double hand_in = 0, hand = 0, body = 0, lost = 0, spring = 0, created = 0, most_created = 0;
    double created_share = 0;         // of hand_in
    double hand_kj = 0, body_kj = 0;  // kJ/mol
    double simulation_kj = 0;         // rise of its total energy over the frames of body_kj
    bool simulation_tells = false;
};
Summary summarise(const Docked& docked, const DockOptions& options);

std::string text_of(const Summary& summary, const Docked& docked, const DockOptions& options);
std::string json_of(const Summary& summary, const Docked& docked, const DockOptions& options);
/// A row a cycle.
void write_csv(const std::string& path, const Docked& docked);

}  // namespace dock

#pragma once
// A hand that holds an atom of a running simulation.

#include <atomic>
#include <deque>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <knurl/client/coupling.hpp>

#include "imd.hpp"

namespace dock {

struct DockOptions {
    std::string device;                 // empty: the only one
    bool share = false;                 // other programs may hold it as well
    double scale = 50;                  // mm in the hand for 1 nm
    double force_scale = 10;            // mN in the hand for 1 pN
    double stiffness = 200;             // N/m in the hand
    double greatest_force = 5;          // kcal/mol/A on the atom
    double greatest_temperature = 450;  // K: above it the atom is not pulled
    double rate = 100;                  // frames per second
    double box = 0;                     // nm: edge of a periodic box; 0: not periodic
    long atom = -1;                     // the atom to hold; -1: the nearest to the hand
    bool at_once = false;               // holds without button or key
    bool keep_account = true;
    double seconds = 0;  // 0: until `stop`
};

/// One cycle of the servo, in the hand's frame.
struct Cycle {
    std::uint64_t number = 0;                         // of the servo's
    double t = 0;                                     // s since the device was active
    bool on_time = false;                             // read within one and a half periods of the one before
    bool told = false;                                // the force is known for this very cycle
    Eigen::Vector3d hand = Eigen::Vector3d::Zero();   // m
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, of the spring on the hand
    Eigen::Vector3d atom = Eigen::Vector3d::Zero();   // m, in the newest frame
    Eigen::Vector3d atom_force = Eigen::Vector3d::Zero();  // kcal/mol/A, as sent last
    std::uint64_t frame = 0;                               // number of that frame; 0: holds nothing
};

/// One frame of the simulation.
struct FrameSeen {
    double t = 0;
    std::int64_t step = -1;
    double temperature = 0, total_energy = 0;  // K; the simulation's unit
    knurl::Coupling::Account account;
};

struct Docked {
    std::size_t atoms = 0;
    long atom = -1;  // held last; -1: none
    double steps_per_second = 0;
    int steps_per_frame = 0;
    bool swapped = false;
    // Of the first hour, in a deque: a vector that moves would delay the hand's loop.
    std::deque<Cycle> cycles;
    std::vector<FrameSeen> frames;  // while held
    knurl::Coupling::Account account;
    knurl::Coupling::Counts counts;
    std::uint64_t hot = 0;    // frames in which it was too hot to pull
    double compliance = 0;    // m/N in a frame
    double energy_scale = 0;  // kcal/mol for a joule of the hand's
    std::uint64_t unread = 0, late = 0;
    std::uint64_t stopped = 0;  // how often this program was stopped, and the atom released meanwhile
    std::uint32_t faults = 0;
    std::string ended;  // the reason, unless time or the user ended it
};

/// 1 N/m of the hand as stiffness on the atom, in kcal/mol/A^2.
double stiffness_on_atom(const DockOptions& options);
knurl::CouplingScale scale_of(const DockOptions& options);
/// None: the options are usable. Else the reason.
std::string unfit(const DockOptions& options);

/// `told` gets a line at times; `key` returns a key pressed since (0: none): space takes and releases, q
/// ends. Throws knurl::Error, ImdError.
Docked dock(knurl::Client& client, Imd& simulation, const DockOptions& options, const std::atomic<bool>& stop,
            const std::function<void(const std::string&)>& told, const std::function<char()>& key);

}  // namespace dock

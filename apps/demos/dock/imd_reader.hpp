#pragma once
// IMD, version 2, as bytes: the messages of a running simulation (VMD's "interactive molecular dynamics";
// GROMACS, NAMD and LAMMPS speak it).
//
// A header is two 32-bit words, big-endian: type and length. A server's first message is the handshake, whose
// length is the version in the server's own byte order. Bodies have that order from then on; headers stay
// big-endian.

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace dock {

enum class ImdType : std::int32_t {
    disconnect = 0,
    energies = 1,
    coordinates = 2,
    go = 3,
    handshake = 4,
    kill = 5,
    forces = 6,
    pause = 7,
    rate = 8,
    error = 9,
};
constexpr std::int32_t imd_version = 2;

/// One line: what arrived, what was expected, what to do.
struct ImdError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// In the simulation's units: GROMACS sends kJ/mol, NAMD kcal/mol.
struct ImdEnergies {
    std::int32_t step = 0;
    float temperature = 0;  // K
    float total = 0, potential = 0, van_der_waals = 0, coulomb = 0;
    float bonds = 0, angles = 0, dihedrals = 0, impropers = 0;
};
static_assert(sizeof(ImdEnergies) == 40);

struct ImdFrame {
    std::optional<ImdEnergies> energies;  // those since the last frame
    std::vector<Eigen::Vector3f> atoms;   // A; never empty
};

class ImdReader {
  public:
    static constexpr std::int32_t most_atoms = 10'000'000;

    /// Data from the server, in pieces of any size.
    void feed(std::span<const std::byte> bytes);
    /// The next whole frame; none: more data is needed. Throws ImdError for data that is not IMD.
    std::optional<ImdFrame> next();

    bool greeted() const { return swapped_.has_value(); }
    /// The server's byte order is not this machine's.
    bool swapped() const { return swapped_.value_or(false); }
    bool ended() const { return ended_; }    // the server has announced its end
    bool paused() const { return paused_; }  // it has announced a pause, and sent nothing since
    bool within_message() const { return used_ < bytes_.size() && !ended_; }

  private:
    void greet(std::int32_t type, std::span<const std::byte> length);
    std::optional<ImdFrame> coordinates(std::span<const std::byte> body);

    std::vector<std::byte> bytes_;
    std::size_t used_ = 0;   // of them
    std::size_t atoms_ = 0;  // in each frame; 0: not known yet
    std::optional<ImdEnergies> energies_;
    std::optional<bool> swapped_;
    bool ended_ = false, paused_ = false;
};

/// A message without a body.
std::string imd_header(ImdType type, std::int32_t length);
/// One force in kcal/mol/A on one atom, none on all others; it stays until replaced.
std::string imd_force(std::int32_t atom, const Eigen::Vector3f& force, bool swapped);

}  // namespace dock

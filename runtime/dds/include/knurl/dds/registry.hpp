#pragma once

/// @file
/// The servos of a domain: each knurl-dds announces its own, and sees all others'. Nobody keeps the list: it is what the
/// servos say now, so that no failure of one host is another's.

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <knurl/dds/domain.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::dds {

/// A device, as its servo announces it.
struct DeviceEntry {
    /// Name by which it is claimed.
    std::string name{};
    /// "premium15".
    std::string profile{};
    /// "idle".
    std::string state{};
    /// "slew, power"; empty: none.
    std::string faults{};
    /// Hz, as configured and as measured (0: not known).
    double rate = 0, measured_rate = 0;
    /// N: largest, and as sent now.
    double peak_force = 0, force = 0;
    /// N/m.
    double max_stiffness = 0;
    /// What it can do, and whether peers of the domain may command it.
    bool renders_torque = false, senses_orientation = false, commanded_by_dds = false;
    /// Clients that hold it.
    std::uint32_t holders = 0;
    /// Cycles, and those that were late.
    std::uint64_t cycles = 0, late_cycles = 0;
    friend bool operator==(const DeviceEntry&, const DeviceEntry&) = default;
};

/// A servo, as it announces itself.
struct ServoEntry {
    /// Of this run of its knurl-dds.
    std::string id{};
    /// Name in the domain, on its host, and that host.
    std::string name{}, servo{}, host{};
    /// Of knurl-dds.
    std::uint32_t pid = 0;
    /// Version of Knurl.
    std::string build{};
    /// HOST:PORT of its bridge; empty: none.
    std::string bridge{};
    /// "running", or "gone".
    std::string state{};
    /// Its devices.
    std::vector<DeviceEntry> devices{};
    friend bool operator==(const ServoEntry&, const ServoEntry&) = default;
};

/// As JSON, for `knurl ls --domain`.
std::string json_of(const ServoEntry& servo);

/// The servos of a domain. Any thread may call.
class Registry {
  public:
    /// Silence after which a servo is gone for everybody.
    static constexpr std::chrono::milliseconds lease{1000};
    /// How often each says what it is.
    static constexpr std::chrono::milliseconds period{500};
    /// Who has said nothing new for so long is gone too, whatever the engine says: it may take a participant's whole lease
    /// where a process dies while it is being discovered.
    static constexpr std::chrono::milliseconds silence{1500};
    /// Most servos that are listed.
    static constexpr std::size_t most_servos = 4096;

    /// Listens to the domain.
    explicit Registry(Domain& domain);

    /// Says what this process's servo is: call it every `period`, and when something has changed.
    void announce(const ServoEntry& servo);
    /// This process's servo, as it was announced last; no id: none was.
    ServoEntry own() const;
    /// Those that are alive, by name, and of one name by id. Call it every `period`, so that silence is noticed.
    std::vector<ServoEntry> servos() const;
    /// For each name that several servos have: one line. Empty: each has its own.
    std::vector<std::string> name_clashes() const;
    /// Address for Client::connect, or "? " and why there is none.
    std::string resolve(const std::string& name) const;

  private:
    Domain& domain_;
    Entity reader_, writer_;
    mutable std::mutex mutex_;
    ServoEntry own_;
    std::uint64_t revision_ = 0;
    /// When each has said something new.
    struct Heard {
        std::uint64_t revision = 0;
        std::chrono::steady_clock::time_point at{};
    };
    mutable std::map<std::string, Heard> heard_;
};

/// Answers the programs of this host (knurl/protocol/registry.hpp).
class RegistryDoor {
  public:
    /// Listens at that path. Throws std::runtime_error, one line.
    RegistryDoor(const Registry& registry, const std::string& path, std::uint32_t domain,
                 const std::string& name);
    /// Ends, and takes the socket away.
    ~RegistryDoor();
    RegistryDoor(const RegistryDoor&) = delete;
    RegistryDoor& operator=(const RegistryDoor&) = delete;

  private:
    void serve();
    void answer(int connection) const;

    const Registry& registry_;
    const std::string path_, hello_;
    shm::UniqueFd listener_, stop_;
    std::thread thread_;
};

}  // namespace knurl::dds

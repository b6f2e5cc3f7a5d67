#pragma once
// A simulated device that outlives the servo: its process, its log, and the driver "shared-sim:FILE".

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/drivers/device.hpp>
#include <knurl/drivers/registry.hpp>

#include "layout.hpp"

namespace knurl::drivers::shared_sim {

/// A shared mapping of a fake device's file. Throws std::runtime_error: no such file, not a fake device's.
class Mapping {
  public:
    explicit Mapping(const std::string& path);
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;

    Shared* operator->() const { return shared_; }
    Shared& operator*() const { return *shared_; }

  private:
    Shared* shared_;
    std::size_t size_;
};

/// The records written so far. The file stays when its process is killed.
std::vector<Record> read_log(const Mapping& mapping);

/// A path in memory for such a file of this process, if there is room for `capacity` records. On a busy disk
/// the device would wait for its log, and the servo would rightly ramp down.
std::string file_in_memory(const std::string& name, std::uint64_t capacity);

/// A knurl-fake-device for this test: the constructor returns when it runs and is mapped.
class FakeDevice {
  public:
    struct Settings {
        std::string path;                   // file to make: file_in_memory()
        std::string profile = "premium15";  // as in "sim:PROFILE,options"; three joints, quantum not 0
        std::string hand_file = {};
        std::chrono::microseconds period{200};  // between two looks at the efforts
        std::uint64_t capacity = 1 << 18;       // records, 112 bytes each
    };
    /// `program`: path of knurl-fake-device. Throws if it does not come up within 10 s.
    FakeDevice(const std::string& program, const Settings& settings);
    ~FakeDevice();  // SIGTERM, then waits; the file stays
    FakeDevice(const FakeDevice&) = delete;
    FakeDevice& operator=(const FakeDevice&) = delete;

    pid_t pid() const { return pid_; }
    std::string address() const { return "shared-sim:" + settings_.path; }
    const std::string& path() const { return settings_.path; }
    const Mapping& mapping() const { return *mapping_; }
    std::vector<Record> log() const { return read_log(*mapping_); }
    void control(std::uint64_t bits) { (*mapping_)->control.store(bits, std::memory_order_release); }
    /// Returns when the device has made `steps` more looks, or false after 10 s: uses the device's clock.
    bool wait_steps(std::uint64_t steps) const;

  private:
    Settings settings_;
    pid_t pid_ = -1;
    std::unique_ptr<Mapping> mapping_;
};

/// Scheme "shared-sim". make_safe stores a zero through the shared mapping, which a forked guardian inherits.
Driver shared_sim_driver();

/// Adds it to drivers(), once. A program that only links knurl_shared_sim_enrolled has it without a call.
void enrol();

}  // namespace knurl::drivers::shared_sim

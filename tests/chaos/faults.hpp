#pragma once
// The kinds of fault, and what Knurl promises under each. Each begins and ends with a hand that feels the
// wall.

#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <knurl/client/client.hpp>

#include "../drivers/shared_sim/shared_sim.hpp"
#include "oracle.hpp"
#include "process_knurld.hpp"

namespace knurl::chaos {

/// Thrown when a promise is broken; the runner adds the seed that reproduces it.
struct Broken : std::runtime_error {
    using std::runtime_error::runtime_error;
};
void demand(bool so, const std::string& promise);

/// A device with a process of its own, so that it outlives the servo; a servo; an application that renders a
/// wall; and an observer.
class Stage {
  public:
    explicit Stage(unsigned seed);
    ~Stage();

    /// Restarts device, servo and application, as after construction.
    void begin_anew();
    void start_servo();
    /// `address`: of the servo, for the application; "": the local servo.
    void start_wall(const std::string& address = {});
    /// Waits, on the device's clock, until the hand feels the wall steadily.
    void wait_until_felt();
    /// Waits until the force has been zero for 0.2 s of the device's time; returns since when (device's ns).
    std::int64_t wait_until_zero(std::int64_t from);
    /// Lets the device's clock run.
    void let_pass(double seconds);
    /// The device's time now (CLOCK_MONOTONIC is one for all processes), ns.
    static std::int64_t now();
    DeviceState state() const;
    std::vector<std::filesystem::path> flight_records() const;
    /// Adds to the table at the end: the milliseconds from a fault until what was promised under it.
    void measured(const std::string& promise, double milliseconds);
    void print_measured() const;

    test::Home home;
    std::mt19937 random;
    std::unique_ptr<drivers::shared_sim::FakeDevice> device;
    std::unique_ptr<test::Knurld> knurld;
    std::unique_ptr<test::Program> wall;

  private:
    void clear();
    struct Measured {
        std::string promise;
        std::vector<double> milliseconds;
    };
    std::vector<Measured> measured_;
    mutable std::unique_ptr<Client> watcher_;
    mutable std::unique_ptr<Observer> watch_;
    mutable pid_t watched_ = 0;
};

struct Fault {
    const char* name;
    void (*happen)(Stage&);
};
std::span<const Fault> faults();
std::span<const Fault> network_faults();  // of an application on another host

/// Demands that since `from` the hand has felt the wall without interruption.
void demand_undisturbed(Stage& stage, std::int64_t from, const std::string& by);
/// Demands that there is no force until somebody arms. Then tells the application to arm.
void demand_off_until_armed(Stage& stage, std::int64_t from, const std::string& after);

}  // namespace knurl::chaos

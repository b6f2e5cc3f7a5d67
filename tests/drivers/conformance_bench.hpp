#pragma once
// The far side of each address in the conformance suite: its motors, cable and encoder, so that the suite
// need not trust the driver.

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include <sys/wait.h>

#include <knurl/drivers/sim_device.hpp>

#include "example_device.hpp"
#include "motor_bench.hpp"
#include "shared_sim.hpp"
#include "spacemouse_model.hpp"
#include "vendor_bench.hpp"

namespace knurl::drivers {

/// As it stands: a device without motors, cable or other side.
class Bench {
  public:
    virtual ~Bench() = default;

    virtual bool has_motors() const { return false; }
    /// Its motors still exist when the device is closed.
    virtual bool outlives_its_device() const { return true; }
    virtual bool has_cable() const { return false; }
    virtual bool has_encoder() const { return false; }
    /// A separate I/O thread lies between the cycle and it, which sleeps until the first read. (Where a write
    /// goes straight to the other side, only the caller keeps this order.)
    virtual bool sleeps_until_read() const { return false; }
    /// It is silent while nothing moves, which is no fault.
    virtual bool may_be_silent() const { return false; }

    /// The largest |effort| that reached a motor since the last call, as a share of that motor's limit; the
    /// present one if none did. `device`: null once it is closed.
    virtual double share(const Device* /*device*/) { return 0; }
    /// Total number of effort packets that have reached it.
    virtual std::size_t packets() { return 0; }
    virtual void pull(Device& /*device*/) {}
    virtual void plug_in_again(Device& /*device*/) {}
    /// Stops the other side, if there is one; false: there is none.
    virtual bool freeze(bool /*frozen*/) { return false; }
    /// Turns the first encoder by so many counts.
    virtual void turn(int /*counts*/) {}
    /// Lets the other side's time pass.
    virtual void moment() {}
};

/// The simulated device: all of it is in this process, on the caller's clock.
class SimBench final : public Bench {
  public:
    bool has_motors() const override { return true; }
    bool outlives_its_device() const override { return false; }
    bool has_cable() const override { return true; }
    double share(const Device* device) override {
        const auto& sim = dynamic_cast<const SimDevice&>(*device);
        double largest = 0;
        for (std::size_t i = 0; i < sim.link().effort_limit.size(); ++i)
            largest = std::max(largest, std::abs(sim.state().efforts[i]) / sim.link().effort_limit[i]);
        return largest;
    }
    void pull(Device& device) override {
        auto& sim = dynamic_cast<SimDevice&>(device);
        sim.faults().unplug_at = static_cast<std::int64_t>(sim.state().reads);
    }
    void plug_in_again(Device& device) override {
        auto& sim = dynamic_cast<SimDevice&>(device);
        sim.faults().replug_at = static_cast<std::int64_t>(sim.state().reads);
    }
};

class SliderBench final : public Bench {
  public:
    explicit SliderBench(example::Board& board) : board_(board) {}
    bool has_motors() const override { return true; }
    bool has_cable() const override { return true; }
    bool has_encoder() const override { return true; }
    double share(const Device*) override { return std::abs(board_.milliamps.load()) / 1500.0; }
    void pull(Device&) override { board_.plugged = false; }
    void plug_in_again(Device&) override { board_.plugged = true; }
    void turn(int counts) override { board_.encoder += counts; }

  private:
    example::Board& board_;
};

/// A process of its own, which lives as long as the tests; its log says what reached the motors.
class SharedSimBench final : public Bench {
  public:
    static std::string address() { return process().address(); }

    bool has_motors() const override { return true; }
    bool has_cable() const override { return true; }
    double share(const Device* device) override {
        if (device != nullptr) limits_ = device->link().effort_limit;
        const std::uint64_t written = process().mapping()->records.load(std::memory_order_acquire);
        const shared_sim::Record* log = shared_sim::log_of(&*process().mapping());
        const std::uint64_t first = seen_ < written || written == 0 ? seen_ : written - 1;
        double largest = 0;
        for (std::uint64_t record = first; record < written; ++record)
            for (std::size_t i = 0; i < shared_sim::joints; ++i)
                largest = std::max(largest, std::abs(log[record].effort[i]) / limits_.at(i));
        seen_ = written;
        return largest;
    }
    void pull(Device&) override { obey(shared_sim::control_unplug); }
    void plug_in_again(Device&) override { obey(0); }
    bool freeze(bool frozen) override {
        ::kill(process().pid(), frozen ? SIGSTOP : SIGCONT);
        int status = 0;
        if (frozen) ::waitpid(process().pid(), &status, WUNTRACED);
        return true;
    }
    void moment() override { process().wait_steps(2); }

  private:
    static shared_sim::FakeDevice& process() {
        static constexpr std::uint64_t capacity = 1 << 16;
        static const struct File {
            std::string path = shared_sim::file_in_memory("knurl-conformance", capacity);
            ~File() { std::filesystem::remove(path); }
        } file;
        static shared_sim::FakeDevice device(KNURL_FAKE_DEVICE, {.path = file.path, .capacity = capacity});
        return device;
    }
    static void obey(std::uint64_t control) {
        process().control(control);
        process().wait_steps(2);
    }

    std::uint64_t seen_ = process().mapping()->records.load(std::memory_order_acquire);
    std::vector<double> limits_;
};

/// Behind knurl-device and a counterfeit of its maker's library.
class VendorBench final : public Bench {
  public:
    /// `limit` of each motor, N; `count` of its encoders, m.
    VendorBench(double limit, double count) : limit_(limit) {
        target() = 0;
        device().count = count;
    }
    /// The hardware, which exists as long as the tests.
    static counterfeit::Bench& hardware() {
        static counterfeit::Bench bench;
        return bench;
    }
    bool has_motors() const override { return true; }
    bool has_cable() const override { return true; }
    bool has_encoder() const override { return true; }
    bool sleeps_until_read() const override { return true; }
    std::size_t packets() override { return device().forces.load(); }
    double share(const Device*) override {
        const std::uint64_t written = device().records.load(std::memory_order_acquire);
        double largest = seen_ == written ? device().largest_now() : 0;
        for (; seen_ < written; ++seen_)
            for (const double force : device().log[seen_ % counterfeit::log_size].force)
                largest = std::max(largest, std::abs(force));
        return largest / limit_;
    }
    void pull(Device&) override { device().plugged = 0; }
    void plug_in_again(Device&) override { device().plugged = 1; }
    bool freeze(bool frozen) override {
        const auto pid = static_cast<pid_t>(device().opened_by.load());
        return pid > 0 && ::kill(pid, frozen ? SIGSTOP : SIGCONT) == 0;
    }
    void turn(int counts) override { target() = target() + counts * device().count; }
    void moment() override {
        // A loop of its own; one that is gone, stopped or not yet awake makes none.
        const std::uint64_t before = device().positions.load() + 2;
        for (int looks = 0; device().positions.load() < before && looks < 20; ++looks)
            std::this_thread::sleep_for(std::chrono::microseconds(200));
    }

  private:
    static counterfeit::Device& device() { return hardware().device(); }
    static std::atomic<double>& target() { return device().target[0]; }
    double limit_;
    std::uint64_t seen_ = device().records.load(std::memory_order_acquire);
};

/// A device on the emulated bus, which exists as long as the tests.
class UsbBench : public Bench {
  public:
    /// Everything is plugged in before anything is opened.
    struct Everything {
        usb_emulator::Bus bus;
        std::shared_ptr<usb_emulator::MotorModel> falcon = usb_emulator::falcon_device.make(),
                                                  wooden = usb_emulator::wooden_device.make();
        std::shared_ptr<usb_emulator::SpaceMouseModel> mouse =
            std::make_shared<usb_emulator::SpaceMouseModel>(true);
        Everything() {
            plug_in(bus, usb_emulator::falcon_device, falcon, "1-1");
            plug_in(bus, usb_emulator::wooden_device, wooden, "1-2");
            bus.plug(mouse, {.port = "1-3", .serial = ""});
        }
    };
    static Everything& everything() {
        static Everything all;
        return all;
    }

    UsbBench() { everything(); }
    bool has_cable() const override { return true; }
    bool freeze(bool frozen) override {
        bus().freeze(frozen);
        return true;
    }
    void moment() override {
        const std::uint64_t frame = bus().frame();
        bus().wait(1, [&] { return bus().frame() > frame; });
    }

  protected:
    static usb_emulator::Bus& bus() { return everything().bus; }
};

class SpaceMouseBench final : public UsbBench {
  public:
    bool may_be_silent() const override { return true; }
    void pull(Device&) override { bus().unplug("1-3"); }
    void plug_in_again(Device&) override { bus().plug(everything().mouse, {.port = "1-3", .serial = ""}); }
};

class UsbMotorBench final : public UsbBench {
  public:
    /// `limit` of each motor, in the device's own unit.
    UsbMotorBench(const usb_emulator::MotorDevice& device, std::shared_ptr<usb_emulator::MotorModel> model,
                  std::string port, int limit)
        : device_(device), model_(std::move(model)), port_(std::move(port)), limit_(limit) {
        seen_ = packets();
    }
    bool has_motors() const override { return true; }
    bool has_encoder() const override { return true; }
    bool sleeps_until_read() const override { return true; }
    std::size_t packets() override {
        return bus().locked([&] { return model_->requests().size(); });
    }
    double share(const Device*) override {
        return bus().locked([&] {
            int largest = 0;
            const auto count = [&](const std::array<int, 3>& motors) {
                for (const int motor : motors) largest = std::max(largest, std::abs(motor));
            };
            count(model_->motors());
            for (; seen_ < model_->requests().size(); ++seen_) count(model_->requests()[seen_].motors);
            return largest / static_cast<double>(limit_);
        });
    }
    void pull(Device&) override { bus().unplug(port_); }
    void plug_in_again(Device&) override { plug_in(bus(), device_, model_, port_); }
    void turn(int counts) override {
        bus().locked([&] { model_->slip(0, counts); });
    }

  private:
    const usb_emulator::MotorDevice& device_;
    std::shared_ptr<usb_emulator::MotorModel> model_;
    std::string port_;
    int limit_;
    std::size_t seen_ = 0;
};

}  // namespace knurl::drivers

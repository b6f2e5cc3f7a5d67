#include <cmath>
#include <memory>
#include <stdexcept>

#include <knurl/drivers/sim_device.hpp>
#include <knurl/drivers/sim_profile.hpp>

#include "shared_sim.hpp"

namespace knurl::drivers::shared_sim {

namespace {

class SharedSimDevice final : public Device {
  public:
    explicit SharedSimDevice(const std::string& path)
        : mapping_(path), profile_(sim_profile(mapping_->profile.data())), link_(SimDevice(profile_).link()) {
        count_ = EffortWord::unpack(mapping_->effort.load(std::memory_order_acquire)).count;
        notices_ = mapping_->notice.load(std::memory_order_acquire) >> 1;
    }

    ~SharedSimDevice() override { store({}, Writer::servo); }

    const LinkConfig& link() const noexcept override { return link_; }
    const Mechanism& mechanism() const noexcept override { return *profile_.mechanism; }

    ReadStatus read(Nanoseconds, JointSample& sample) noexcept override {
        const std::uint64_t steps = mapping_->steps.load(std::memory_order_acquire);
        const std::uint64_t word = mapping_->sample.load(std::memory_order_relaxed);
        sample = {};
        for (std::size_t i = 0; i < joints; ++i) {
            sample.position[i] = static_cast<double>(unpack_count(word, i)) * link_.radians_per_count[i];
        }
        sample.calibrated = (word >> 63) != 0;
        if (mapping_->state.load(std::memory_order_acquire) != state_running) {
            return ReadStatus::unplugged;
        }
        const bool fresh = steps != seen_steps_;
        seen_steps_ = steps;
        return fresh ? ReadStatus::ok : ReadStatus::stale;
    }

    bool write(Nanoseconds, const JointEfforts& efforts) noexcept override {
        std::array<std::int16_t, joints> share{};
        for (std::size_t i = 0; i < joints; ++i) {
            const double ratio = efforts[i] / link_.effort_limit[i];
            share[i] = std::isfinite(ratio)
                           ? static_cast<std::int16_t>(std::lround(std::clamp(ratio, -1.0, 1.0) * 32767))
                           : std::int16_t{0};
        }
        store(share, Writer::servo);
        return mapping_->state.load(std::memory_order_acquire) == state_running;
    }

    void notify(Notice notice) noexcept override {
        if (notice == Notice::enabled) {
            return;
        }
        mapping_->notice.store(++notices_ << 1 | std::uint64_t{notice == Notice::claim_active},
                               std::memory_order_release);
    }

    void make_safe() noexcept override { store({}, Writer::guardian); }

  private:
    void store(const std::array<std::int16_t, joints>& share, Writer writer) noexcept {
        if (writer == Writer::guardian) {  // its own count is as old as the fork
            count_ = EffortWord::unpack(mapping_->effort.load(std::memory_order_acquire)).count;
        }
        mapping_->effort.store(EffortWord{.share = share, .count = ++count_, .writer = writer}.pack(),
                               std::memory_order_release);
    }

    Mapping mapping_;
    SimProfile profile_;
    LinkConfig link_;
    std::uint32_t count_ = 0;
    std::uint64_t notices_ = 0;
    std::uint64_t seen_steps_ = 0;
};

}  // namespace

Driver shared_sim_driver() {
    return {.scheme = "shared-sim",
            .help = "FILE of a running knurl-fake-device",
            .open = [](std::string_view what, const OpenOptions&) -> std::unique_ptr<Device> {
                return std::make_unique<SharedSimDevice>(std::string(what));
            }};
}

void enrol() {
    for (const Driver& driver : drivers()) {
        if (driver.scheme == "shared-sim") {
            return;
        }
    }
    drivers().push_back(shared_sim_driver());
}

}  // namespace knurl::drivers::shared_sim

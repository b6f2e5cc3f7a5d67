#include "debounced.hpp"

#include <bit>

namespace knurl::drivers {

namespace {

class Debounced final : public Device {
  public:
    Debounced(std::unique_ptr<Device> device, double hold) : device_(std::move(device)), buttons_(hold) {}

    const LinkConfig& link() const noexcept override { return device_->link(); }
    const Mechanism& mechanism() const noexcept override { return device_->mechanism(); }

    ReadStatus read(Nanoseconds now, JointSample& sample) noexcept override {
        const ReadStatus status = device_->read(now, sample);
        // In a bad sample the buttons are not valid either.
        sample.buttons = status == ReadStatus::ok ? buttons_(now, sample.buttons) : buttons_.told();
        return status;
    }
    bool write(Nanoseconds now, const JointEfforts& efforts) noexcept override {
        return device_->write(now, efforts);
    }
    void notify(Notice notice) noexcept override { device_->notify(notice); }
    void make_safe() noexcept override { device_->make_safe(); }

  private:
    std::unique_ptr<Device> device_;
    Debounce buttons_;
};

}  // namespace

std::uint32_t Debounce::operator()(Nanoseconds now, std::uint32_t raw) noexcept {
    for (std::uint32_t differ = raw ^ told_; differ != 0; differ &= differ - 1) {
        const auto button = static_cast<std::size_t>(std::countr_zero(differ));
        if (now < free_from_[button]) continue;
        told_ ^= std::uint32_t{1} << button;
        free_from_[button] = now + hold_;
    }
    return told_;
}

std::unique_ptr<Device> debounced(std::unique_ptr<Device> device, double hold) {
    if (hold <= 0 || !device->has_buttons()) return device;
    return std::make_unique<Debounced>(std::move(device), hold);
}

}  // namespace knurl::drivers

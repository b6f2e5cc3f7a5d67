#pragma once
// A Polhem controller as USB sees it: RawHID reports of 64 bytes, motors behind a watchdog.

#include <algorithm>
#include <array>
#include <cerrno>

#include "model.hpp"

namespace knurl::drivers::usb_emulator {

class WoodenModel final : public Model {
  public:
    static constexpr std::uint64_t watchdog_frames = 500;

    WoodenModel() {
        identity_ = {.vendor = 0x16c0,
                     .product = 0x0486,
                     .name = "Teensyduino RawHID",
                     .interface_class = 3,
                     .interrupt_endpoints = true,
                     .endpoints = {0x83, 0x04},
                     .kernel_driver = "usbhid"};
    }

    const Identity& identity() const override { return identity_; }
    int control(const Setup&, std::span<std::uint8_t>) override { return -EPIPE; }
    int out(std::uint8_t, std::span<const std::uint8_t> packet) override {
        if (packet.size() != 64) return -EPIPE;
        for (std::size_t i = 0; i < 3; ++i)
            milliamperes_[i] = static_cast<std::int16_t>(packet[2 * i] | packet[2 * i + 1] << 8);
        largest_ = std::max(
            {largest_, std::abs(milliamperes_[0]), std::abs(milliamperes_[1]), std::abs(milliamperes_[2])});
        last_heard_ = frame_;
        ++reports_heard;
        return 64;
    }
    int in(std::uint8_t, std::span<std::uint8_t> room) override {
        if (silent || told_ == frame_) return nak;  // a report a frame
        told_ = frame_;
        std::fill(room.begin(), room.end(), std::uint8_t{0});
        for (std::size_t i = 0; i < counts.size(); ++i) {
            room[2 * i] = static_cast<std::uint8_t>(counts[i] & 0xff);
            room[2 * i + 1] = static_cast<std::uint8_t>(counts[i] >> 8 & 0xff);
        }
        const bool cut = short_reports > 0;
        short_reports -= cut ? 1 : 0;
        return cut ? 5 : static_cast<int>(std::min<std::size_t>(room.size(), 64));
    }
    void frame(std::uint64_t number) override {
        frame_ = number;
        if (number - last_heard_ < watchdog_frames) return;
        tripped_ = tripped_ || milliamperes_ != std::array<int, 3>{};
        milliamperes_ = {};
    }
    void power_on() override {
        milliamperes_ = {};
        counts = {};
    }

    std::array<int, 6> counts = {};
    bool silent = false;
    int short_reports = 0;
    std::uint64_t reports_heard = 0;
    const std::array<int, 3>& milliamperes() const { return milliamperes_; }
    int largest() const { return largest_; }
    bool watchdog_tripped() const { return tripped_; }

  private:
    Identity identity_;
    std::array<int, 3> milliamperes_ = {};
    int largest_ = 0;
    bool tripped_ = false;
    std::uint64_t frame_ = 0, last_heard_ = 0, told_ = 0;
};

}  // namespace knurl::drivers::usb_emulator

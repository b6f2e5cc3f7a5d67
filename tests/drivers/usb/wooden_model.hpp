#pragma once
// A Polhem controller as USB sees it: RawHID reports of 64 bytes, one a frame each way (endpoints of an
// interval of 1 ms), motors behind a watchdog.

#include <algorithm>
#include <array>
#include <cerrno>
#include <random>

#include "motor_model.hpp"

namespace knurl::drivers::usb_emulator {

class WoodenModel final : public MotorModel {
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
        if (faults.stuck || heard_ == frame_) return nak;
        MotorRequest request{.frame = frame_};
        for (std::size_t i = 0; i < 3; ++i)
            request.motors[i] = static_cast<std::int16_t>(packet[2 * i] | packet[2 * i + 1] << 8);
        request.info = packet[6];
        obey(request);
        heard_ = frame_;
        return 64;
    }
    int in(std::uint8_t, std::span<std::uint8_t> room) override {
        if (faults.silent || told_ == frame_) return nak;
        told_ = frame_;
        if (faults.garbage_replies > 0) {
            --faults.garbage_replies;
            for (std::uint8_t& byte : room) byte = static_cast<std::uint8_t>(noise_());
            return 64;
        }
        std::fill(room.begin(), room.end(), std::uint8_t{0});
        for (std::size_t i = 0; i < counts.size(); ++i) {
            room[2 * i] = static_cast<std::uint8_t>(counts[i] & 0xff);
            room[2 * i + 1] = static_cast<std::uint8_t>(counts[i] >> 8 & 0xff);
        }
        const bool cut = faults.short_packets > 0;
        faults.short_packets -= cut ? 1 : 0;
        return cut ? 5 : static_cast<int>(std::min<std::size_t>(room.size(), 64));
    }
    void frame(std::uint64_t number) override {
        frame_ = number;
        if (number - heard_ < watchdog_frames) return;
        if (motors_ != std::array<int, 3>{}) tripped_at_ = number;
        motors_ = {};
    }
    void power_on() override {
        motors_ = {};
        counts = {};
    }
    void slip(std::size_t axis, int by) override { counts[axis] += by; }

    std::array<int, 6> counts = {};  // motors() are mA
    /// When its watchdog last switched off motors that pushed, frame; 0: never.
    std::uint64_t tripped_at() const { return tripped_at_; }

  private:
    Identity identity_;
    std::uint64_t frame_ = 0, heard_ = 0, told_ = 0, tripped_at_ = 0;
    std::mt19937 noise_{1};
};

}  // namespace knurl::drivers::usb_emulator

#pragma once
// A SpaceMouse on USB: it sends reports only while it is touched.

#include <algorithm>
#include <cerrno>
#include <deque>

#include "model.hpp"

namespace knurl::drivers::usb_emulator {

class SpaceMouseModel final : public Model {
  public:
    /// `all_in_one`: translation and rotation in one report of 13 bytes, as the Pro Wireless does.
    explicit SpaceMouseModel(bool all_in_one) : all_in_one_(all_in_one) {
        identity_ = {.vendor = 0x256f,
                     .product = 0xc635,
                     .name = "SpaceMouse Compact",
                     .interface_class = 3,
                     .interrupt_endpoints = true,
                     .endpoints = {0x81},
                     .kernel_driver = "usbhid"};
    }

    const Identity& identity() const override { return identity_; }
    int control(const Setup&, std::span<std::uint8_t>) override { return -EPIPE; }
    int out(std::uint8_t, std::span<const std::uint8_t>) override { return -EPIPE; }
    int in(std::uint8_t, std::span<std::uint8_t> room) override {
        if (reports_.empty()) return nak;
        const std::vector<std::uint8_t> report = reports_.front();
        reports_.pop_front();
        std::copy(report.begin(), report.end(), room.begin());
        return static_cast<int>(report.size());
    }
    void frame(std::uint64_t) override {}
    void power_on() override { reports_.clear(); }

    /// Deflections, x right, y towards the user, z down.
    void push(const std::array<int, 3>& translation, const std::array<int, 3>& rotation) {
        std::vector<std::uint8_t> report = {1};
        add(report, translation);
        if (!all_in_one_) {
            reports_.push_back(report);
            report = {2};
        }
        add(report, rotation);
        reports_.push_back(report);
    }
    void press(std::uint8_t buttons) { reports_.push_back({3, buttons, 0}); }
    void send(std::vector<std::uint8_t> report) { reports_.push_back(std::move(report)); }

  private:
    static void add(std::vector<std::uint8_t>& report, const std::array<int, 3>& values) {
        for (const int value : values) {
            report.push_back(static_cast<std::uint8_t>(value & 0xff));
            report.push_back(static_cast<std::uint8_t>(value >> 8 & 0xff));
        }
    }

    Identity identity_;
    bool all_in_one_;
    std::deque<std::vector<std::uint8_t>> reports_;
};

}  // namespace knurl::drivers::usb_emulator

#pragma once
// A Novint Falcon on USB: FTDI chip, a DSP with a boot ROM, the firmware's protocol, three legs in a hand.
// Written only from the protocol's description, without code from the driver, so that the two agree by
// understanding the same text.

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <vector>

#include "motor_model.hpp"

namespace knurl::drivers::usb_emulator {

/// The faults of its chip and its boot; MotorFaults has the others. A short packet ends after the chip's
/// first status byte.
struct FalconFaults {
    int fragment = 62;     // payload bytes of a packet at most
    int wrong_echoes = 0;  // so many bytes of the boot loader are echoed wrongly, each at `wrong_echo_at`
    std::size_t wrong_echo_at = 0;
    int deaf_loads = 0;         // so many images load and then do not run
    bool leading_zero = false;  // a 00 before the ROM's answer, as real ones have it
};

class Falcon final : public MotorModel {
  public:
    static constexpr double counts_per_radian = 1280 * (0.110 / 0.01425) / (2 * 3.14159265358979323846);
    static constexpr double angle_at_zero = 35 * 3.14159265358979323846 / 180;
    static constexpr int info_homing = 1;

    /// `firmware_kept`: the firmware survives power_on, as when only the host's program restarts.
    explicit Falcon(bool firmware_kept = false, bool homed = true);

    const Identity& identity() const override { return identity_; }
    int control(const Setup& setup, std::span<std::uint8_t> data) override;
    int out(std::uint8_t endpoint, std::span<const std::uint8_t> packet) override;
    int in(std::uint8_t endpoint, std::span<std::uint8_t> room) override;
    void frame(std::uint64_t number) override;
    void power_on() override;

    FalconFaults chip;

    /// The hand's wanted legs, rad, at t s of the bus's clock. Rigid unless compliant is set: then a spring
    /// and damper pull each leg there against the motors (0.055 kg at a lever of 60 mm).
    std::function<std::array<double, 3>(double t)> hand;
    bool compliant = false;

    const std::array<double, 3>& legs() const { return legs_; }
    bool running() const { return mode_ == Mode::running; }
    int boots() const { return boots_; }
    bool homing() const { return homing_; }
    int leds() const { return leds_; }
    const std::vector<std::uint16_t>& program() const { return program_; }
    bool event_character() const { return event_character_; }
    void set_buttons(int mask) { buttons_ = mask; }
    /// The user has pulled it out and pushed it in: its encoders count from the right place.
    void home() { homed_ = 7; }
    /// Where its legs are now (rad), at rest.
    void place(const std::array<double, 3>& legs) { legs_ = legs; }
    void lose_homing() { homed_ = 0; }
    /// For good.
    void slip(std::size_t leg, int counts) override { slip_[leg] += counts; }

  private:
    enum class Mode { off, monitor, loader, running };

    void hear(std::uint8_t byte);
    void hear_monitor(std::uint8_t byte);
    void hear_loader(std::uint8_t byte);
    void hear_firmware(std::uint8_t byte);
    void load_word(std::uint16_t word);
    void answer();
    void say(std::uint8_t byte) { uart_.push_back(byte); }

    Identity identity_;
    bool firmware_kept_;
    Mode mode_ = Mode::off;
    // FTDI
    int baud_ = 0, latency_ = 16;
    bool dtr_ = false, rts_ = false, event_character_ = false, flush_ = false;
    int idle_frames_ = 0;
    std::deque<std::uint8_t> uart_;  // towards the host
    // DSP
    std::vector<std::uint8_t> heard_;
    std::size_t loaded_bytes_ = 0;
    std::vector<std::uint16_t> words_, program_;
    std::size_t block_left_ = 0;
    int block_header_ = 0;
    bool header_done_ = false;
    int boots_ = 0;
    // The device
    std::array<int, 3> slip_ = {};
    std::array<double, 3> legs_ = {}, rates_ = {};
    int homed_ = 0, leds_ = 0, buttons_ = 0;
    bool homing_ = false;
    std::uint64_t frame_ = 0;
    std::mt19937 noise_{1};
};

}  // namespace knurl::drivers::usb_emulator

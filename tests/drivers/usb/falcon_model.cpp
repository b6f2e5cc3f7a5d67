#include "falcon_model.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace knurl::drivers::usb_emulator {

namespace {

constexpr std::uint8_t vendor_out = 0x40;
constexpr int baud_9600 = 0x4138, baud_boot = 0x15, baud_run = 0x2;
constexpr int info_leds = 0x02 | 0x04 | 0x08;
constexpr std::size_t frame_bytes = 16;
constexpr std::size_t header_words = 1 + 8 + 2;  // key, reserved, entry

int nibbles(const std::uint8_t* bytes) {
    unsigned value = 0;
    for (unsigned i = 0; i < 4; ++i) value |= static_cast<unsigned>(bytes[i] - 0x41) << (4 * i);
    return static_cast<std::int16_t>(value);
}

}  // namespace

Falcon::Falcon(bool firmware_kept, bool homed) : firmware_kept_(firmware_kept), homed_(homed ? 7 : 0) {
    identity_ = {.vendor = 0x0403,
                 .product = 0xcb48,
                 .name = "FALCON HAPTIC",
                 .endpoints = {0x81, 0x02},
                 .kernel_driver = "ftdi_sio"};
    hand = [](double) { return std::array<double, 3>{0.6, 0.6, 0.6}; };
    legs_ = hand(0);
}

void Falcon::power_on() {
    mode_ = firmware_kept_ ? Mode::running : Mode::off;
    baud_ = 0;
    latency_ = 16;
    dtr_ = rts_ = event_character_ = false;
    uart_.clear();
    heard_.clear();
    motors_ = {};
}

int Falcon::control(const Setup& setup, std::span<std::uint8_t>) {
    if (setup.type != vendor_out || setup.length != 0) return -EPIPE;
    switch (setup.request) {
        case 0:
            if (setup.value <= 1) uart_.clear();
            return 0;
        case 1: {
            const bool was = dtr_;
            if ((setup.value & 0x0100) != 0) dtr_ = (setup.value & 1) != 0;
            if ((setup.value & 0x0200) != 0) rts_ = (setup.value & 2) != 0;
            if (!was && dtr_ && !rts_) {  // the DSP's reset line goes up: its ROM begins
                mode_ = Mode::monitor;
                motors_ = {};
                heard_.clear();
            }
            return 0;
        }
        case 2:
        case 4:
            return 0;
        case 3:
            baud_ = setup.value;
            return 0;
        case 6:
            event_character_ = setup.value == 0x013E;
            return 0;
        case 9:
            latency_ = std::max<int>(setup.value, 1);
            return 0;
        default:
            return -EPIPE;
    }
}

int Falcon::out(std::uint8_t, std::span<const std::uint8_t> packet) {
    if (faults.stuck) return nak;
    for (const std::uint8_t byte : packet) hear(byte);
    return static_cast<int>(packet.size());
}

/// Two status bytes, then what the UART has: full packets at once, less at the latency timer or after the
/// event character (FTDI AN232B-04).
int Falcon::in(std::uint8_t, std::span<std::uint8_t> room) {
    const std::size_t most =
        std::min<std::size_t>({room.size() - 2, 62, static_cast<std::size_t>(chip.fragment)});
    if (uart_.size() < most && !flush_ && idle_frames_ < latency_) return nak;
    idle_frames_ = 0;
    room[0] = 0x01;
    if (faults.short_packets > 0) {
        --faults.short_packets;
        for (std::size_t i = 0; i < most && !uart_.empty(); ++i) uart_.pop_front();
        return 1;
    }
    room[1] = 0x60;
    std::size_t n = 0;
    for (; n < most && !uart_.empty(); ++n) {
        room[2 + n] = uart_.front();
        uart_.pop_front();
    }
    flush_ = flush_ && !uart_.empty();
    return static_cast<int>(n + 2);
}

void Falcon::hear(std::uint8_t byte) {
    switch (mode_) {
        case Mode::monitor:
            return hear_monitor(byte);
        case Mode::loader:
            return hear_loader(byte);
        case Mode::running:
            return hear_firmware(byte);
        case Mode::off:
            return;
    }
}

void Falcon::hear_monitor(std::uint8_t byte) {
    if (faults.silent) return;
    if (baud_ == baud_boot) {
        if (byte != 0x41 || dtr_) return;
        say(0x41);
        mode_ = Mode::loader;
        loaded_bytes_ = 0;
        words_.clear();
        program_.clear();
        header_done_ = false;
        block_header_ = 0;
        block_left_ = 0;
        heard_.clear();
        return;
    }
    if (baud_ != baud_9600) return;
    heard_.push_back(byte);
    if (heard_.size() < 3) return;
    if (heard_ == std::vector<std::uint8_t>{0x0A, 0x43, 0x0D}) {
        if (chip.leading_zero) say(0);
        for (const int answer : {0x0A, 0x44, 0x2C, 0x0D}) say(static_cast<std::uint8_t>(answer));
    }
    heard_.clear();
}

void Falcon::hear_loader(std::uint8_t byte) {
    if (baud_ != baud_boot) return;
    const bool wrong = chip.wrong_echoes > 0 && loaded_bytes_ == chip.wrong_echo_at;
    if (wrong) --chip.wrong_echoes;
    say(wrong ? static_cast<std::uint8_t>(byte ^ 0x10) : byte);
    ++loaded_bytes_;
    heard_.push_back(byte);
    if (heard_.size() < 2) return;
    load_word(static_cast<std::uint16_t>(heard_[0] | heard_[1] << 8));
    heard_.clear();
}

// TI's C28x ROM, SCI boot: key, eight reserved words, entry (high, low), blocks of size, address (high, low),
// data.
void Falcon::load_word(std::uint16_t word) {
    if (!header_done_) {
        words_.push_back(word);
        if (words_[0] != 0x08AA) mode_ = Mode::off;  // the ROM jumps to flash: nothing is there
        header_done_ = words_.size() == header_words;
        return;
    }
    if (block_left_ > 0) {
        program_.push_back(word);
        --block_left_;
        return;
    }
    if (block_header_ == 0) {
        words_.assign(1, word);
        block_header_ = word == 0 ? 0 : 2;
        if (word != 0) return;
        ++boots_;
        mode_ = chip.deaf_loads > 0 ? Mode::off : Mode::running;
        chip.deaf_loads = std::max(chip.deaf_loads - 1, 0);
        return;
    }
    if (--block_header_ == 0) block_left_ = words_[0];
}

void Falcon::hear_firmware(std::uint8_t byte) {
    if (baud_ != baud_run) return;
    if (heard_.empty() && byte != '<') return;
    heard_.push_back(byte);
    if (heard_.size() < frame_bytes) return;
    if (byte == '>') answer();
    heard_.clear();
}

void Falcon::answer() {
    MotorRequest request{.frame = frame_, .info = heard_[13] - 0x41};
    for (std::size_t leg = 0; leg < 3; ++leg) request.motors[leg] = nibbles(heard_.data() + 1 + 4 * leg);
    homing_ = (request.info & info_homing) != 0;
    leds_ = request.info & info_leds;
    obey(request);
    if (faults.silent) return;
    flush_ = flush_ || event_character_;
    if (faults.garbage_replies > 0) {
        --faults.garbage_replies;
        for (std::size_t i = 0; i < frame_bytes; ++i) say(static_cast<std::uint8_t>(noise_() % 0x3c));
        return;
    }
    say('<');
    for (std::size_t leg = 0; leg < 3; ++leg) {
        const double counts = (legs_[leg] - angle_at_zero) * counts_per_radian;
        const auto shown =
            static_cast<unsigned>(std::lround(counts) + slip_[leg] + ((homed_ >> leg & 1) != 0 ? 0 : 700));
        for (unsigned nibble = 0; nibble < 4; ++nibble)
            say(static_cast<std::uint8_t>(0x41 + (shown >> (4 * nibble) & 0xfU)));
    }
    const int info = buttons_ | homed_ << 4;
    say(static_cast<std::uint8_t>(0x41 + info));
    say(0x41);
    say('>');
}

void Falcon::frame(std::uint64_t number) {
    frame_ = number;
    ++idle_frames_;
    if (!hand) return;
    const std::array<double, 3> wanted = hand(static_cast<double>(number) * 1e-3);
    if (!compliant) {
        legs_ = wanted;
        return;
    }
    constexpr double lever = 0.06, inertia = 0.055 * lever * lever;               // kg m^2
    constexpr double spring = 200 * lever * lever, damper = 3.5 * lever * lever;  // hand and device
    constexpr int steps = 10;
    for (int step = 0; step < steps; ++step)
        for (std::size_t leg = 0; leg < 3; ++leg) {
            const double torque =
                -motors_[leg] / 10000.0 + spring * (wanted[leg] - legs_[leg]) - damper * rates_[leg];
            rates_[leg] += torque / inertia * 1e-3 / steps;
            legs_[leg] += rates_[leg] * 1e-3 / steps;
        }
}

}  // namespace knurl::drivers::usb_emulator

#include "falcon/protocol.hpp"

#include <algorithm>
#include <chrono>

#include "falcon/boot.hpp"

namespace knurl::drivers::falcon {

namespace {

constexpr std::size_t packet_status_bytes = 2;  // from the chip, at the front of every incoming packet
constexpr int asks_running = 3;                 // attempts with a firmware that may be running already
constexpr int asks_booted = 20;                 // attempts with a firmware that has just been loaded
constexpr std::chrono::milliseconds answer_patience{20};

}  // namespace

/// Asks repeatedly until the firmware answers.
bool Protocol::run(usb::Session& session, usb::Reading& first, int attempts) {
    set_up_for_running(session, event_character_);
    reader_.clear();
    heard_ = homed_ = false;
    for (int i = 0; i < attempts; ++i) {
        std::array<std::uint8_t, usb::packet_bytes> packet{};
        const std::size_t length = pack({}, packet);
        if (session.write(std::span(packet.data(), length), answer_patience) != length) return false;
        const auto end = std::chrono::steady_clock::now() + answer_patience;
        while (std::chrono::steady_clock::now() < end) {
            const std::size_t n = session.read(packet, answer_patience);
            if (hear(std::span(packet.data(), n), first).reading) return true;
        }
    }
    return false;
}

void Protocol::start(usb::Session& session, usb::Reading& first) {
    if (run(session, first, asks_running)) return;
    const std::string who = "the Falcon " + session.info().address();
    if (!firmware_)
        throw std::runtime_error(who + " runs no firmware; name the file that its maker supplies: " +
                                 session.info().address() + ",firmware=FILE");
    std::string why;
    for (int attempt = 0; attempt < boot_attempts; ++attempt) {
        why = boot(session, *firmware_);
        if (why == rom_is_silent) break;  // further attempts are useless
        if (!why.empty()) continue;
        if (run(session, first, asks_booted)) return;
        why = "the firmware was loaded (sha256 " + firmware_->sha256 + ") and does not answer";
    }
    throw std::runtime_error(who + " does not boot: " + why +
                             "; unplug it, check its power supply, plug it in again");
}

std::size_t Protocol::pack(const usb::Orders& orders,
                           std::span<std::uint8_t, usb::packet_bytes> packet) noexcept {
    Command command{.info = static_cast<std::uint8_t>(orders.flags & (info_green | info_blue | info_red))};
    // Before homing the legs' positions are unknown, so no effort is sent.
    if (homed_) std::copy_n(orders.efforts.begin(), 3, command.motors.begin());
    if (heard_ && !homed_) command.info |= info_homing;
    encode(command, packet.first<message_bytes>());
    return message_bytes;
}

usb::Heard Protocol::hear(std::span<const std::uint8_t> packet, usb::Reading& reading) noexcept {
    if (packet.size() < packet_status_bytes) return {.garbage = 1};
    usb::Heard heard;
    const bool garbage = reader_.add(packet.subspan(packet_status_bytes), [&](const State& state) {
        heard.reading = heard_ = true;
        homed_ = state.homed == all_homed;
        reading.calibrated = homed_;
        reading.buttons = state.buttons;
        std::ranges::copy(state.encoders, reading.counts.begin());
    });
    heard.garbage = garbage ? 1 : 0;
    return heard;
}

}  // namespace knurl::drivers::falcon

#include "falcon/boot.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <vector>

namespace knurl::drivers::falcon {

namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint8_t vendor_out = 0x40;
constexpr std::uint16_t dtr_high = 0x0101, dtr_low = 0x0100, rts_low = 0x0200;
constexpr std::uint16_t baud_9600 = 0x4138, baud_boot = 0x15, baud_run = 0x2;
constexpr std::uint16_t eight_n_one = 8;
constexpr std::uint16_t event_on_end = 0x013E;  // '>', enabled: a packet with this end is flushed at once
constexpr std::size_t status_bytes = 2;         // at the front of every incoming packet
constexpr std::size_t chunk = 62;               // its echo fits into one packet with the status bytes
constexpr int hellos = 100;
constexpr milliseconds hello_patience{32};  // two latency timers of 16 ms
constexpr milliseconds echo_patience{500};  // 62 bytes take 5 ms at 142 857 baud

/// The chip's bytes without its status; at most `most`, as many as arrive in time.
std::vector<std::uint8_t> hear(usb::Session& session, std::size_t most, milliseconds patience) {
    std::vector<std::uint8_t> heard;
    const Clock::time_point end = Clock::now() + patience;
    while (heard.size() < most) {
        const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
        if (left.count() <= 0) break;
        std::array<std::uint8_t, 64> packet{};
        const std::size_t n = session.read(packet, left);
        for (std::size_t i = status_bytes; i < n; ++i) heard.push_back(packet[i]);
    }
    return heard;
}

bool say(usb::Session& session, std::span<const std::uint8_t> bytes) {
    return session.write(bytes, echo_patience) == bytes.size();
}

/// True: the ROM's monitor answers.
bool greet(usb::Session& session) {
    constexpr std::array<std::uint8_t, 3> hello = {0x0A, 0x43, 0x0D};
    constexpr std::array<std::uint8_t, 4> answer = {0x0A, 0x44, 0x2C, 0x0D};
    for (int i = 0; i < hellos; ++i) {
        if (!say(session, hello)) return false;
        std::vector<std::uint8_t> heard = hear(session, answer.size(), hello_patience);
        // A zero or the rest of an earlier answer may come first.
        for (std::size_t extra = 0; extra <= answer.size(); ++extra) {
            if (std::search(heard.begin(), heard.end(), answer.begin(), answer.end()) != heard.end())
                return true;
            if (heard.size() < answer.size()) break;
            std::ranges::copy(hear(session, 1, hello_patience), std::back_inserter(heard));
        }
    }
    return false;
}

}  // namespace

void ftdi(usb::Session& session, Ftdi request, std::uint16_t value) {
    session.control(vendor_out, static_cast<std::uint8_t>(request), value, 0);
}

std::string boot(usb::Session& session, const Firmware& firmware) {
    ftdi(session, Ftdi::reset, ftdi_purge_in);
    ftdi(session, Ftdi::reset, ftdi_purge_out);
    ftdi(session, Ftdi::latency, 16);
    ftdi(session, Ftdi::baud, baud_9600);
    ftdi(session, Ftdi::data, eight_n_one);
    ftdi(session, Ftdi::flow, 0);
    ftdi(session, Ftdi::modem, rts_low);
    ftdi(session, Ftdi::modem, dtr_low);
    ftdi(session, Ftdi::modem, dtr_high);
    if (!greet(session)) return rom_is_silent;

    ftdi(session, Ftdi::modem, dtr_low);
    ftdi(session, Ftdi::baud, baud_boot);
    constexpr std::array<std::uint8_t, 1> letter = {0x41};  // from which the ROM measures the baud rate
    if (!say(session, letter) || hear(session, 1, echo_patience) != std::vector<std::uint8_t>{letter[0]})
        return "its boot loader does not answer";

    for (std::size_t at = 0; at < firmware.stream.size(); at += chunk) {
        const auto piece =
            std::span(firmware.stream).subspan(at, std::min(chunk, firmware.stream.size() - at));
        if (!say(session, piece)) return "it takes no more at byte " + std::to_string(at);
        const std::vector<std::uint8_t> echo = hear(session, piece.size(), echo_patience);
        const auto differs = std::ranges::mismatch(echo, piece).in1 - echo.begin();
        const std::size_t byte = at + static_cast<std::size_t>(differs);
        if (static_cast<std::size_t>(differs) < echo.size())
            return "byte " + std::to_string(byte) + " came back altered";
        if (echo.size() < piece.size()) return "byte " + std::to_string(byte) + " did not come back";
    }
    return "";
}

void set_up_for_running(usb::Session& session, bool event_character) {
    ftdi(session, Ftdi::latency, 1);
    ftdi(session, Ftdi::baud, baud_run);
    ftdi(session, Ftdi::data, eight_n_one);
    ftdi(session, Ftdi::flow, 0);
    ftdi(session, Ftdi::event, event_character ? event_on_end : 0);
    ftdi(session, Ftdi::reset, ftdi_purge_in);
    ftdi(session, Ftdi::reset, ftdi_purge_out);
}

}  // namespace knurl::drivers::falcon

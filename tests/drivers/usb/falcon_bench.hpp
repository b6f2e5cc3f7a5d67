#pragma once
// Shared by the tests with a Falcon: a bus, an invented firmware, a hand that moves through the delta's own
// inverse.

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/drivers/delta.hpp>
#include <knurl/drivers/registry.hpp>
#include <knurl/drivers/usb_list.hpp>

#include "bus.hpp"
#include "falcon_model.hpp"

namespace knurl::drivers::usb_emulator {

inline constexpr Nanoseconds millisecond = 1'000'000;

/// A stream that the C28x ROM would load: two blocks of noise.
inline std::vector<std::uint8_t> made_up_firmware(std::size_t words = 400) {
    std::vector<std::uint8_t> bytes;
    const auto word = [&](unsigned value) {
        bytes.push_back(static_cast<std::uint8_t>(value & 0xff));
        bytes.push_back(static_cast<std::uint8_t>(value >> 8));
    };
    word(0x08AA);
    for (int i = 0; i < 8; ++i) word(0);
    word(0x003F);
    word(0x8002);
    for (const std::size_t size : {words / 4, words - words / 4}) {
        word(static_cast<unsigned>(size));
        word(0x003F);
        word(0x8000);
        for (std::size_t i = 0; i < size; ++i) word(static_cast<unsigned>(i * 40503 + 7) & 0xffff);
    }
    word(0);
    return bytes;
}

/// A file that is removed at the end.
class TemporaryFile {
  public:
    explicit TemporaryFile(const std::vector<std::uint8_t>& bytes)
        : path_((std::filesystem::temp_directory_path() /
                 ("knurl-usb-" + std::to_string(getpid()) + "-" + std::to_string(count_++)))
                    .string()) {
        std::ofstream(path_, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string& path() const { return path_; }

  private:
    static inline int count_ = 0;
    std::string path_;
};

/// Legs of a hand that is at `position` (m, device frame).
inline std::array<double, 3> legs_at(const Eigen::Vector3d& position) {
    static const Delta delta(falcon_in_device_frame());
    std::array<double, 3> legs{};
    if (!delta.inverse(position, legs)) ADD_FAILURE() << "no legs reach " << position.transpose();
    return legs;
}

/// A hand on a circle of 20 mm about the workspace's centre, 1 Hz.
inline Eigen::Vector3d circling(double t) {
    const double angle = 2 * std::numbers::pi * t;
    return {0, 0.02 * std::cos(angle), 0.02 * std::sin(angle)};
}

inline std::shared_ptr<Falcon> falcon_at_centre(bool running = true, bool homed = true) {
    auto falcon = std::make_shared<Falcon>(running, homed);
    const std::array<double, 3> legs = legs_at(Eigen::Vector3d::Zero());
    falcon->hand = [legs](double) { return legs; };
    falcon->place(legs);
    return falcon;
}

/// A servo's cycle, at the rate of the bus's frames: reads, lets `efforts` decide, writes.
template <class Efforts>
void cycles(Bus& bus, Device& device, int n, Efforts&& efforts) {
    static Nanoseconds now = 0;  // of the servo's clock, which never goes back
    for (int i = 0; i < n; ++i) {
        JointSample sample;
        const ReadStatus status = device.read(now += millisecond, sample);
        device.write(now, efforts(status, sample));
        const std::uint64_t frame = bus.frame();
        bus.wait(1, [&] { return bus.frame() > frame; });
    }
}

}  // namespace knurl::drivers::usb_emulator

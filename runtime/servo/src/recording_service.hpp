#pragma once
// Who records a device: the broker's side of its input log. The first recorder creates the input log. It
// stays as long as the servo lives, so nobody has to wait for the servo's thread.

#include <cstdint>
#include <exception>
#include <memory>

#include <fmt/format.h>

#include <knurl/servo/claim_table.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::servo {

class RecordingService {
  public:
    /// One more recorder. Throws RequestRefused.
    protocol::Recording begin(const HostedDevice& device) {
        try {
            if (!input_log_) {
                memory_ = shm::Segment::create("knurl-input-log", input_log_bytes);
                input_log_ = std::make_unique<InputLog>(memory_.data(), device.input_log);
                memory_.seal_against_new_writers();
                memory_.hold_pages();
            }
        } catch (const std::exception& error) {
            throw RequestRefused(
                fmt::format("record: device \"{}\": the servo has no memory left for it ({})", device.name,
                            error.what()));
        }
        const std::uint64_t from = InputLog::written(memory_.data());
        if (!device.servo.record(input_log_.get()))
            throw RequestRefused(
                fmt::format("record: device \"{}\" is busy with claims; try again", device.name));
        ++recorders_;
        return {.from = from};
    }
    /// One recorder less. If the mailbox is full, the servo continues to write, which is harmless.
    void end(const HostedDevice& device) noexcept {
        if (--recorders_ == 0) device.servo.record(nullptr);
    }
    int fd() const { return memory_.fd(); }

  private:
    shm::Segment memory_;
    std::unique_ptr<InputLog> input_log_;
    std::uint32_t recorders_ = 0;
};

}  // namespace knurl::servo

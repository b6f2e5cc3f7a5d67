#pragma once
// Who watches the scenes of a device: the broker's side of its scene log. As with recordings, the first watcher creates
// the log, which stays as long as the servo lives, so nobody has to wait for the servo's thread.

#include <cstdint>
#include <exception>
#include <memory>

#include <fmt/format.h>

#include <knurl/servo/claim_table.hpp>
#include <knurl/servo/scene_log.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::servo {

class SceneService {
  public:
    /// One more watcher, or one that wants all of it anew. Throws RequestRefused.
    protocol::Watching begin(const HostedDevice& device, bool another) {
        try {
            if (!log_) {
                memory_ = shm::Segment::create("knurl-scene-log", scene_log_bytes);
                log_ = std::make_unique<RecordLog>(memory_.data(), scene_log_slots);
                memory_.seal_against_new_writers();
                memory_.hold_pages();
            }
        } catch (const std::exception& error) {
            throw RequestRefused(fmt::format("watch: device \"{}\": the servo has no memory left for it ({})",
                                             device.name, error.what()));
        }
        protocol::Watching watching;
        watching.from = RecordLog::written(memory_.data(), scene_log_slots);
        if (!device.servo.show_scenes(log_.get()))
            throw RequestRefused(
                fmt::format("watch: device \"{}\" is busy with claims; try again", device.name));
        if (another) ++watchers_;
        return watching;
    }
    /// One watcher less. If the mailbox is full, the servo continues to write, which is harmless.
    void end(const HostedDevice& device) noexcept {
        if (--watchers_ == 0) device.servo.show_scenes(nullptr);
    }
    int fd() const { return memory_.fd(); }

  private:
    shm::Segment memory_;
    std::unique_ptr<RecordLog> log_;
    std::uint32_t watchers_ = 0;
};

}  // namespace knurl::servo

#pragma once
// The scenes of one device, as its servo shows them (knurl/servo/scene_log.hpp): a connection to the broker, and the log's
// memory, mapped read-only.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <knurl/gateway/live_view.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/servo/scene_log.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::gateway {

class SceneWatch {
  public:
    /// Throws std::runtime_error: no servo answers in time, or it is of another build.
    SceneWatch(const protocol::ServoAddress& servo, std::uint32_t device,
               std::chrono::milliseconds answer_time);

    /// Takes what is new into `device`. Waits for nothing. False: the servo has hung up.
    bool look(SeenDevice& device);

  private:
    using Bytes = std::span<const std::byte>;
    void ask(std::chrono::milliseconds answer_time);
    void take(const servo::LogRecord& record, SeenDevice& device);
    void take_claim(SeenDevice& device, std::uint64_t number, Bytes rest);
    void take_felt(SeenClaim& claim, Bytes rest);
    static void forget(SeenDevice& device, std::uint64_t claim, std::optional<std::uint32_t> slot);
    /// Reads the servo's messages. False: it has hung up.
    bool listen(SeenDevice& device);
    void ask_for_assets(SeenDevice& device);

    std::uint32_t number_;  // of the device
    shm::UniqueFd connection_;
    shm::Segment memory_;
    std::optional<servo::RecordLogReader> log_;
    servo::LogRecord record_;
    bool asked_anew_ = false;  // Watching is on its way
    struct Wanted {
        std::uint64_t claim = 0;
        std::uint32_t number = 0;
    };
    std::optional<Wanted> wanted_;  // ShownAsset, or Refused, is on its way
    std::map<std::pair<std::uint64_t, std::uint32_t>, int>
        tried_;  // assets that could not be read, how often
};

}  // namespace knurl::gateway

#pragma once
// A look at a running servo: what its report memory says, read through a mapping that cannot be written.
// Looking claims nothing, and the servo does nothing for it.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sys/types.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/protocol/servo_address.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/segment.hpp>

namespace knurl::cli {

struct ClientView {
    std::uint32_t row = 0;  // in the device's table
    pid_t pid = 0;
    std::string name;
    bool observer = false;                               // else it holds the device
    bool shared = false;                                 // lets others hold it too
    bool armed = false;                                  // its force may follow
    bool silent = false;                                 // its representations act on its silence
    double update_rate = 0;                              // Hz, measured; 0: not yet
    double age = 0;                                      // s, of its newest batch when it was used
    double gain = 0;                                     // 0-1
    HandScales scales;                                   // what the hand's budget leaves of its forces
    std::uint64_t commits = 0, refused = 0, merged = 0;  // batches
    std::uint64_t missed = 0;                            // reports
    std::vector<std::uint64_t> present;                  // representations of each kind

    bool has_representations() const {
        return std::any_of(present.begin(), present.end(), [](std::uint64_t n) { return n > 0; });
    }
};

struct DeviceView {
    protocol::DeviceInfo info;
    std::map<std::string, std::uint64_t> counters;  // by protocol::count_names
    std::optional<Report> report;                   // the newest
    std::vector<ClientView> clients;
};

struct ServoView {
    std::string name;     // "default"
    std::string socket;   // path
    std::string problem;  // why it cannot be looked at; empty: it can
    bool dead = false;    // the socket is one that a killed servo left behind
    bool unseen = false;  // we may or can not look: nothing is known of what is there
    pid_t pid = 0;
    std::vector<DeviceView> devices;
};

/// The mapped memory of a servo's devices; may be looked at again and again.
class ServoWatch {
  public:
    /// Throws std::runtime_error: nobody listens there, nobody answers in time, or the servo is of another
    /// build.
    explicit ServoWatch(const std::string& socket,
                        std::chrono::milliseconds answer_time = std::chrono::seconds(2));
    explicit ServoWatch(const protocol::ServoAddress& servo);

    ServoView look() const;
    /// Of each device, the reports since the last call (the first one begins with the newest). What was
    /// overwritten before it could be looked at is left out.
    std::vector<std::vector<Report>> new_reports();
    /// All reports of a device that its memory still holds, one after another.
    std::vector<Report> history(std::size_t device) const;

  private:
    void attach(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time);

    std::string socket_;
    pid_t pid_ = 0;
    std::vector<shm::Segment> segments_;
    std::vector<shm::BroadcastReader> reports_;
};

/// The broker's next message; throws what it refuses us for, and whatever is not `expected`.
void receive_answer(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time,
                    protocol::MessageType expected, std::span<std::byte> message,
                    std::vector<shm::UniqueFd>& fds);
template <class Message>
Message answer(const shm::UniqueFd& connection, protocol::MessageType expected,
               std::chrono::milliseconds answer_time, std::vector<shm::UniqueFd>& fds) {
    Message message;
    receive_answer(connection, answer_time, expected, std::as_writable_bytes(std::span(&message, 1)), fds);
    return message;
}
/// Says Hello. `segments`: the report memory of each device.
protocol::Welcome greet(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time,
                        std::vector<shm::UniqueFd>& segments);

/// The servo that --servo means. Throws UsageError.
protocol::ServoAddress servo_said(const std::string& said);
/// Throws std::runtime_error, which names the servo that was probably meant.
shm::UniqueFd connect_to_servo(const protocol::ServoAddress& servo);

/// Which of a servo's devices is meant, by its place in `names`; `wanted` may be empty where there is one. Throws
/// std::runtime_error, which says those that there are, or the one that was probably meant.
std::size_t chosen_device(const std::string& servo, const std::vector<std::string>& names,
                          const std::string& wanted);

/// All servos whose sockets lie in protocol::servo_directories(), by name; dead ones, strangers, and folders
/// that may not be read say so.
std::vector<ServoView> look_at_all();

}  // namespace knurl::cli

#pragma once
// A view of a running servo: its report memory, through a read-only mapping. It claims nothing, and costs the
// servo nothing.

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

namespace knurl::view {

struct ClientView {
    std::uint32_t row = 0;  // in the device's table
    pid_t pid = 0;
    std::string name;
    bool observer = false;                               // else it holds the device
    bool shared = false;                                 // others may hold it too
    bool armed = false;                                  // its force may follow
    bool shed = false;                                   // the cycles have no time for it
    bool silent = false;                                 // its representations act on silence
    double update_rate = 0;                              // Hz, measured; 0: not yet
    double age = 0;                                      // s, age of its newest batch when used
    double gain = 0;                                     // 0-1
    HandScales scales;                                   // factors of its forces by the hand's budget
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
    std::string problem;  // why it cannot be read; empty: it can
    bool dead = false;    // a killed servo left the socket behind
    bool unseen = false;  // no permission, or an error: the content is unknown
    pid_t pid = 0;
    std::vector<DeviceView> devices;
};

/// The mapped memory of a servo's devices; may be read repeatedly.
class ServoWatch {
  public:
    /// Throws std::runtime_error: no servo listens, none answers in time, or it is of another build.
    explicit ServoWatch(const std::string& socket,
                        std::chrono::milliseconds answer_time = std::chrono::seconds(2));
    explicit ServoWatch(const protocol::ServoAddress& servo);

    ServoView look() const;
    /// For each device, the reports since the last call (the first call starts with the newest). Reports that
    /// were overwritten unread are left out.
    std::vector<std::vector<Report>> new_reports();
    /// All reports of a device still in its memory, in order.
    std::vector<Report> history(std::size_t device) const;

  private:
    void attach(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time);

    std::string socket_;
    pid_t pid_ = 0;
    std::vector<shm::Segment> segments_;
    std::vector<shm::BroadcastReader> reports_;
};

/// The broker's next message; throws for a refusal, and for any message except `expected`.
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
/// Sends Hello. `segments`: the report memory of each device.
protocol::Welcome greet(const shm::UniqueFd& connection, std::chrono::milliseconds answer_time,
                        std::vector<shm::UniqueFd>& segments);

/// Throws std::runtime_error, with the name of the servo that was probably meant.
shm::UniqueFd connect_to_servo(const protocol::ServoAddress& servo);

/// The index of the wanted device in `names`; `wanted` may be empty if there is only one. Throws
/// std::runtime_error with the existing names, or the one that was probably meant.
std::size_t chosen_device(const std::string& servo, const std::vector<std::string>& names,
                          const std::string& wanted);

/// All servos with sockets in protocol::servo_directories(), by name. Dead ones, strangers, and unreadable
/// folders are marked.
std::vector<ServoView> look_at_all();

}  // namespace knurl::view

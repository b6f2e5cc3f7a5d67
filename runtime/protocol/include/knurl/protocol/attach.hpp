#pragma once
// The handshake over the servo's Unix socket (SOCK_SEQPACKET): one fixed-size struct a message, file
// descriptors beside it. After a claim everything goes through the claim's own segment; the socket stays
// open, and its hang-up is how each side learns of the other's death.
//
//   client                     broker
//   Hello              ->
//                      <-      Welcome + one report segment per device, or Refused
//   ClaimRequest       ->
//                      <-      Claimed + {claim segment, event descriptor}, or Refused
//   Release            ->      (or hang-up)
//   RecordRequest      ->
//                      <-      Recording + {input log}, or Refused; until the hang-up
//                      <-      RecordedAsset + {source}, for each that a claim gets

#include <cstdint>
#include <string>
#include <vector>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl::protocol {

inline constexpr std::uint32_t attach_magic = 0x4b6e7572;
inline constexpr std::uint32_t protocol_version = 1;

enum class MessageType : std::uint32_t {
    hello = 1,
    welcome,
    refused,
    claim,
    claimed,
    release,
    record,
    recording,
    asset_offer,  // asset.hpp
    asset_ready,
    asset_forget,
    recorded_asset
};

struct MessageHeader {
    std::uint32_t magic = attach_magic;
    MessageType type{};
};

struct Hello {
    MessageHeader header{.type = MessageType::hello};
    std::uint32_t version = protocol_version;
    std::uint32_t reserved = 0;
    std::uint64_t layout = 0;      // wire_hash()
    char client[name_bytes] = {};  // what `knurl ls` shows
};

struct Welcome {
    MessageHeader header{.type = MessageType::welcome};
    std::uint32_t devices = 0;  // as many report segments come with this message, in this order
    std::uint32_t servo_pid = 0;
    char names[max_devices][name_bytes] = {};
};

struct Refused {
    MessageHeader header{.type = MessageType::refused};
    std::uint32_t holder_pid = 0;  // who holds the device, if that is the reason
    std::uint32_t full = 0;        // 1: there is no place now; somebody who leaves makes one
    char text[512] = {};           // one line: what, where, what to do
};

/// ClaimRequest::observe of who holds nothing. `observe_and_reset` has the channel of commands for
/// `reset_fault`, beside whoever holds the device; the servo refuses any other. Its capacity is the servo's.
inline constexpr std::uint32_t observe_only = 1, observe_and_reset = 2;

struct ClaimRequest {
    MessageHeader header{.type = MessageType::claim};
    std::uint32_t device = 0;   // index in Welcome
    std::uint32_t observe = 0;  // 0: it holds the device; else observe_only, observe_and_reset
    std::uint32_t shared = 0;   // 1: others may claim the device too, if they say so as well
    std::uint32_t reserved = 0;
    ClaimCapacity capacity = {};
    double workspace_radius = 0;  // m, of the application's world; 0: the device's own (scale 1)
    Vec3 workspace_centre = {};   // m, where the device's centre lies in the application's world
    double update_interval = 0;   // s, how often it means to commit; 0: measured
    double delay_allowance = 0;   // s, by how much longer it may seem silent: its commits come over a network
};

/// World = scale (device - device_centre) + world_centre; device force = force_scale x world force.
struct Frame {
    Vec3 device_centre;
    Vec3 world_centre;
    double scale = 1;
    double force_scale = 1;
};

struct Claimed {
    MessageHeader header{.type = MessageType::claimed};
    std::uint32_t slot = 0;  // row in the device's table of clients
    std::uint32_t reserved = 0;
    ClaimCapacity capacity;  // as granted
    std::uint64_t key = 0;   // of this claim: who knows it may give it assets
    Frame frame;
    Limits limits;  // world units
};

struct Release {
    MessageHeader header{.type = MessageType::release};
    std::uint32_t slot = 0;
    std::uint32_t device = 0;
};

/// Every input of this device's servo, from now on.
struct RecordRequest {
    MessageHeader header{.type = MessageType::record};
    std::uint32_t device = 0;  // index in Welcome
    std::uint32_t reserved = 0;
};

/// With it comes the input log's memory (knurl/servo/input_log.hpp), which cannot be written.
struct Recording {
    MessageHeader header{.type = MessageType::recording};
    std::uint64_t from = 0;  // the slot to begin with
};

/// Hash over every wire type's size and offsets and the representations' tables.
std::uint64_t wire_hash() noexcept;

/// Where a servo of that name listens: $KNURL_RUNTIME_DIR, else /run/knurl as root, else
/// $XDG_RUNTIME_DIR/knurl.
std::string runtime_directory();
std::string socket_path(const std::string& servo_name);
/// Where a client looks for servos, best first: the user's own directory, then the system's, where the
/// service listens. $KNURL_RUNTIME_DIR replaces both.
std::vector<std::string> servo_directories();
/// Of the sockets of that name the first that exists, or that may not be looked for; if none does, where the
/// user's own would be.
std::string servo_socket(const std::string& servo_name);
/// $KNURL_STATE_DIR, else /var/lib/knurl as root, else $XDG_STATE_HOME/knurl or ~/.local/state/knurl.
std::string state_directory();

}  // namespace knurl::protocol

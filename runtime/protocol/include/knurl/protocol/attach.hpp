#pragma once

/// @file
/// The handshake over the servo's Unix socket (SOCK_SEQPACKET): one fixed-size struct a message, file
/// descriptors beside it. After a claim everything goes through the claim's own segment; the socket stays
/// open, and its hang-up is how each side learns of the other's death.
///
///     client                     broker
///     Hello              ->
///                        <-      Welcome + one report segment per device, or Refused
///     ClaimRequest       ->
///                        <-      Claimed + {claim segment, socket to sleep on}, or Refused
///     Mapped             ->
///                        <-      Serving, or Refused
///     Release            ->      (or hang-up)
///     RecordRequest      ->
///                        <-      Recording + {input log}, or Refused; until the hang-up
///                        <-      RecordedAsset + {source}, for each that a claim gets
///     WatchRequest       ->
///                        <-      Watching + {scene log}, or Refused; until the hang-up
///     ShowAsset          ->
///                        <-      ShownAsset + {asset}, or Refused
///
/// Between Claimed and Mapped the client maps the claim's segment writable and then seals it against new
/// writers. Only then does the servo's thread read it: no page of a sealed segment can be taken away, so no
/// client can make that thread wait for a page fault. A claim that is not mapped within mapping_seconds is
/// taken back, and the client is sent Refused.

#include <cstdint>
#include <string>
#include <vector>

#include <knurl/protocol/bounds.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/reps/limits.hpp>
#include <knurl/reps/vec.hpp>

namespace knurl::protocol {

/// First word of every message.
inline constexpr std::uint32_t attach_magic = 0x4b6e7572;
/// Version of the handshake.
inline constexpr std::uint32_t protocol_version = 2;

/// Types of messages; the struct of the same name says what is in it.
enum class MessageType : std::uint32_t {
    /// Hello.
    hello = 1,
    /// Welcome.
    welcome,
    /// Refused.
    refused,
    /// ClaimRequest.
    claim,
    /// Claimed.
    claimed,
    /// Release.
    release,
    /// RecordRequest.
    record,
    /// Recording.
    recording,
    /// AssetOffer (asset.hpp).
    asset_offer,
    /// AssetReady.
    asset_ready,
    /// AssetForget.
    asset_forget,
    /// RecordedAsset.
    recorded_asset,
    /// Mapped.
    mapped,
    /// Serving.
    serving,
    /// WatchRequest.
    watch,
    /// Watching.
    watching,
    /// ShowAsset.
    show_asset,
    /// ShownAsset.
    shown_asset
};

/// What every message begins with.
struct MessageHeader {
    /// attach_magic.
    std::uint32_t magic = attach_magic;
    /// Type of the message.
    MessageType type{};
};

/// First message of a client.
struct Hello {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::hello};
    /// protocol_version.
    std::uint32_t version = protocol_version;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// wire_hash(); another one is refused.
    std::uint64_t layout = 0;
    /// Name that `knurl ls` shows.
    char client[name_bytes] = {};
};

/// Answer to Hello.
struct Welcome {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::welcome};
    /// Number of devices. As many report segments come with this message, in this order.
    std::uint32_t devices = 0;
    /// Process number of the servo.
    std::uint32_t servo_pid = 0;
    /// Names of the devices.
    char names[max_devices][name_bytes] = {};
};

/// A request is refused.
struct Refused {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::refused};
    /// Process that holds the device, if that is the reason.
    std::uint32_t holder_pid = 0;
    /// 1: there is no place now; a client that leaves makes one.
    std::uint32_t full = 0;
    /// One line: what, where, what to do.
    char text[512] = {};
};

/// ClaimRequest::observe of a client that reads reports.
inline constexpr std::uint32_t observe_only = 1;
/// ClaimRequest::observe of a client that reads reports, and has the command channel for `reset_fault` alone,
/// beside whoever holds the device. Its capacity is the servo's.
inline constexpr std::uint32_t observe_and_reset = 2;

/// A client requests a device.
struct ClaimRequest {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::claim};
    /// Index in Welcome.
    std::uint32_t device = 0;
    /// 0: it holds the device; else observe_only or observe_and_reset.
    std::uint32_t observe = 0;
    /// 1: others may claim the device too, if they say so as well.
    std::uint32_t shared = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Size of the claim.
    ClaimCapacity capacity = {};
    /// Radius of the workspace in the application's world (m); 0: the device's own (scale 1).
    double workspace_radius = 0;
    /// Where the device's centre lies in the application's world (m).
    Vec3 workspace_centre = {};
    /// How often the application means to commit (s); 0: measured.
    double update_interval = 0;
    /// By how much longer it may seem silent (s), since its commits come over a network; at most
    /// max_delay_allowance.
    double delay_allowance = 0;
};

/// World = scale (device - device_centre) + world_centre; device force = force_scale x world force.
struct Frame {
    /// Centre of the workspace in the device frame (m).
    Vec3 device_centre;
    /// The same point in the world (m).
    Vec3 world_centre;
    /// Metres of the world that one metre of the device is (1).
    double scale = 1;
    /// Newtons of the device that one newton of the world is (1).
    double force_scale = 1;
};

/// Answer to ClaimRequest. With it come the claim's segment and a socket that is readable when a client who
/// waits on it (shm::Waits::on_socket) is woken.
struct Claimed {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::claimed};
    /// Row in the device's table of clients.
    std::uint32_t slot = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
    /// Size of the claim, as granted.
    ClaimCapacity capacity;
    /// Key of this claim: a process that knows it may give the claim assets.
    std::uint64_t key = 0;
    /// World frame of the claim.
    Frame frame;
    /// The device's limits in world units.
    Limits limits;
};

/// Time from Claimed to Mapped (s).
inline constexpr double mapping_seconds = 2;

/// The client has mapped the claim's segment and sealed it against new writers (F_SEAL_FUTURE_WRITE).
struct Mapped {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::mapped};
    /// Claimed::key.
    std::uint64_t key = 0;
};

/// Answer to Mapped: from now on the servo's thread reads the claim's segment.
struct Serving {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::serving};
    /// Claimed::key.
    std::uint64_t key = 0;
};

/// A client gives a claim back.
struct Release {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::release};
    /// Claimed::slot.
    std::uint32_t slot = 0;
    /// Index in Welcome.
    std::uint32_t device = 0;
};

/// A client requests every input of this device's servo, from now on.
struct RecordRequest {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::record};
    /// Index in Welcome.
    std::uint32_t device = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// Answer to RecordRequest. With it comes the input log's memory (knurl/servo/input_log.hpp), which cannot be
/// written.
struct Recording {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::recording};
    /// Slot to begin with.
    std::uint64_t from = 0;
};

/// A client wants to see the scenes of a device; once more: all of them anew, since it has missed something.
struct WatchRequest {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::watch};
    /// Index in Welcome.
    std::uint32_t device = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// Answer to WatchRequest. With it comes the scene log's memory (knurl/servo/scene_log.hpp), which cannot be written.
struct Watching {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::watching};
    /// Slot to begin with.
    std::uint64_t from = 0;
};

/// A client that watches wants to see an asset of a claim.
struct ShowAsset {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::show_asset};
    /// Index in Welcome.
    std::uint32_t device = 0;
    /// Row of the claim in the device's table of clients.
    std::uint32_t row = 0;
    /// Number of the asset.
    std::uint32_t number = 0;
    /// Padding; 0.
    std::uint32_t reserved = 0;
};

/// Answer to ShowAsset. With it comes the servo's form of the asset, sealed, for asset_of (knurl/geometry/asset.hpp).
struct ShownAsset {
    /// Magic number and type of the message.
    MessageHeader header{.type = MessageType::shown_asset};
    /// Bytes of its memory.
    std::uint64_t bytes = 0;
};

/// Hash over every wire type's size and offsets and the representations' tables.
std::uint64_t wire_hash() noexcept;

/// Directory of a servo's socket: $KNURL_RUNTIME_DIR, else /run/knurl as root, else $XDG_RUNTIME_DIR/knurl.
std::string runtime_directory();
/// Where a servo of that name listens.
std::string socket_path(const std::string& servo_name);
/// Where a client looks for servos, best first: the user's own directory, then the system's, where the
/// service listens. $KNURL_RUNTIME_DIR replaces both.
std::vector<std::string> servo_directories();
/// Of the sockets of that name the first that exists, or that may not be looked for; if none does, where the
/// user's own would be.
std::string servo_socket(const std::string& servo_name);
/// Directory of flight records: $KNURL_STATE_DIR, else /var/lib/knurl as root, else $XDG_STATE_HOME/knurl or
/// ~/.local/state/knurl.
std::string state_directory();

}  // namespace knurl::protocol

#pragma once
// The protocol between the two ends of the bridge, little-endian. Frames go over TCP (frame_stream.hpp),
// reliably and in order; datagrams go over UDP and may be lost. They carry the servo's own structs, so both
// ends must be built alike: the hash in Hello checks that.
//
//   remote                              relay
//   hello                    ->
//                            <-         welcome + DeviceRow per device, or refused
//   attach                   ->
//                            <-         attached, or refused
//   commands, release, batch ->
//                            <-         replies, feedback, gone
//   asset_offer, its pieces  ->
//                            <-         asset_taken, one per piece; asset_ready, or asset_refused
//
//   hello, ping, batch       ~>         (datagrams)
//                            <~         pong, report

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/command.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/protocol/text.hpp>

namespace knurl::bridge {

using protocol::put_text;
using protocol::text_of;

inline constexpr std::uint64_t wire_magic = 0x656764697262;  // "bridge"
inline constexpr std::uint32_t wire_version = 4;
inline constexpr const char* exporter_label = "EXPORTER-knurl-bridge-datagrams";

// ------------------------------------------------------------------------------------------------ bounds

inline constexpr std::size_t max_sessions = protocol::max_clients;
// claims and observers of one connection
inline constexpr std::uint32_t max_streams = protocol::max_claims_of_connection;
// at most; the path's own limit is measured (path_mtu.hpp)
inline constexpr std::size_t datagram_bytes = 1200;
// enough for a report and feedback; every IPv6 path carries 1280
inline constexpr std::size_t least_datagram_bytes = 760;
inline constexpr std::size_t max_pieces = 4;           // of a batch or feedback in datagrams; more go by TCP
inline constexpr std::int64_t resend_ns = 10'000'000;  // unacknowledged batches are sent again
inline constexpr std::int64_t dead_after_ns = 2'000'000'000;  // without a sign of life of the other end
inline constexpr double delay_allowance = 0.2;                // s, the allowance that a bridge requests for
                                                              // the delay of its peers' commits
inline constexpr std::size_t max_frame_bytes = 640 * 1024;    // larger than the largest group of commands, or
                                                              // batch
inline constexpr std::size_t max_greeting_bytes = 1024;       // before the peer is identified
inline constexpr std::size_t asset_piece_bytes = 8192;        // of an asset per frame: 6.6 ms at 10 Mbit/s
inline constexpr std::size_t max_assets_on_their_way = 4;     // unanswered assets of one connection

// ------------------------------------------------------------------------------------------------ frames

enum class FrameType : std::uint16_t {
    hello = 1,
    welcome,
    refused,
    attach,
    attached,
    release,   // of the frame's stream; a Nothing
    commands,  // a whole group, in 64-byte cells
    replies,   // protocol::Reply, one or more
    batch,     // BatchHeader + entries: too large for datagrams
    feedback,  // FeedbackHeader + entries: likewise
    gone,      // text: the servo is gone, and the connection ends
    // Assets (protocol/asset.hpp). The pieces follow their offer without waiting for an answer.
    asset_offer,
    asset_piece,   // AssetPiece, then up to asset_piece_bytes
    asset_cancel,  // AssetTicket
    asset_forget,
    asset_taken,  // AssetTicket: one for each piece, in order, whatever happens to the asset
    asset_ready,
    asset_refused,
};

struct Hello {
    std::uint64_t magic = wire_magic;
    std::uint32_t version = wire_version;
    std::uint32_t reserved = 0;
    std::uint64_t layout = 0;  // wire_hash()
    char client[protocol::name_bytes] = {};
};

struct Welcome {
    std::uint64_t session = 0;
    std::uint32_t devices = 0;  // so many DeviceRow follow
    std::uint32_t servo_pid = 0;
};

struct DeviceRow {
    char name[protocol::name_bytes] = {};
    char address[protocol::name_bytes] = {};
    char profile[protocol::name_bytes] = {};
    char serial[protocol::name_bytes] = {};
    double rate = 0;              // Hz
    Vec3 workspace_centre;        // m
    double workspace_radius = 0;  // m
    double peak_force = 0;        // N
    double peak_torque = 0;       // N m
    double max_stiffness = 0;     // N/m
    std::uint32_t renders_torque = 0;
    std::uint32_t senses_orientation = 0;
};

struct Refused {
    std::uint32_t kind = 0;  // Error::Kind
    std::uint32_t holder_pid = 0;
    char text[512] = {};
};

struct Attach {
    protocol::ClaimRequest request;
    double report_rate = 0;  // Hz at most; 0: each
};

struct Attached {
    protocol::Claimed terms;
    std::uint32_t device = 0;
    std::uint32_t stream = 0;  // 1 to max_streams: of its frames and datagrams
};

struct Nothing {
    std::uint64_t nothing = 0;
};

struct AssetOffer {
    std::uint64_t ticket = 0;  // of the connection's offers, increasing
    std::uint64_t bytes = 0;   // of the source
    std::uint32_t number = 0;
    std::uint32_t reserved = 0;
};
struct AssetPiece {
    std::uint64_t ticket = 0;
    std::uint64_t offset = 0;  // the end of the previous piece
};
struct AssetTicket {
    std::uint64_t ticket = 0;
};
struct AssetForget {
    std::uint32_t number = 0;
    std::uint32_t reserved = 0;
};
struct AssetReady {
    std::uint64_t ticket = 0;
    protocol::AssetReady ready;
};
struct AssetRefused {
    std::uint64_t ticket = 0;
    Refused refused;
};

// --------------------------------------------------------------------------------------------- datagrams

enum class DatagramKind : std::uint8_t {
    hello = 1,  // answers go to the sender's address
    ping,       // PingBody, stream 0; some are padded with zeros, to measure the path
    pong,       // PongBody, stream 0; as long as its ping
    batch,      // BatchPiece, then a piece of BatchHeader + entries
    report,     // ReportPiece, then the parts that its flags name
};

/// Before each datagram; anybody can read it, but only an end with the key can change it.
struct DatagramHeader {
    std::uint64_t session = 0;
    std::uint64_t counter = 0;  // of this direction: 1, 2, ...
    DatagramKind kind{};
    std::uint8_t stream = 0;  // 0: the connection itself
    std::uint8_t piece = 0, pieces = 1;
    std::uint32_t reserved = 0;
};

struct HelloBody {
    std::uint64_t received = 0;  // reports so far; 0 requests the newest one
};
struct PingBody {
    std::int64_t sent_ns = 0;   // the sender's clock
    std::uint64_t longest = 0;  // bytes, of the longest datagram that has reached the sender lately
};
struct PongBody {
    std::int64_t ping_sent_ns = 0;
    std::int64_t received_ns = 0;  // the answering end's clock
    std::int64_t sent_ns = 0;
    std::uint64_t longest = 0;  // as in PingBody, for the answering end
};

struct BatchPiece {
    std::uint64_t sequence = 0;
    std::uint32_t offset = 0, total = 0;  // bytes of BatchHeader + entries
};

struct ReportPiece {
    std::uint64_t number = 0;  // of the stream's reports: 1, 2, ...
    std::uint64_t feedback_cycle = 0;
    std::uint64_t answers = 0;  // number of answers to commands sent by TCP before this
    std::uint32_t flags = 0;
    std::uint32_t first_entry = 0, entries = 0;  // FeedbackEntry at the end of this datagram
    std::uint32_t reserved = 0;
};
namespace piece_flags {
inline constexpr std::uint32_t report = 1u << 0;    // a Report comes first
inline constexpr std::uint32_t feedback = 1u << 1;  // then a FeedbackHeader
inline constexpr std::uint32_t entries = 1u << 2;   // then this piece of its entries
}  // namespace piece_flags

static_assert(sizeof(Hello) == 88 && sizeof(Welcome) == 16 && sizeof(DeviceRow) == 328);
static_assert(sizeof(Refused) == 520 && sizeof(Attached) == sizeof(protocol::Claimed) + 8);
static_assert(sizeof(AssetOffer) == 24 && sizeof(AssetPiece) == 16 && sizeof(AssetForget) == 8);
static_assert(sizeof(DatagramHeader) == 24 && sizeof(BatchPiece) == 16 && sizeof(ReportPiece) == 40);

/// Over all structs that are sent, the servo's included.
inline std::uint64_t wire_hash() noexcept {
    std::uint64_t hash = protocol::wire_hash();
    for (const std::uint64_t size :
         {std::uint64_t{wire_version}, std::uint64_t{sizeof(Hello)}, std::uint64_t{sizeof(Welcome)},
          std::uint64_t{sizeof(DeviceRow)}, std::uint64_t{sizeof(Refused)}, std::uint64_t{sizeof(Attach)},
          std::uint64_t{sizeof(Attached)}, std::uint64_t{sizeof(AssetReady)},
          std::uint64_t{sizeof(DatagramHeader)}, std::uint64_t{sizeof(BatchPiece)},
          std::uint64_t{sizeof(ReportPiece)}})
        hash = (hash ^ size) * 0x100000001b3;
    return hash;
}

// ------------------------------------------------------------------------------------------------- bytes

template <class T>
std::span<const std::byte> bytes_of(const T& value) noexcept {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_bytes(std::span(&value, 1));
}

/// The struct at the front of `from`, which then begins behind it. False: too short.
template <class T>
bool take(std::span<const std::byte>& from, T& value) noexcept {
    static_assert(std::is_trivially_copyable_v<T>);
    if (from.size() < sizeof value) return false;
    std::memcpy(static_cast<void*>(&value), from.data(), sizeof value);
    from = from.subspan(sizeof value);
    return true;
}

/// Copies all parts in sequence into `room`, which must hold them. Returns the number of bytes.
template <class... T>
std::size_t write(std::span<std::byte> room, const T&... values) noexcept {
    static_assert((std::is_trivially_copyable_v<T> && ...));
    std::size_t at = 0;
    ((std::memcpy(room.data() + at, &values, sizeof values), at += sizeof values), ...);
    return at;
}

}  // namespace knurl::bridge

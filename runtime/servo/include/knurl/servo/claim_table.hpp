#pragma once

/// @file
/// Who holds a device: its claims and observers from the grant to the day that the servo gives their memory
/// back.

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include <sys/types.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/servo/claim.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/memory_budget.hpp>
#include <knurl/servo/servo.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/waiter.hpp>

namespace knurl::servo {

/// One device as the broker needs it.
struct HostedDevice {
    /// Name by which it is claimed.
    std::string name;
    /// What the device says about itself.
    const drivers::LinkConfig& link;
    /// Its servo.
    Servo& servo;
    /// Its report memory (protocol::device_layout), sealed.
    shm::Segment& segment;
    /// Rate of its loop (Hz).
    double rate = 1000;
    /// Header of a recording.
    InputLogHeader input_log;
};

/// A client's process.
struct Peer {
    /// Process number.
    pid_t pid = 0;
    /// User.
    uid_t uid = 0;
    /// Name as it gave it.
    std::string name;
};

/// A request is refused: one line for the client, what, where, what to do.
class RequestRefused : public std::runtime_error {
  public:
    /// `text`: the line.
    explicit RequestRefused(const std::string& text, pid_t holder = 0)
        : std::runtime_error(text), holder_pid(holder) {}
    /// A refusal that ends when somebody leaves: the client may wait for a place.
    static RequestRefused no_place(const std::string& text) {
        RequestRefused refusal(text);
        refusal.full = true;
        return refusal;
    }
    /// Process that holds the device; 0: that is not the reason.
    pid_t holder_pid;
    /// There is no place now.
    bool full = false;
};

/// What a granted client is sent.
struct Grant {
    /// The answer.
    protocol::Claimed message;
    /// The claim's segment; the descriptor stays the table's.
    int segment_fd = -1;
    /// What the client may sleep on: its end of a pair of sockets. The servo keeps none of it.
    shm::UniqueFd wake_fd;
};

/// The memory in which an asset lies, as its builder sealed it.
using AssetMemory = std::shared_ptr<shm::Segment>;

/// Used by the broker's thread alone; the servo's thread touches only what adopt() handed to it.
///
///   free --grant--> granted --serve--> held --let_go (hang-up, release)--> leaving --the servo gives the
///                      └── let_go: free                                              claim back--> free
///
/// A granted claim holds the device, but no thread of the servo touches its segment before serve(). A leaving
/// claim fades for 50 ms; it does not keep the next one from the device.
class ClaimTable {
  public:
    /// A table of this device, empty. `memory` is that of all devices of the servo.
    ClaimTable(HostedDevice device, shm::Waker& waker, MemoryBudget& memory);
    /// The servo must have ended: what it held is freed.
    ~ClaimTable();

    /// Grants a claim, which the client has to map. Throws RequestRefused; nothing is half-granted.
    Grant grant(const protocol::ClaimRequest& request, const Peer& peer);
    /// The client has mapped and sealed the segment of this granted claim: the servo serves it from now on.
    /// Throws RequestRefused: the segment is not sealed, a page of it was taken away, or the servo is busy;
    /// the row is free then. The claim is there until let_go.
    Claim& serve(std::uint32_t row);
    /// The client has hung up or given the claim back. Never fails: if the servo's mailbox is full, collect()
    /// tries again.
    void let_go(std::uint32_t row) noexcept;
    /// The claim of a row; null: the row is free.
    const Claim* claim(std::uint32_t row) const noexcept { return rows_[row].claim.get(); }
    /// Frees what the servo has given back. False: nothing is on its way any more.
    bool collect() noexcept;

    /// The claim that has this key is to get an asset of that number. Returns how many bytes it may take.
    /// Throws RequestRefused.
    std::uint64_t expect_asset(std::uint64_t key, std::uint32_t number, std::uint64_t bytes);
    /// There will be none.
    void expect_no_asset(std::uint64_t key, std::uint32_t number) noexcept;
    /// Gives the asset to the claim's scene. Throws RequestRefused: the claim has gone, or the servo is busy.
    void give_asset(std::uint64_t key, std::uint32_t number, std::unique_ptr<Asset> asset, AssetMemory memory,
                    const protocol::AssetDigest& digest);
    /// The memory of an asset of the claim in that row, for who watches. `room`: one more may be shown. Throws
    /// RequestRefused: there is none, or there is no room.
    const shm::Segment& asset_memory(std::uint32_t row, std::uint32_t number, bool room);
    /// Assets that are shown to watchers. Each takes a descriptor until its claim has given it up.
    std::size_t shown_assets() const noexcept;
    /// The asset is freed once the servo has given it back. Throws RequestRefused.
    void forget_asset(std::uint64_t key, std::uint32_t number);

    /// The device.
    const HostedDevice& device() const { return device_; }

  private:
    enum class Stage {
        free,
        granted,
        held,
        // the servo let go of it by itself (it is ending); its client still thinks that it holds it
        returned,
        dropping,  // the servo's mailbox was full
        leaving,
        clearing,  // a waker was waking its client when it was to be freed
    };
    struct HeldAsset {
        MemoryShare memory;
        AssetMemory block;
        bool shown = false;  // somebody else maps it
        std::unique_ptr<Asset> asset;
    };
    struct RowAsset {
        enum class Stage : std::uint8_t { none, building, there, leaving } stage = Stage::none;
        std::unique_ptr<HeldAsset> held;
    };
    struct Row {
        MemoryShare memory;
        Stage stage = Stage::free;
        bool observer = false;
        bool shared = false;
        bool trusted = false;  // its client could stop the servo anyway
        Peer peer;
        shm::Segment segment;
        shm::UniqueFd wake_fd;  // our end of its pair of sockets
        std::uint64_t key = 0;
        std::vector<RowAsset> assets;  // by number less 1, empty before the first; outlive the claim
        std::unique_ptr<Claim> claim;
    };

    void require_sane(const protocol::ClaimRequest& request) const;
    void require_free_for(const protocol::ClaimRequest& request) const;
    void require_share_of(const protocol::ClaimRequest& request, const Peer& peer) const;
    protocol::ClientRow& shared_row(std::uint32_t row) const;
    void identify(std::uint32_t row, const Peer& peer, std::uint64_t role, bool shared) noexcept;
    void clear(std::uint32_t row) noexcept;
    Row* row_of_key(std::uint64_t key) noexcept;
    static std::uint64_t asset_bytes(const Row& row) noexcept;
    /// What is left for `what` that takes `bytes`. Throws RequestRefused: too little.
    std::uint64_t require_memory(const char* what, std::uint64_t bytes) const;
    void take_back_assets() noexcept;

    HostedDevice device_;
    shm::Waker& waker_;
    MemoryBudget& memory_;
    std::array<Row, protocol::max_clients> rows_;
    std::uint32_t on_their_way_ = 0;  // rows in dropping, leaving or clearing
};

}  // namespace knurl::servo

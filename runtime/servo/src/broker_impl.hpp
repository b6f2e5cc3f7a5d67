#pragma once
// The broker's state and parts: broker.cpp waits, admits and ends; broker_requests.cpp answers what clients send.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <sys/epoll.h>

#include <knurl/servo/broker.hpp>

#include "asset_service.hpp"
#include "attach_messages.hpp"
#include "recording_service.hpp"
#include "scene_service.hpp"

namespace knurl::servo {

using SteadyClock = std::chrono::steady_clock;

// The values that epoll returns. Connections are numbered from first_connection and no number is used twice.
// So an event for a connection that was closed in the same round finds none.
enum BrokerSource : std::uint64_t { listening, signalled, guardian_gone, built, first_connection };

/// A client's connection, and what it holds.
struct Connection {
    struct Holding {
        std::size_t device;
        std::uint32_t row;
        std::uint64_t key;
        // free: the claim was taken back, and its client told so, before its Mapped came
        enum class Stage : std::uint8_t { granted, served, free } stage = Stage::granted;
        SteadyClock::time_point since;
    };
    using Stage = Holding::Stage;
    shm::UniqueFd socket;
    SteadyClock::time_point since;
    bool greeted = false;
    bool offering = false;  // an asset, which the builder takes: nothing is read here meanwhile
    Peer peer;
    std::vector<Holding> holdings;
    std::optional<std::size_t> recording;  // device
    std::optional<std::size_t> watching;   // device
};

struct Broker::Impl {
    explicit Impl(BrokerOptions stated)
        : options(std::move(stated)),
          closer(options.closer),
          memory(options.memory),
          assets(options.builder) {}
    ~Impl() {
        assets.end();  // it holds some of the sockets as well
        for (auto& [id, connection] : connections) closer.close(std::move(connection.socket));
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    BrokerOptions options;
    Closer& closer;       // of every socket on which a client may have sent something
    MemoryBudget memory;  // outlives the tables, which give theirs back
    AssetService assets;
    std::uint64_t watched_build = 0;
    shm::UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
    std::vector<std::unique_ptr<ClaimTable>> tables;
    std::array<RecordingService, protocol::max_devices> recordings;
    std::array<SceneService, protocol::max_devices> scenes;
    std::unordered_map<std::uint64_t, Connection> connections;
    std::uint64_t next_id = first_connection;
    std::size_t half_open = 0;
    std::size_t unmapped = 0;  // claims that were granted and not mapped yet
    shm::UniqueFd spare = spare_descriptor();
    bool listening_now = false;
    SteadyClock::time_point pause_until{};
    std::optional<End> ending;
    SteadyClock::time_point ending_since{};
    std::vector<bool> asked_to_end;  // per device: drop_all was delivered

    // broker.cpp: who comes and goes
    void watch(int fd, std::uint64_t source);
    /// Whatever has happened at this source.
    void answer(std::uint64_t source);
    /// While all half-open places are taken, further callers wait in the listening queue: none is refused.
    void update_listening();
    void accept_one();
    /// When descriptors run out, one reserved descriptor serves to refuse a waiting caller with a reason.
    void tell_one_why();
    static shm::UniqueFd spare_descriptor();
    void drop_silent_callers();
    void close(std::uint64_t id);
    int patience_ms(bool collecting) const;
    void begin_to_end(End why);
    /// Is every device at rest, or has its time run out?
    bool at_rest();

    // broker_requests.cpp: what they ask. False: the peer does not read its replies. RequestRefused: the
    // connection ends.
    /// Handles what one connection has sent. Bytes that are not a valid message end it.
    void serve(std::uint64_t id);
    bool handle(std::uint64_t id, Connection& connection, const Buffer& buffer, std::size_t bytes);
    static bool refuse(const Connection& to, const RequestRefused& why);
    bool greet(Connection& connection, const Buffer& buffer, std::size_t bytes);
    /// Only who has said Hello is told, and counted: a socket that is closed with an unread message shows its
    /// owner a reset in place of our answer.
    void require_place(const Peer& peer) const;
    std::string is_ending() const;
    bool claim(Connection& connection, const protocol::ClaimRequest& request);
    /// The client has mapped a claim.
    bool serve_claim(std::uint64_t id, Connection& connection, const protocol::Mapped& mapped);
    void release(std::uint64_t id, Connection& connection, const protocol::Release& release);
    void take_back(std::uint64_t id, Connection::Holding& holding);
    void take_back_unmapped();
    bool record(Connection& connection, const protocol::RecordRequest& request);
    bool watch_scenes(Connection& connection, const protocol::WatchRequest& request);
    bool show_asset(const Connection& connection, const protocol::ShowAsset& request);
    /// The message with the descriptor stays in the socket until the builder takes it: nobody here may take it.
    void offer(std::uint64_t id, Connection& connection, const protocol::AssetOffer& message);
    void set_offering(Connection& connection, std::uint64_t id, bool offering);
    /// The build queue runs another process, or none.
    void watch_build();
    void tell_builders();
    void forget_quietly(const protocol::AssetForget& message);
};

}  // namespace knurl::servo

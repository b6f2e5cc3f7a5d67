// What clients send to the broker, and its answers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include <knurl/protocol/text.hpp>
#include <knurl/shm/socket.hpp>

#include "broker_impl.hpp"
#include "fair_share.hpp"

namespace knurl::servo {

using protocol::MessageType;

void Broker::Impl::set_offering(Connection& connection, std::uint64_t id, bool offering) {
    connection.offering = offering;
    // A hang-up is noticed in any case.
    epoll_event event{.events = std::uint32_t{offering ? EPOLLRDHUP : EPOLLIN}, .data = {.u64 = id}};
    epoll_ctl(epoll.get(), EPOLL_CTL_MOD, connection.socket.get(), &event);
}

bool Broker::Impl::refuse(const Connection& to, const RequestRefused& why) {
    protocol::Refused message;
    message.holder_pid = static_cast<std::uint32_t>(why.holder_pid);
    message.full = why.full ? 1 : 0;
    protocol::put_text(message.text, why.what());
    return shm::send_message(to.socket, bytes_of(message));
}

void Broker::Impl::take_back(std::uint64_t id, Connection::Holding& holding) {
    if (holding.stage == Connection::Stage::free) return;
    if (holding.stage == Connection::Stage::granted) --unmapped;
    if (const Claim* claim = tables[holding.device]->claim(holding.row)) options.deaths.release(id, *claim);
    holding.stage = Connection::Stage::free;
    tables[holding.device]->let_go(holding.row);
}

void Broker::Impl::serve(std::uint64_t id) {
    for (int i = 0; i < broker_bounds::messages_at_once; ++i) {
        const auto found = connections.find(id);
        if (found == connections.end()) return;
        Connection& connection = found->second;
        if (connection.offering) return close(id);  // it has hung up
        try {
            Buffer buffer;
            const shm::Received received = shm::receive_plain_message(connection.socket, buffer);
            if (received.nothing) return;
            if (received.closed) return close(id);
            const bool with_asset =
                received.carries_descriptors && connection.greeted &&
                type_of(buffer, received.bytes) == static_cast<std::uint32_t>(MessageType::asset_offer);
            if (received.truncated || (received.carries_descriptors && !with_asset)) {
                throw RequestRefused(
                    "attach: a message that is too long, or carries descriptors; is this a Knurl "
                    "client?");
            }
            if (with_asset)
                return offer(id, connection,
                             read_message<protocol::AssetOffer>(buffer, received.bytes, "asset"));
            if (!handle(id, connection, buffer, received.bytes)) return close(id);
        } catch (const RequestRefused& refusal) {
            refuse(connection, refusal);
            return close(id);
        } catch (const std::exception&) {  // the socket broke, or memory ran out: only this connection
                                           // ends
            return close(id);
        }
    }
}

bool Broker::Impl::handle(std::uint64_t id, Connection& connection, const Buffer& buffer, std::size_t bytes) {
    const std::optional<std::uint32_t> type = type_of(buffer, bytes);
    if (!type) throw RequestRefused("attach: not a message of Knurl's (magic); is this a Knurl client?");
    if (!connection.greeted) {
        if (*type != static_cast<std::uint32_t>(MessageType::hello))
            throw RequestRefused("attach: say Hello first");
        return greet(connection, buffer, bytes);
    }
    switch (*type) {
        case static_cast<std::uint32_t>(MessageType::claim):
            return claim(connection, read_message<protocol::ClaimRequest>(buffer, bytes, "claim"));
        case static_cast<std::uint32_t>(MessageType::mapped):
            return serve_claim(id, connection, read_message<protocol::Mapped>(buffer, bytes, "claim"));
        case static_cast<std::uint32_t>(MessageType::release):
            release(id, connection, read_message<protocol::Release>(buffer, bytes, "release"));
            return true;
        case static_cast<std::uint32_t>(MessageType::record):
            return record(connection, read_message<protocol::RecordRequest>(buffer, bytes, "record"));
        case static_cast<std::uint32_t>(MessageType::watch):
            return watch_scenes(connection, read_message<protocol::WatchRequest>(buffer, bytes, "watch"));
        case static_cast<std::uint32_t>(MessageType::show_asset):
            return show_asset(connection, read_message<protocol::ShowAsset>(buffer, bytes, "asset"));
        case static_cast<std::uint32_t>(MessageType::asset_forget):
            assets.forget(read_message<protocol::AssetForget>(buffer, bytes, "asset"), tables);
            return true;
        default:
            throw RequestRefused(
                fmt::format("attach: message type {} is not one that a client sends here", *type));
    }
}

bool Broker::Impl::greet(Connection& connection, const Buffer& buffer, std::size_t bytes) {
    // The version is checked before the size: an older client's Hello may have another size.
    std::uint32_t version = 0;
    if (bytes >= offsetof(protocol::Hello, version) + sizeof version) {
        std::memcpy(&version, buffer.data() + offsetof(protocol::Hello, version), sizeof version);
    }
    if (version != protocol::protocol_version) {
        throw RequestRefused(
            fmt::format("build mismatch: the client speaks version {} and servo \"{}\" version {}; "
                        "rebuild the one and restart the other",
                        version, options.servo_name, protocol::protocol_version));
    }
    const auto hello = read_message<protocol::Hello>(buffer, bytes, "build mismatch: hello");
    if (hello.layout != protocol::wire_hash()) {
        throw RequestRefused(
            fmt::format("build mismatch: the client's memory layout is {:016x} and servo \"{}\" has "
                        "{:016x}; rebuild the one and restart the other",
                        hello.layout, options.servo_name, protocol::wire_hash()));
    }
    require_place(connection.peer);
    connection.greeted = true;
    --half_open;
    connection.peer.name = protocol::printable(hello.client);

    protocol::Welcome welcome;
    welcome.devices = static_cast<std::uint32_t>(tables.size());
    welcome.servo_pid = static_cast<std::uint32_t>(getpid());
    std::vector<int> segments;
    for (std::size_t i = 0; i < tables.size(); ++i) {
        protocol::put_text(welcome.names[i], tables[i]->device().name);
        segments.push_back(tables[i]->device().segment.fd());
    }
    return shm::send_message(connection.socket, bytes_of(welcome), segments);
}

bool Broker::Impl::claim(Connection& connection, const protocol::ClaimRequest& request) {
    // A refused claim leaves the connection open: the client may ask for another device.
    try {
        if (ending) throw RequestRefused(is_ending());
        if (request.device >= tables.size()) {
            throw RequestRefused(fmt::format("claim: device {} of {}", request.device, tables.size()));
        }
        if (connection.holdings.size() >= protocol::max_claims_of_connection) {
            throw RequestRefused(fmt::format("claim: one connection holds up to {}; connect once more",
                                             protocol::max_claims_of_connection));
        }
        ClaimTable& table = *tables[request.device];
        const Grant grant = table.grant(request, connection.peer);
        connection.holdings.push_back({.device = request.device,
                                       .row = grant.message.slot,
                                       .key = grant.message.key,
                                       .since = SteadyClock::now()});
        ++unmapped;
        const std::array fds{grant.segment_fd, grant.wake_fd.get()};
        return shm::send_message(connection.socket, bytes_of(grant.message), fds);
    } catch (const RequestRefused& refusal) {
        return refuse(connection, refusal);
    }
}

bool Broker::Impl::serve_claim(std::uint64_t id, Connection& connection, const protocol::Mapped& mapped) {
    const auto held = std::find_if(connection.holdings.begin(), connection.holdings.end(),
                                   [&](const Connection::Holding& h) {
                                       return h.key == mapped.key && h.stage != Connection::Stage::served;
                                   });
    if (held == connection.holdings.end())
        throw RequestRefused("claim: this connection has no claim of that key to map");
    if (held->stage == Connection::Stage::free) {  // the client has its answer: it took too long
        connection.holdings.erase(held);
        return true;
    }
    try {
        if (ending) {
            take_back(id, *held);
            throw RequestRefused(is_ending());
        }
        --unmapped;
        Claim& served = tables[held->device]->serve(held->row);
        options.deaths.hold(id, tables[held->device]->device().servo, served);
    } catch (const RequestRefused& refusal) {
        connection.holdings.erase(held);
        return refuse(connection, refusal);
    }
    held->stage = Connection::Stage::served;
    protocol::Serving serving;
    serving.key = held->key;
    return shm::send_message(connection.socket, bytes_of(serving));
}

void Broker::Impl::release(std::uint64_t id, Connection& connection, const protocol::Release& release) {
    const auto held = std::find_if(
        connection.holdings.begin(), connection.holdings.end(), [&](const Connection::Holding& h) {
            return h.device == release.device && h.row == release.slot && h.stage != Connection::Stage::free;
        });
    if (held == connection.holdings.end())
        throw RequestRefused("release: this connection does not hold that claim");
    take_back(id, *held);
    connection.holdings.erase(held);
}

void Broker::Impl::take_back_unmapped() {
    if (unmapped == 0) return;
    const auto latest = SteadyClock::now() - std::chrono::duration<double>(protocol::mapping_seconds);
    std::vector<std::uint64_t> deaf;
    for (auto& [id, connection] : connections) {
        for (Connection::Holding& holding : connection.holdings) {
            if (holding.stage != Connection::Stage::granted || holding.since >= latest) continue;
            take_back(id, holding);
            const RequestRefused why(
                fmt::format("claim of device \"{}\": its memory was not mapped within {:g} s; claim it "
                            "again",
                            tables[holding.device]->device().name, protocol::mapping_seconds));
            if (!refuse(connection, why)) deaf.push_back(id);
        }
    }
    for (const std::uint64_t id : deaf) close(id);
}

void Broker::Impl::offer(std::uint64_t id, Connection& connection, const protocol::AssetOffer& message) {
    assets.offer(id, message, connection.socket.get(), tables);
    set_offering(connection, id, true);
    watch_build();
    tell_builders();  // the builder could not be started
}

void Broker::Impl::watch_build() {
    if (assets.builds() == watched_build) return;
    watched_build = assets.builds();
    if (assets.event() >= 0) watch(assets.event(), built);
}

void Broker::Impl::forget_quietly(const protocol::AssetForget& message) {
    try {
        assets.forget(message, tables);
    } catch (const RequestRefused&) {  // the claim is gone, and its assets too
    }
}

void Broker::Impl::tell_builders() {
    // A recorder that does not read loses its connection. Else the claim would have to wait, and every
    // unsent source would pile up in memory.
    std::vector<std::uint64_t> lost;
    const auto record = [&](std::uint32_t device, const protocol::RecordedAsset& message, int source) {
        for (const auto& [id, connection] : connections) {
            if (connection.recording != device) continue;
            bool sent = false;
            try {
                sent = shm::send_message(connection.socket, bytes_of(message), {&source, 1});
            } catch (const std::runtime_error&) {  // too many descriptors are in flight
            }
            if (!sent) lost.push_back(id);
        }
    };
    for (AssetReply& reply : assets.answers(tables, record)) {
        closer.close(std::move(reply.source));
        const auto found = connections.find(reply.connection);
        const bool heard =
            found != connections.end() &&
            (reply.refusal.empty() ? shm::send_message(found->second.socket, bytes_of(reply.ready))
                                   : refuse(found->second, RequestRefused(reply.refusal)));
        if (heard && reply.refusal.empty()) {
            set_offering(found->second, reply.connection, false);
            continue;
        }
        // The builder may not have taken the offer out of the socket.
        close(reply.connection);
        if (reply.refusal.empty()) forget_quietly(reply.undo);
    }
    for (const std::uint64_t id : lost) close(id);
    watch_build();
}

bool Broker::Impl::record(Connection& connection, const protocol::RecordRequest& request) {
    try {
        if (request.device >= tables.size())
            throw RequestRefused(fmt::format("record: device {} of {}", request.device, tables.size()));
        if (connection.recording)
            throw RequestRefused("record: one connection records one device; connect once more");
        RecordingService& service = recordings[request.device];
        const protocol::Recording recording = service.begin(tables[request.device]->device());
        connection.recording = request.device;
        const std::array fds{service.fd()};
        return shm::send_message(connection.socket, bytes_of(recording), fds);
    } catch (const RequestRefused& refusal) {
        return refuse(connection, refusal);
    }
}

bool Broker::Impl::watch_scenes(Connection& connection, const protocol::WatchRequest& request) {
    try {
        if (request.device >= tables.size())
            throw RequestRefused(fmt::format("watch: device {} of {}", request.device, tables.size()));
        if (connection.watching && *connection.watching != request.device)
            throw RequestRefused("watch: one connection watches one device; connect once more");
        SceneService& service = scenes[request.device];
        const protocol::Watching watching =
            service.begin(tables[request.device]->device(), !connection.watching);
        connection.watching = request.device;
        const std::array fds{service.fd()};
        return shm::send_message(connection.socket, bytes_of(watching), fds);
    } catch (const RequestRefused& refusal) {
        return refuse(connection, refusal);
    }
}

bool Broker::Impl::show_asset(const Connection& connection, const protocol::ShowAsset& request) {
    try {
        if (connection.watching != request.device)
            throw RequestRefused(
                "asset: this connection does not watch that device; send WatchRequest first");
        std::size_t shown_so_far = 0;
        for (const auto& table : tables) shown_so_far += table->shown_assets();
        const shm::Segment& memory = tables[request.device]->asset_memory(
            request.row, request.number, shown_so_far < broker_bounds::shown_assets);
        protocol::ShownAsset shown;
        shown.bytes = memory.size();
        const std::array fds{memory.fd()};
        return shm::send_message(connection.socket, bytes_of(shown), fds);
    } catch (const RequestRefused& refusal) {
        return refuse(connection, refusal);
    }
}

void Broker::Impl::require_place(const Peer& peer) const {
    std::size_t left = broker_bounds::connections;
    Share held;
    for (const auto& [id, other] : connections) {
        if (!other.greeted) continue;
        --left;
        held.count(other.peer, peer);
    }
    if (left == 0)
        throw RequestRefused::no_place(
            fmt::format("servo \"{}\" has {} connections, which is all it takes; end one", options.servo_name,
                        broker_bounds::connections));
    if (const auto who = takes_too_much(held, peer, left))
        throw RequestRefused::no_place(fmt::format("servo \"{}\": {} of its {} connections; end one",
                                                   options.servo_name, *who, broker_bounds::connections));
}

std::string Broker::Impl::is_ending() const {
    return fmt::format("servo \"{}\" is ending; start it again", options.servo_name);
}

}  // namespace knurl::servo

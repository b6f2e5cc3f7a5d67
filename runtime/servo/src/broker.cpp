#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/socket.hpp>

#include "asset_service.hpp"
#include "attach_messages.hpp"
#include "recording_service.hpp"

namespace knurl::servo {

namespace {

using SteadyClock = std::chrono::steady_clock;
using protocol::MessageType;

// The values that epoll returns. Connections are numbered from first_connection and no number is used twice.
// So an event for a connection that was closed in the same round finds none.
enum Source : std::uint64_t { listening, signalled, guardian_gone, built, first_connection };

constexpr auto collect_interval = std::chrono::milliseconds(10);
constexpr auto ramp_interval = std::chrono::milliseconds(2);
constexpr auto accept_pause = std::chrono::milliseconds(100);  // after the process has run out of descriptors

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
};

}  // namespace

struct Broker::Impl {
    explicit Impl(BrokerOptions stated)
        : options(std::move(stated)), closer(options.closer), assets(options.builder) {}
    ~Impl() {
        assets.end();  // it holds some of the sockets as well
        for (auto& [id, connection] : connections) closer.close(std::move(connection.socket));
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    BrokerOptions options;
    Closer& closer;  // of every socket on which a client may have sent something
    AssetService assets;
    std::uint64_t watched_build = 0;
    shm::UniqueFd epoll{epoll_create1(EPOLL_CLOEXEC)};
    std::vector<std::unique_ptr<ClaimTable>> tables;
    std::array<RecordingService, protocol::max_devices> recordings;
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

    void watch(int fd, std::uint64_t source) {
        epoll_event event{.events = EPOLLIN, .data = {.u64 = source}};
        if (epoll_ctl(epoll.get(), EPOLL_CTL_ADD, fd, &event) != 0) {
            throw std::runtime_error(fmt::format("knurld: epoll: {}", std::strerror(errno)));
        }
    }

    void set_offering(Connection& connection, std::uint64_t id, bool offering) {
        connection.offering = offering;
        // A hang-up is noticed in any case.
        epoll_event event{.events = std::uint32_t{offering ? EPOLLRDHUP : EPOLLIN}, .data = {.u64 = id}};
        epoll_ctl(epoll.get(), EPOLL_CTL_MOD, connection.socket.get(), &event);
    }

    /// While all half-open places are taken, further callers wait in the listening queue: none is refused.
    void update_listening() {
        const bool wanted = half_open < broker_bounds::half_open && SteadyClock::now() >= pause_until;
        if (wanted == listening_now) return;
        if (wanted) {
            watch(options.listener.get(), listening);
        } else {
            epoll_ctl(epoll.get(), EPOLL_CTL_DEL, options.listener.get(), nullptr);
        }
        listening_now = wanted;
    }

    void accept_one() {
        shm::UniqueFd socket;
        try {
            socket = shm::accept_from(options.listener);
        } catch (const std::runtime_error&) {
            pause_until = SteadyClock::now() + accept_pause;  // out of descriptors: wait until a client
                                                              // leaves
            tell_one_why();
            return;
        }
        if (!socket) return;
        Connection connection{.socket = std::move(socket),
                              .since = SteadyClock::now(),
                              .greeted = false,
                              .offering = false,
                              .peer = {},
                              .holdings = {},
                              .recording = {}};
        if (connections.size() >= broker_bounds::connections) {
            protocol::Refused no_place{.full = 1};
            protocol::put_text(no_place.text,
                               fmt::format("servo \"{}\" has {} connections, which is all it takes; end one",
                                           options.servo_name, broker_bounds::connections));
            shm::send_message(connection.socket, bytes_of(no_place));
            closer.close(std::move(connection.socket));
            return;
        }
        const std::uint64_t id = next_id++;
        try {
            const auto credentials = shm::credentials_of(connection.socket);
            connection.peer.pid = credentials.pid;
            connection.peer.uid = credentials.uid;
            watch(connection.socket.get(), id);
        } catch (const std::runtime_error&) {
            pause_until = SteadyClock::now() + accept_pause;  // the kernel has no room for another connection
            closer.close(std::move(connection.socket));
            return;
        }
        connections.emplace(id, std::move(connection));
        ++half_open;
    }

    /// When descriptors run out, one reserved descriptor serves to refuse a waiting caller with a reason.
    void tell_one_why() {
        spare.reset();
        try {
            if (shm::UniqueFd socket = shm::accept_from(options.listener)) {
                protocol::Refused no_descriptor{.full = 1};
                protocol::put_text(no_descriptor.text,
                                   fmt::format("servo \"{}\" has no descriptor left for one more client; end "
                                               "one, or raise its limit "
                                               "(ulimit -n; of the service: LimitNOFILE=)",
                                               options.servo_name));
                shm::send_message(socket, bytes_of(no_descriptor));
                closer.close(std::move(socket));
            }
        } catch (const std::runtime_error&) {  // the system is out of descriptors: the callers wait
        }
        spare = spare_descriptor();
    }

    static shm::UniqueFd spare_descriptor() {
        return shm::UniqueFd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    }

    /// False: the peer does not read its replies.
    static bool refuse(const Connection& to, const RequestRefused& why) {
        protocol::Refused message;
        message.holder_pid = static_cast<std::uint32_t>(why.holder_pid);
        protocol::put_text(message.text, why.what());
        return shm::send_message(to.socket, bytes_of(message));
    }

    void take_back(Connection::Holding& holding) {
        if (holding.stage == Connection::Stage::free) return;
        if (holding.stage == Connection::Stage::granted) --unmapped;
        holding.stage = Connection::Stage::free;
        tables[holding.device]->let_go(holding.row);
    }

    void close(std::uint64_t id) {
        const auto found = connections.find(id);
        if (found == connections.end()) return;
        for (Connection::Holding& holding : found->second.holdings) take_back(holding);
        const bool built_for = assets.cancel(id, tables);
        if (const auto device = found->second.recording) recordings[*device].end(tables[*device]->device());
        if (!found->second.greeted) --half_open;
        // Others hold the socket until the closer has closed it, so it leaves the epoll set now.
        epoll_ctl(epoll.get(), EPOLL_CTL_DEL, found->second.socket.get(), nullptr);
        closer.close(std::move(found->second.socket));
        connections.erase(found);
        if (built_for) tell_builders();  // e.g. the builder of the next asset could not be started
    }

    /// Handles what one connection has sent. Bytes that are not a valid message end it.
    void serve(std::uint64_t id) {
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
                if (!handle(connection, buffer, received.bytes)) return close(id);
            } catch (const RequestRefused& refusal) {
                refuse(connection, refusal);
                return close(id);
            } catch (const std::exception&) {  // the socket broke, or memory ran out: only this connection
                                               // ends
                return close(id);
            }
        }
    }

    /// False: the peer does not read its replies. Throws RequestRefused: the connection ends.
    bool handle(Connection& connection, const Buffer& buffer, std::size_t bytes) {
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
                return serve_claim(connection, read_message<protocol::Mapped>(buffer, bytes, "claim"));
            case static_cast<std::uint32_t>(MessageType::release):
                release(connection, read_message<protocol::Release>(buffer, bytes, "release"));
                return true;
            case static_cast<std::uint32_t>(MessageType::record):
                return record(connection, read_message<protocol::RecordRequest>(buffer, bytes, "record"));
            case static_cast<std::uint32_t>(MessageType::asset_forget):
                assets.forget(read_message<protocol::AssetForget>(buffer, bytes, "asset"), tables);
                return true;
            default:
                throw RequestRefused(
                    fmt::format("attach: message type {} is not one that a client sends here", *type));
        }
    }

    bool greet(Connection& connection, const Buffer& buffer, std::size_t bytes) {
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

    std::string is_ending() const {
        return fmt::format("servo \"{}\" is ending; start it again", options.servo_name);
    }

    bool claim(Connection& connection, const protocol::ClaimRequest& request) {
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

    /// The client has mapped a claim. False: the peer does not read its replies.
    bool serve_claim(Connection& connection, const protocol::Mapped& mapped) {
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
                take_back(*held);
                throw RequestRefused(is_ending());
            }
            --unmapped;
            tables[held->device]->serve(held->row);
        } catch (const RequestRefused& refusal) {
            connection.holdings.erase(held);
            return refuse(connection, refusal);
        }
        held->stage = Connection::Stage::served;
        protocol::Serving serving;
        serving.key = held->key;
        return shm::send_message(connection.socket, bytes_of(serving));
    }

    void release(Connection& connection, const protocol::Release& release) {
        const auto held = std::find_if(connection.holdings.begin(), connection.holdings.end(),
                                       [&](const Connection::Holding& h) {
                                           return h.device == release.device && h.row == release.slot &&
                                                  h.stage != Connection::Stage::free;
                                       });
        if (held == connection.holdings.end())
            throw RequestRefused("release: this connection does not hold that claim");
        take_back(*held);
        connection.holdings.erase(held);
    }

    void take_back_unmapped() {
        if (unmapped == 0) return;
        const auto latest = SteadyClock::now() - std::chrono::duration<double>(protocol::mapping_seconds);
        std::vector<std::uint64_t> deaf;
        for (auto& [id, connection] : connections) {
            for (Connection::Holding& holding : connection.holdings) {
                if (holding.stage != Connection::Stage::granted || holding.since >= latest) continue;
                take_back(holding);
                const RequestRefused why(
                    fmt::format("claim of device \"{}\": its memory was not mapped within {:g} s; claim it "
                                "again",
                                tables[holding.device]->device().name, protocol::mapping_seconds));
                if (!refuse(connection, why)) deaf.push_back(id);
            }
        }
        for (const std::uint64_t id : deaf) close(id);
    }

    /// The message with the descriptor stays in the socket until the builder takes it. Throws RequestRefused:
    /// the connection ends, as nobody here may take it.
    void offer(std::uint64_t id, Connection& connection, const protocol::AssetOffer& message) {
        assets.offer(id, message, connection.socket.get(), tables);
        set_offering(connection, id, true);
        watch_build();
        tell_builders();  // the builder could not be started
    }

    /// The build queue runs another process, or none.
    void watch_build() {
        if (assets.builds() == watched_build) return;
        watched_build = assets.builds();
        if (assets.event() >= 0) watch(assets.event(), built);
    }

    void forget_quietly(const protocol::AssetForget& message) {
        try {
            assets.forget(message, tables);
        } catch (const RequestRefused&) {  // the claim is gone, and its assets too
        }
    }

    void tell_builders() {
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

    bool record(Connection& connection, const protocol::RecordRequest& request) {
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

    void begin_to_end(End why) {
        if (ending) {
            if (why == End::asked) ending = End::at_once;
            return;
        }
        ending = why;
        ending_since = SteadyClock::now();
        asked_to_end.assign(tables.size(), false);
    }

    /// Is every device at rest, or has its time run out?
    bool at_rest() {
        if (SteadyClock::now() - ending_since >
            std::chrono::duration<double>(broker_bounds::ramp_down_seconds)) {
            return true;
        }
        bool rest = true;
        for (std::size_t i = 0; i < tables.size(); ++i) {
            const HostedDevice& device = tables[i]->device();
            if (!asked_to_end[i]) asked_to_end[i] = device.servo.drop_all();
            const shm::BroadcastReader reports(device.segment.data() + protocol::device_layout().reports,
                                               protocol::report_slots, sizeof(Report));
            Report report;
            const bool known = reports.published() > 0 && reports.at(reports.published() - 1, &report);
            rest = rest && asked_to_end[i] && known && report.state != DeviceState::ramp_up &&
                   report.state != DeviceState::active && report.state != DeviceState::ramp_down;
        }
        return rest;
    }

    void drop_silent_callers() {
        if (half_open == 0) return;
        const auto latest = SteadyClock::now() - std::chrono::duration<double>(broker_bounds::hello_seconds);
        std::vector<std::uint64_t> silent;
        for (const auto& [id, connection] : connections) {
            if (!connection.greeted && connection.since < latest) silent.push_back(id);
        }
        for (std::uint64_t id : silent) {
            refuse(connections.at(id), RequestRefused(fmt::format("attach: no Hello within {:g} s",
                                                                  broker_bounds::hello_seconds)));
            close(id);
        }
    }

    /// Whatever has happened at this source.
    void answer(std::uint64_t source) {
        switch (source) {
            case listening:
                return accept_one();
            case signalled: {
                signalfd_siginfo signal;
                if (read(options.signals.get(), &signal, sizeof signal) == sizeof signal)
                    begin_to_end(End::asked);
                return;
            }
            case built:
                return tell_builders();
            case guardian_gone:
                epoll_ctl(epoll.get(), EPOLL_CTL_DEL, options.guardian_pidfd, nullptr);
                return begin_to_end(End::guardian_died);
            default:
                serve(source);
        }
    }

    int patience_ms(bool collecting) const {
        using std::chrono::milliseconds;
        auto patience = milliseconds(-1);
        const auto at_most = [&](milliseconds t) {
            patience = patience.count() < 0 ? t : std::min(patience, t);
        };
        if (ending) at_most(ramp_interval);
        if (collecting) at_most(collect_interval);
        if (half_open > 0 || unmapped > 0 || pause_until > SteadyClock::now()) at_most(accept_pause);
        return static_cast<int>(patience.count());
    }
};

Broker::Broker(BrokerOptions options, std::vector<HostedDevice> devices, shm::Waker& waker)
    : impl_(std::make_unique<Impl>(std::move(options))) {
    for (HostedDevice& device : devices) {
        impl_->tables.push_back(std::make_unique<ClaimTable>(std::move(device), waker));
    }
    impl_->watch(impl_->options.signals.get(), signalled);
    if (impl_->options.guardian_pidfd >= 0) impl_->watch(impl_->options.guardian_pidfd, guardian_gone);
}

Broker::~Broker() = default;

Broker::End Broker::run() {
    for (;;)
        if (const auto end = turn()) return *end;
}

std::optional<Broker::End> Broker::turn(int most_ms) {
    Impl& self = *impl_;
    bool collecting = false;
    for (const auto& table : self.tables) collecting |= table->collect();
    self.drop_silent_callers();
    self.take_back_unmapped();
    self.update_listening();
    if (self.ending && (*self.ending == End::at_once || self.at_rest())) return *self.ending;

    const int patience = self.patience_ms(collecting);
    std::array<epoll_event, 32> events;
    const int count = epoll_wait(self.epoll.get(), events.data(), static_cast<int>(events.size()),
                                 most_ms >= 0 && (patience < 0 || patience > most_ms) ? most_ms : patience);
    if (count < 0 && errno != EINTR)
        throw std::runtime_error(fmt::format("knurld: epoll_wait: {}", std::strerror(errno)));
    for (int i = 0; i < count; ++i) self.answer(events[static_cast<std::size_t>(i)].data.u64);
    return std::nullopt;
}

}  // namespace knurl::servo

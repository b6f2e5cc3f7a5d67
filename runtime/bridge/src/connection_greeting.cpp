// How a connection begins: TCP, TLS, identities, and the check that datagrams get through.

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <netinet/in.h>
#include <poll.h>

#include <knurl/bridge/keys.hpp>
#include <knurl/link/clock.hpp>
#include <knurl/link/text.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/shm/deadline.hpp>
#include <knurl/shm/waiter.hpp>

#include "connection.hpp"
#include "datagram_socket.hpp"

namespace knurl::bridge {

namespace {

constexpr std::size_t udp_bytes = 8, ip4_bytes = 20, ip6_bytes = 40;  // of the headers

shm::UniqueFd begin_to_connect(const Endpoint& bridge) {
    shm::UniqueFd fd(::socket(bridge.family(), SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    // An error now appears again when the connection's state is read.
    if (fd && ::connect(fd.get(), bridge.get(), bridge.length) != 0 && errno != EINPROGRESS &&
        errno != ECONNREFUSED)
        throw Error(Error::Kind::no_servo,
                    detail::format("bridge {}: cannot connect ({}); is the address right?", bridge.text,
                                   std::strerror(errno)));
    if (!fd)
        throw Error(Error::Kind::refused,
                    detail::format("bridge {}: no socket ({})", bridge.text, std::strerror(errno)));
    return fd;
}

/// As guaranteed by a servo's own rows, so that later computations need no check.
bool sane(const DeviceRow& row) {
    return row.rate > 0 && std::isfinite(row.rate) && to_eigen(row.workspace_centre).allFinite() &&
           std::isfinite(row.workspace_radius) && row.workspace_radius >= 0 && row.peak_force >= 0 &&
           row.peak_torque >= 0 && row.max_stiffness >= 0 && protocol::is_name(text_of(row.name));
}

std::shared_ptr<const TlsContext> key_of(const std::string& file) {
    if (file.empty()) return nullptr;
    try {
        const std::vector<Key> keys = read_keys(file, KeysOf::application);
        if (keys.size() != 1)
            throw std::runtime_error(detail::format(
                "{}: holds {} keys; an application uses one: give it a file with just the line "
                "that is its own",
                file, keys.size()));
        return TlsContext::client(keys.front());
    } catch (const std::runtime_error& reason) {
        throw Error(Error::Kind::permission, reason.what());
    }
}

}  // namespace

Connection::Connection(const Endpoint& bridge, const RemoteOptions& options)
    : bridge_(bridge),
      answer_time_(options.answer_time),
      report_rate_(options.report_rate),
      frames_(begin_to_connect(bridge), false, key_of(options.key_file),
              {.payload = max_frame_bytes, .outgoing = 2 * max_frame_bytes + CongestionWindow::most}),
      frames_lost_in_child_(std::in_place, frames_.fd()),
      stop_(shm::make_event()) {
    const shm::Deadline deadline = shm::deadline_after(answer_time_);
    connect(deadline);
    greet(options.client_name, deadline);
    clock_socket_ = datagram_socket();
    try_datagrams(deadline);
    started_ns_ = heard_ns_ = last_tick_ns_ = detail::monotonic_ns();
}

void Connection::broken() const {
    const std::string& reason = frames_.reason();
    const FrameStream::End how = frames_.how_it_ended();
    if (how == FrameStream::End::foreign) nonsense();
    if (how == FrameStream::End::unreachable)
        throw Error(
            Error::Kind::no_servo,
            detail::format("no bridge listens at {} ({}); start one there: `knurl-bridge --listen HOST:PORT`",
                           bridge_.text, reason));
    throw Error(how == FrameStream::End::keys ? Error::Kind::permission : Error::Kind::disconnected,
                detail::format("bridge {}: {}", bridge_.text, reason.empty() ? "it hung up" : reason));
}

void Connection::nonsense() const {
    throw Error(
        Error::Kind::incompatible,
        detail::format(
            "what answers at {} is no knurl-bridge of this version; is that its port ({}, unless it was "
            "given another)? If it is, build the application and the bridge from the same version",
            bridge_.text, default_port));
}

Error Connection::refusal(const Refused& refused) const {
    const auto most = static_cast<std::uint32_t>(Error::Kind::exhausted);
    return {
        static_cast<Error::Kind>(std::min(refused.kind, most)),
        refused.text[0] != '\0'
            ? protocol::printable(refused.text)
            : detail::format("bridge {} refuses the connection without a reason; see its log", bridge_.text),
        static_cast<pid_t>(refused.holder_pid)};
}

/// Waits until data arrives, or waiting data can be sent.
void Connection::await_socket(shm::Deadline deadline) {
    pollfd socket{.fd = frames_.fd(),
                  .events = static_cast<short>(POLLIN | (frames_.wants_write() ? POLLOUT : 0)),
                  .revents = 0};
    if (shm::poll_until({&socket, 1}, deadline) == 0)
        throw Error(
            Error::Kind::no_servo,
            detail::format("bridge {} does not answer (waited {} ms); is the address right, and does a "
                           "firewall let TCP and UDP through?",
                           bridge_.text, answer_time_.count()));
}

void Connection::connect(shm::Deadline deadline) {
    while (frames_.pump() == FrameStream::State::handshaking) await_socket(deadline);
    if (frames_.state() == FrameStream::State::closed) broken();
}

const Frame* Connection::await_frame(shm::Deadline deadline) {
    for (;;) {
        if (const Frame* frame = frames_.next()) return frame;
        if (frames_.state() == FrameStream::State::closed) broken();
        await_socket(deadline);
        frames_.pump();
    }
}

void Connection::greet(const std::string& name, shm::Deadline deadline) {
    Hello hello;
    hello.layout = wire_hash();
    put_text(hello.client, name);
    frames_.send(static_cast<std::uint16_t>(FrameType::hello), 0, bytes_of(hello));
    const Frame* frame = await_frame(deadline);
    if (frame->type == static_cast<std::uint16_t>(FrameType::welcome)) return welcome(frame->payload);
    std::span<const std::byte> payload = frame->payload;
    Refused refused;
    if (frame->type != static_cast<std::uint16_t>(FrameType::refused) || !take(payload, refused)) nonsense();
    throw refusal(refused);
}

void Connection::welcome(std::span<const std::byte> payload) {
    Welcome welcome;
    if (!take(payload, welcome) || welcome.devices > protocol::max_devices ||
        payload.size() != welcome.devices * sizeof(DeviceRow))
        nonsense();
    for (DeviceRow row; take(payload, row);) {
        if (!sane(row)) nonsense();
        devices_.push_back(detail::describe(row));
    }
    servo_pid_ = static_cast<pid_t>(welcome.servo_pid);
    const std::optional<DirectionKeys> keys = frames_.export_keys(exporter_label);
    outgoing_ = OutgoingDatagrams(welcome.session, keys ? &keys->send : nullptr);
    incoming_ = IncomingDatagrams(welcome.session, keys ? &keys->receive : nullptr);
}

shm::UniqueFd Connection::datagram_socket() const {
    shm::UniqueFd fd = make_datagram_socket(bridge_.family());
    if (!fd || ::connect(fd.get(), bridge_.get(), bridge_.length) != 0)
        throw Error(Error::Kind::refused,
                    detail::format("bridge {}: no socket for datagrams ({}); see the limit of open "
                                   "files (ulimit -n)",
                                   bridge_.text, std::strerror(errno)));
    return fd;
}

void Connection::try_datagrams(shm::Deadline deadline) {
    constexpr std::int64_t patience_ms = 50;
    for (std::int64_t next = 0; longest_.bytes(detail::monotonic_ns()) < least_datagram_bytes;) {
        if (std::chrono::steady_clock::now() > deadline) no_datagrams();
        const std::int64_t now = detail::monotonic_ns();
        if (now >= next) {
            ping(now);
            // sent before the awaited one: if it gets through, it arrives first
            ping(now, datagram_bytes);
            ping(now, least_datagram_bytes);
            next = now + patience_ms * 1'000'000;
        }
        pollfd socket{.fd = clock_socket_.get(), .events = POLLIN, .revents = 0};
        ::poll(&socket, 1, patience_ms);
        serve_clock();
    }
    next_ping_ns_ = 0;  // the first one reports what has arrived
}

void Connection::no_datagrams() const {
    if (clock_.known())
        throw Error(
            Error::Kind::no_servo,
            detail::format(
                "bridge {}: the path to it carries small datagrams only, and none of {} bytes, "
                "which a report needs; raise the MTU of the narrowest link (a tunnel?) to {} or "
                "more",
                bridge_.text, least_datagram_bytes,
                least_datagram_bytes + udp_bytes + (bridge_.family() == AF_INET6 ? ip6_bytes : ip4_bytes)));
    throw Error(Error::Kind::no_servo,
                detail::format("bridge {} answers by TCP, but no datagram of it comes here; let UDP port {} "
                               "through the firewalls between",
                               bridge_.text, bridge_.port()));
}

}  // namespace knurl::bridge

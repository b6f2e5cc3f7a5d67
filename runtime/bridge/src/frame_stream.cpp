#include "frame_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "system_text.hpp"

namespace knurl::bridge {

using Io = TlsSession::Io;

namespace {

constexpr std::size_t header_bytes = sizeof(FrameHeader);
constexpr std::size_t record_start = 3;        // bytes that identify a TLS record
constexpr std::size_t read_ahead = 16 * 1024;  // room for a TLS record of following frames

}  // namespace

FrameStream::FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls)
    : FrameStream(std::move(fd), server, std::move(tls), Limits{}) {}

FrameStream::FrameStream(shm::UniqueFd fd, bool server, std::shared_ptr<const TlsContext> tls, Limits limits)
    : FrameStream(std::move(fd), server, limits) {
    if (tls) tls_.emplace(std::move(tls), fd_.get());
}

FrameStream::FrameStream(shm::UniqueFd fd, std::optional<TlsSession> tls, Limits limits)
    : FrameStream(std::move(fd), true, limits) {
    if (tls) tls_.emplace(std::move(*tls));
}

// The pages of the buffers take memory when first written, so a peer that sends little costs little.
FrameStream::FrameStream(shm::UniqueFd fd, bool server, Limits limits)
    : fd_(std::move(fd)),
      server_(server),
      limits_(limits),
      max_payload_(limits.payload),
      in_(std::make_unique_for_overwrite<std::byte[]>(header_bytes + limits.payload + read_ahead)),
      out_(std::make_unique_for_overwrite<std::byte[]>(
          std::max(limits.outgoing, header_bytes + limits.payload))),
      in_capacity_(header_bytes + limits.payload + read_ahead),
      out_capacity_(std::max(limits.outgoing, header_bytes + limits.payload)) {
    const int flags = ::fcntl(fd_.get(), F_GETFL);
    ::fcntl(fd_.get(), F_SETFL, flags | O_NONBLOCK);
    // A frame is sent when it is complete, so delaying it for more data gains nothing. (Harmless on a Unix
    // socket.)
    const int on = 1;
    ::setsockopt(fd_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

FrameStream::~FrameStream() = default;

FrameStream::State FrameStream::pump() noexcept {
    if (state_ == State::handshaking) connect_and_handshake();
    if (state_ == State::open) read_some(From::socket);
    if (state_ == State::open) write_some();
    return state_;
}

void FrameStream::connect_and_handshake() noexcept {
    if (!connected_) {
        pollfd socket{.fd = fd_.get(), .events = POLLOUT, .revents = 0};
        if (::poll(&socket, 1, 0) <= 0) return;
        int error = 0;
        socklen_t bytes = sizeof error;
        ::getsockopt(fd_.get(), SOL_SOCKET, SO_ERROR, &error, &bytes);
        // Linux reports a failed connect once by SO_ERROR; the hang-up stays.
        if (error != 0 || (socket.revents & POLLERR) != 0) {
            error_ = error != 0 ? error : ECONNREFUSED;
            return end(End::unreachable, "cannot connect: ");
        }
        connected_ = true;
    }
    if (!tls_) {
        state_ = State::open;
        return;
    }
    const Io io = tls_->handshake();
    if (io == Io::done) state_ = State::open;
    if (io == Io::failed) end_of_tls();
    if (io == Io::closed) end(End::broken, "the peer closed the connection in the handshake");
}

TlsSession::Moved FrameStream::read(std::span<std::byte> into) noexcept {
    if (tls_) return tls_->read(into);
    const ssize_t got = ::recv(fd_.get(), into.data(), into.size(), MSG_DONTWAIT);
    if (got > 0) return {.io = Io::done, .bytes = static_cast<std::size_t>(got)};
    if (got == 0) return {.io = Io::closed};
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {.io = Io::again};
    error_ = errno;
    return {.io = Io::failed};
}

TlsSession::Moved FrameStream::write(std::span<const std::byte> from) noexcept {
    if (tls_) return tls_->write(from);
    const ssize_t sent = ::send(fd_.get(), from.data(), from.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent >= 0) return {.io = Io::done, .bytes = static_cast<std::size_t>(sent)};
    if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return {.io = Io::again};
    error_ = errno;
    return {.io = Io::failed};
}

/// Bounded by the buffer: what a faster sender sends waits in its own socket.
void FrameStream::read_some(From from) noexcept {
    if (in_begin_ == in_end_) in_begin_ = in_end_ = 0;
    if (in_begin_ > 0 && in_capacity_ - in_end_ < read_ahead) {
        std::memmove(in_.get(), in_.get() + in_begin_, in_end_ - in_begin_);
        in_end_ -= in_begin_;
        in_begin_ = 0;
    }
    while (in_end_ < in_capacity_) {
        if (from == From::decrypted && tls_->pending() == 0) return;
        const auto [io, bytes] = read({in_.get() + in_end_, in_capacity_ - in_end_});
        if (io == Io::again) return;
        if (io == Io::failed) return end_of_socket();
        if (io == Io::closed) {
            const bool silent = !server_ && first_frame_ && in_end_ == 0;
            if (!silent) return end(End::in_order, "");
            return end(End::broken, "the other end hung up without a word: no bridge, or it is full");
        }
        in_end_ += bytes;
    }
}

void FrameStream::write_some() noexcept {
    while (out_begin_ < out_end_) {
        const auto [io, bytes] = write({out_.get() + out_begin_, out_end_ - out_begin_});
        if (io == Io::again) return;
        if (io != Io::done) {
            // The peer's last words (e.g. why it refuses) may still be readable.
            const int error = error_;
            read_some(From::socket);
            if (state_ == State::closed) return;
            error_ = error;
            return end_of_socket();
        }
        out_begin_ += bytes;
    }
    out_begin_ = out_end_ = 0;
}

bool FrameStream::send(std::uint16_t type, std::uint16_t stream,
                       std::span<const std::span<const std::byte>> parts) noexcept {
    std::size_t bytes = 0;
    for (const auto part : parts) {
        if (part.size() > limits_.payload - bytes) return false;
        bytes += part.size();
    }
    if (bytes == 0 || state_ == State::closed || out_capacity_ - queued() < header_bytes + bytes)
        return false;
    if (out_capacity_ - out_end_ < header_bytes + bytes) {
        std::memmove(out_.get(), out_.get() + out_begin_, queued());
        out_end_ -= out_begin_;
        out_begin_ = 0;
    }
    const FrameHeader header{.bytes = static_cast<std::uint32_t>(bytes), .type = type, .stream = stream};
    std::memcpy(out_.get() + out_end_, &header, header_bytes);
    out_end_ += header_bytes;
    for (const auto part : parts) {
        if (!part.empty()) std::memcpy(out_.get() + out_end_, part.data(), part.size());
        out_end_ += part.size();
    }
    if (state_ == State::open) write_some();
    return true;
}

bool FrameStream::send(std::uint16_t type, std::uint16_t stream,
                       std::span<const std::byte> payload) noexcept {
    return send(type, stream, {&payload, 1});
}

const Frame* FrameStream::next() noexcept {
    if (const Frame* frame = take()) return frame;
    if (tls_ && state_ == State::open && tls_->pending() > 0) {
        read_some(From::decrypted);
        if (const Frame* frame = take()) return frame;
    }
    if (state_ == State::closed && in_begin_ != in_end_ && reason_.empty())
        end(End::broken, "the peer hung up in the middle of a frame");
    return nullptr;
}

const Frame* FrameStream::take() noexcept {
    const std::size_t there = in_end_ - in_begin_;
    if (first_frame_ && !tls_ && there >= record_start && begins_as_tls()) {
        in_begin_ = in_end_ = 0;
        if (server_) {
            // Plain bytes show the peer's TLS that this end has no keys.
            constexpr std::string_view plain = "no keys here";
            [[maybe_unused]] const ssize_t sent =
                ::send(fd_.get(), plain.data(), plain.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        }
        end(End::keys, server_ ? "the peer uses a key, and this bridge has none; start it with --keys, or "
                                 "leave KNURL_KEY unset at the peer"
                               : "the bridge wants a key; set KNURL_KEY to a file that holds yours");
        return nullptr;
    }
    if (there < header_bytes) return nullptr;
    FrameHeader header;
    std::memcpy(&header, in_.get() + in_begin_, header_bytes);
    if (header.bytes == 0 || header.bytes > max_payload_) {
        // The rest cannot be parsed any more.
        in_begin_ = in_end_ = 0;
        end(!server_ && first_frame_ ? End::foreign : End::broken,
            header.bytes == 0 ? "a frame of length zero came"
                              : "a frame came that is longer than is allowed here");
        return nullptr;
    }
    if (there < header_bytes + header.bytes) return nullptr;
    frame_ = {.type = header.type,
              .stream = header.stream,
              .payload = {in_.get() + in_begin_ + header_bytes, header.bytes}};
    in_begin_ += header_bytes + header.bytes;
    first_frame_ = false;
    return &frame_;
}

/// A TLS record: handshake (22) or alert (21), then version 3.1 or 3.3. Read as the length of a frame that is
/// above 64 KiB, more than any greeting.
bool FrameStream::begins_as_tls() const noexcept {
    const auto at = [&](std::size_t i) { return std::to_integer<int>(in_[in_begin_ + i]); };
    return (at(0) == 21 || at(0) == 22) && at(1) == 3 && (at(2) == 1 || at(2) == 3);
}

bool FrameStream::wants_write() const noexcept {
    if (state_ == State::closed) return false;
    if (!connected_) return true;
    return state_ == State::handshaking ? tls_->wants_write() : queued() > 0;
}

void FrameStream::limit_payload(std::size_t bytes) noexcept {
    max_payload_ = std::min(bytes, limits_.payload);
}

std::string_view FrameStream::peer_identity() const noexcept {
    return tls_ ? tls_->peer_identity() : std::string_view();
}

std::optional<DirectionKeys> FrameStream::export_keys(std::string_view label) const noexcept {
    DirectionKeys keys;
    if (!tls_ || !tls_->export_keys(label, keys)) return std::nullopt;
    return keys;
}

void FrameStream::end_of_tls() noexcept {
    end(tls_->about_keys() ? End::keys : End::broken, tls_->reason());
}

void FrameStream::end_of_socket() noexcept {
    if (tls_) return end_of_tls();
    end(End::broken, "the connection broke: ");
}

void FrameStream::end(End how, std::string_view why) noexcept {
    state_ = State::closed;
    end_ = how;
    try {
        reason_ = why;
        if (why.ends_with(": ")) reason_ += system_text(error_);
    } catch (const std::bad_alloc&) {
        reason_.clear();
    }
}

void FrameStream::close() noexcept {
    if (state_ == State::open) write_some();
    if (state_ == State::closed) return;
    if (tls_) tls_->close();
    ::shutdown(fd_.get(), SHUT_RDWR);
    state_ = State::closed;
}

}  // namespace knurl::bridge

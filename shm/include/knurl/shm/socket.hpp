#pragma once

/// @file
/// Unix SOCK_SEQPACKET sockets: whole messages, which may carry file descriptors. Never used by the servo's
/// thread.

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <sys/types.h>

#include <knurl/shm/error.hpp>
#include <knurl/shm/fd.hpp>

namespace knurl::shm {

/// A message carries at most this many descriptors; one with more is received without any.
inline constexpr std::size_t max_fds = 16;

/// Listens at `path` with the file mode `mode`. A socket that a dead process left behind is replaced; throws
/// std::runtime_error if a live one answers there, or if the path cannot be used. The listener does not
/// block.
UniqueFd listen_at(const std::filesystem::path& path, mode_t mode, int backlog);

/// Connects to `path`; the socket blocks. Throws SystemError if nobody listens there. Where the listener's queue
/// is full it waits for a place, at most `timeout` (then SystemError with EAGAIN); 0: without an end.
UniqueFd connect_to(const std::filesystem::path& path, std::chrono::milliseconds timeout = {});

/// The next connection, or an empty UniqueFd if none is pending. Throws SystemError if the listener is broken
/// or the process is out of descriptors.
UniqueFd accept_from(int listener);
/// The same.
inline UniqueFd accept_from(const UniqueFd& listener) {
    return accept_from(listener.get());
}

/// Sends one message, never blocking, never raising SIGPIPE. False if the peer is gone or does not read (its
/// buffer is full): either way it is lost to us. Throws std::runtime_error on a mistake of our own (too
/// large, bad fd).
bool send_message(int fd, std::span<const std::byte> bytes, std::span<const int> fds = {});
/// The same.
inline bool send_message(const UniqueFd& fd, std::span<const std::byte> bytes,
                         std::span<const int> fds = {}) {
    return send_message(fd.get(), bytes, fds);
}

/// What receive_message received.
struct Received {
    /// Bytes of the buffer that were filled.
    std::size_t bytes = 0;
    /// Descriptors that came with it, close-on-exec.
    std::vector<UniqueFd> fds;
    /// True: the peer is gone, nothing will come any more.
    bool closed = false;
    /// True: it did not fit the buffer or had too many descriptors; its descriptors are closed.
    bool truncated = false;
    /// True: this process has no descriptor left for those that came.
    bool descriptors_lost = false;
    /// True: it carries descriptors, so it was left where it is (receive_plain_message).
    bool carries_descriptors = false;
    /// True: nothing is there (Block::no).
    bool nothing = false;
};
/// Whether to wait for a message.
enum class Block {
    /// Wait.
    yes,
    /// Return at once.
    no,
};

/// Receives one message. Descriptors are owned by the result, so they never leak.
Received receive_message(int fd, std::span<std::byte> buffer, Block block = Block::yes);
/// The same.
inline Received receive_message(const UniqueFd& fd, std::span<std::byte> buffer, Block block = Block::yes) {
    return receive_message(fd.get(), buffer, block);
}

/// Takes the next message of a peer that is not trusted, if it carries no descriptors. Else its bytes are
/// filled in and it is left in the socket: `carries_descriptors`. Descriptors that are received, or thrown away
/// with the message, are closed by this thread, and the sender can make that take any time. Does not block.
Received receive_plain_message(int fd, std::span<std::byte> buffer);
/// The same.
inline Received receive_plain_message(const UniqueFd& fd, std::span<std::byte> buffer) {
    return receive_plain_message(fd.get(), buffer);
}

/// Takes the next message of a peer that is not trusted, with every descriptor that it carries, and closes
/// none: for a process that has to answer before closing them may hold it up. Does not block.
Received receive_every_descriptor(int fd, std::span<std::byte> buffer);

/// Who is at the other end, as the kernel recorded it when the connection was made.
struct PeerCredentials {
    /// Process number.
    pid_t pid = 0;
    /// User.
    uid_t uid = 0;
    /// Group.
    gid_t gid = 0;
};
/// Who is at the other end. Throws std::runtime_error.
PeerCredentials credentials_of(int fd);
/// The same.
inline PeerCredentials credentials_of(const UniqueFd& fd) {
    return credentials_of(fd.get());
}

}  // namespace knurl::shm

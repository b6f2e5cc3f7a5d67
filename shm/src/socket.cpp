#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <knurl/shm/socket.hpp>

#include "system_error.hpp"

namespace knurl::shm {

namespace {

UniqueFd new_socket(int flags) {
    UniqueFd fd(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | flags, 0));
    if (!fd) throw_errno("Unix socket: cannot create", "see the limits of this process");
    return fd;
}

sockaddr_un address_of(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string& name = path.native();
    if (name.empty() || name.size() >= sizeof address.sun_path)
        throw SystemError("socket " + name + ": the path has " + std::to_string(name.size()) +
                              " characters, the kernel takes at most " +
                              std::to_string(sizeof address.sun_path - 1) +
                              "; use a shorter folder (KNURL_RUNTIME_DIR) or a shorter name",
                          ENAMETOOLONG);
    name.copy(address.sun_path, name.size());
    return address;
}

const sockaddr* generic(const sockaddr_un& address) {
    return reinterpret_cast<const sockaddr*>(&address);
}

/// Removes the socket of a dead process. Only a connection attempt shows whether a process is alive.
void take_over(const std::filesystem::path& path, const sockaddr_un& address) {
    struct stat status {};
    if (::lstat(path.c_str(), &status) != 0) return;
    if (!S_ISSOCK(status.st_mode))
        throw std::runtime_error("socket " + path.string() + ": a file of that name exists; remove it");
    const UniqueFd probe = new_socket(SOCK_NONBLOCK);
    if (::connect(probe.get(), generic(address), sizeof address) == 0 || errno == EAGAIN)
        throw std::runtime_error("socket " + path.string() + ": another servo named " + path.stem().string() +
                                 " is running; stop it or choose another name");
    if (errno == ENOENT) return;
    if (errno != ECONNREFUSED)
        throw_errno("socket " + path.string() + ": cannot tell who has it", "remove it");
    if (::unlink(path.c_str()) != 0 && errno != ENOENT)
        throw_errno("socket " + path.string() + ": cannot replace the one left behind", "remove it");
}

/// Whoever may remove a socket may put another in its place, and would be sent what is meant for this one.
void require_safe_folder(const std::filesystem::path& folder) {
    struct stat status {};
    if (::stat(folder.c_str(), &status) != 0)
        throw_errno("folder " + folder.string() + ": cannot open", "create it, owned by this user");
    if (status.st_uid != ::geteuid() && status.st_uid != 0)
        throw std::runtime_error(
            "folder " + folder.string() + " belongs to user " + std::to_string(status.st_uid) +
            ", who could replace the socket; use one of this user's (KNURL_RUNTIME_DIR)");
    if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (status.st_mode & S_ISVTX) == 0)
        throw std::runtime_error("folder " + folder.string() +
                                 ": others may write there and could replace the socket; run: chmod go-w " +
                                 folder.string());
}

/// A lock from the probe until this process listens. Otherwise two processes that start together both find the
/// dead socket, and the slower one removes the faster one's live socket.
class StartLock {
  public:
    /// Nobody else can open the file, so nobody else can hold the lock.
    explicit StartLock(const std::filesystem::path& socket)
        : path_(std::filesystem::path(socket).replace_extension(".lock")) {
        using namespace std::chrono_literals;
        constexpr int attempts = 200;
        for (int i = 0; i < attempts; ++i) {
            fd_ = UniqueFd(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
            if (!fd_) throw_errno("file " + path_.string() + ": cannot open", "see the rights of its folder");
            if (::flock(fd_.get(), LOCK_EX | LOCK_NB) == 0 && still_there()) return;
            std::this_thread::sleep_for(10ms);
        }
        throw std::runtime_error("file " + path_.string() +
                                 ": another servo has been starting for 2 s; try again, or remove the file");
    }
    ~StartLock() { ::unlink(path_.c_str()); }  // while it is locked: see still_there
    StartLock(const StartLock&) = delete;
    StartLock& operator=(const StartLock&) = delete;

  private:
    /// The one before may have removed the file between open and flock.
    bool still_there() const {
        struct stat named {
        }, locked{};
        return ::lstat(path_.c_str(), &named) == 0 && ::fstat(fd_.get(), &locked) == 0 &&
               named.st_ino == locked.st_ino && named.st_dev == locked.st_dev;
    }

    std::filesystem::path path_;
    UniqueFd fd_;
};

}  // namespace

UniqueFd listen_at(const std::filesystem::path& path, mode_t mode, int backlog) {
    const sockaddr_un address = address_of(path);
    require_safe_folder(path.has_parent_path() ? path.parent_path() : ".");
    const StartLock lock(path);
    take_over(path, address);
    UniqueFd fd = new_socket(SOCK_NONBLOCK);
    if (::bind(fd.get(), generic(address), sizeof address) != 0)
        throw_errno("socket " + path.string() + ": cannot bind", "see the rights of its folder");
    // Before listen: until then nobody can connect, whatever the mode was.
    if (::chmod(path.c_str(), mode) != 0 || ::listen(fd.get(), backlog) != 0)
        throw_errno("socket " + path.string() + ": cannot listen", "see the rights of its folder");
    return fd;
}

UniqueFd connect_to(const std::filesystem::path& path, std::chrono::milliseconds timeout) {
    const sockaddr_un address = address_of(path);
    UniqueFd fd = new_socket(0);
    // The kernel takes a connect on a Unix socket for something to be sent.
    const timeval limit{.tv_sec = timeout.count() / 1000, .tv_usec = timeout.count() % 1000 * 1000};
    ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    while (::connect(fd.get(), generic(address), sizeof address) != 0) {
        if (errno == EINTR) continue;
        throw_errno("socket " + path.string() + ": cannot connect",
                    errno == EACCES   ? "join the group that owns it"
                    : errno == EAGAIN ? "is the servo of that name stopped?"
                                      : "is the servo of that name running?");
    }
    return fd;
}

UniqueFd accept_from(int listener) {
    UniqueFd fd(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC));
    if (fd || errno == EAGAIN || errno == ECONNABORTED || errno == EINTR) return fd;
    throw_errno("listening socket: cannot accept", "see the limits of this process");
}

bool send_message(int fd, std::span<const std::byte> bytes, std::span<const int> fds) {
    if (bytes.empty() || fds.size() > max_fds)
        throw std::runtime_error(
            "message of " + std::to_string(bytes.size()) + " bytes with " + std::to_string(fds.size()) +
            " descriptors; send 1 byte or more and at most " + std::to_string(max_fds) + " descriptors");
    iovec data{.iov_base = const_cast<std::byte*>(bytes.data()), .iov_len = bytes.size()};
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(max_fds * sizeof(int))> control{};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    if (!fds.empty()) {
        message.msg_control = control.data();
        message.msg_controllen = CMSG_SPACE(fds.size_bytes());
        cmsghdr* header = CMSG_FIRSTHDR(&message);
        header->cmsg_level = SOL_SOCKET;
        header->cmsg_type = SCM_RIGHTS;
        header->cmsg_len = CMSG_LEN(fds.size_bytes());
        std::memcpy(CMSG_DATA(header), fds.data(), fds.size_bytes());
    }
    while (::sendmsg(fd, &message, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
        if (errno == EINTR) continue;
        if (errno == EPIPE || errno == ECONNRESET || errno == EAGAIN || errno == ENOTCONN) return false;
        throw_errno("message of " + std::to_string(bytes.size()) + " bytes: cannot send",
                    "is it larger than the socket's buffer, or a descriptor closed?");
    }
    return true;
}

namespace {

/// recvmsg into `result`; false: there is no message.
bool receive(int fd, msghdr& message, int flags, Received& result) {
    ssize_t n = -1;
    // When a peer hangs up with unread data of ours, the first read reports a reset, before the peer's own
    // data.
    bool reset = false;
    do {
        n = ::recvmsg(fd, &message, flags);
    } while (n < 0 && (errno == EINTR || (errno == ECONNRESET && !std::exchange(reset, true))));
    if (n >= 0) {
        result.bytes = static_cast<std::size_t>(n);
        return true;
    }
    if (errno == EAGAIN)
        result.nothing = true;
    else if (errno == ECONNRESET || errno == EPIPE || errno == ENOTCONN)
        result.closed = true;
    else
        throw_errno("socket: cannot receive", "is the descriptor a connected socket?");
    return false;
}

/// The kernel lets nobody send more at once (SCM_MAX_FD).
constexpr std::size_t most_fds_of_a_message = 253;

/// A message with all of its descriptors.
Received receive_whole(int fd, std::span<std::byte> buffer, Block block) {
    Received result;
    // Reserves for the most that a hostile sender can send: a later bad_alloc would leak its descriptors.
    result.fds.reserve(most_fds_of_a_message);
    iovec data{.iov_base = buffer.data(), .iov_len = buffer.size()};
    alignas(cmsghdr) std::array<std::byte, CMSG_SPACE(most_fds_of_a_message * sizeof(int))> control{};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    if (!receive(fd, message, MSG_CMSG_CLOEXEC | (block == Block::no ? MSG_DONTWAIT : 0), result))
        return result;
    for (cmsghdr* header = CMSG_FIRSTHDR(&message); header != nullptr;
         header = CMSG_NXTHDR(&message, header)) {
        if (header->cmsg_level != SOL_SOCKET || header->cmsg_type != SCM_RIGHTS) continue;
        const std::size_t count = (header->cmsg_len - CMSG_LEN(0)) / sizeof(int);
        for (std::size_t i = 0; i < count; ++i) {
            int received = -1;
            std::memcpy(&received, CMSG_DATA(header) + i * sizeof received, sizeof received);
            result.fds.emplace_back(received);
        }
    }
    result.truncated = (message.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) != 0;
    result.descriptors_lost = (message.msg_flags & MSG_CTRUNC) != 0;
    result.closed = result.bytes == 0 && result.fds.empty() && !result.truncated;
    return result;
}

}  // namespace

Received receive_message(int fd, std::span<std::byte> buffer, Block block) {
    Received result = receive_whole(fd, buffer, block);
    result.truncated = result.truncated || result.fds.size() > max_fds;
    if (result.truncated) result.fds.clear();
    return result;
}

Received receive_every_descriptor(int fd, std::span<std::byte> buffer) {
    return receive_whole(fd, buffer, Block::no);
}

Received receive_plain_message(int fd, std::span<std::byte> buffer) {
    Received result;
    iovec data{.iov_base = buffer.data(), .iov_len = buffer.size()};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    // Without room for descriptors the kernel installs none, and says that there were some. To look does not
    // throw them away: the message in the socket still holds them.
    if (!receive(fd, message, MSG_PEEK | MSG_DONTWAIT, result)) return result;
    result.truncated = (message.msg_flags & MSG_TRUNC) != 0;
    result.carries_descriptors = (message.msg_flags & MSG_CTRUNC) != 0;
    if (result.carries_descriptors) return result;
    result.closed = result.bytes == 0 && !result.truncated;
    if (!result.closed) receive(fd, message, MSG_DONTWAIT, result);  // the same: nobody else reads here
    return result;
}

PeerCredentials credentials_of(int fd) {
    ucred peer{};
    socklen_t size = sizeof peer;
    if (::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0)
        throw_errno("socket: no credentials of the peer", "is it a connected Unix socket?");
    return {.pid = peer.pid, .uid = peer.uid, .gid = peer.gid};
}

}  // namespace knurl::shm

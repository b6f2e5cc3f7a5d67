#include "usb/zero_line.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

namespace knurl::drivers::usb {

namespace {

constexpr std::size_t page = 4096;
constexpr int most_handed_over = 8;  // the servo leaves at most one; a bound nevertheless

std::runtime_error failed(const char* what) {
    return std::runtime_error(std::string("usb: ") + what + ": " + std::strerror(errno));
}

/// One byte with room for one descriptor. Points into itself, so it is neither copied nor moved.
struct Letter {
    char byte = 0;
    iovec data{.iov_base = &byte, .iov_len = 1};
    alignas(cmsghdr) char control[CMSG_SPACE(sizeof(int))] = {};
    msghdr message{};

    Letter() noexcept {
        message.msg_iov = &data;
        message.msg_iovlen = 1;
        message.msg_control = control;
        message.msg_controllen = sizeof control;
    }
    Letter(const Letter&) = delete;
    Letter& operator=(const Letter&) = delete;
};

void give(int socket, int descriptor) noexcept {
    Letter letter;
    cmsghdr* header = CMSG_FIRSTHDR(&letter.message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
    sendmsg(socket, &letter.message, MSG_DONTWAIT | MSG_NOSIGNAL);
}

/// -1: the socket is empty.
int take(int socket) noexcept {
    Letter letter;
    if (recvmsg(socket, &letter.message, MSG_DONTWAIT | MSG_CMSG_CLOEXEC) <= 0) return -1;
    const cmsghdr* header = CMSG_FIRSTHDR(&letter.message);
    if (header == nullptr || header->cmsg_type != SCM_RIGHTS) return -1;
    int descriptor = -1;
    std::memcpy(&descriptor, CMSG_DATA(header), sizeof descriptor);
    return descriptor;
}

}  // namespace

ZeroLine::ZeroLine(std::span<const std::uint8_t> zero_packet)
    : length_(std::min(zero_packet.size(), packet_.size())), made_by_(getpid()) {
    std::copy_n(zero_packet.begin(), length_, packet_.begin());
    if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, ends_) != 0) throw failed("socketpair");
    void* memory = mmap(nullptr, page, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        close(ends_[0]);
        close(ends_[1]);
        throw failed("mmap");
    }
    static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
    shared_ = new (memory) std::atomic<std::uint64_t>(0);
}

ZeroLine::~ZeroLine() {
    let_go();
    close(ends_[0]);
    close(ends_[1]);
    munmap(shared_, page);
}

bool ZeroLine::forked() const noexcept {
    return getpid() != made_by_;
}

void ZeroLine::hold(int node, std::uint8_t endpoint) noexcept {
    let_go();
    endpoint_ = endpoint;
    node_ = node;
    if (!first_) give(ends_[0], node);
    first_ = false;
}

void ZeroLine::let_go() noexcept {
    // A node left there belongs to a device that is gone: while it is open it cannot be freed.
    for (int left; (left = take(ends_[1])) >= 0;) close(left);
    node_ = -1;
}

void ZeroLine::take_newest() noexcept {
    for (int i = 0; i < most_handed_over; ++i) {
        const int newer = take(ends_[1]);
        if (newer < 0) return;
        close(node_);
        node_ = newer;
    }
}

bool ZeroLine::zero() noexcept {
    shared_->fetch_add(1, std::memory_order_release);
    if (length_ == 0 || !forked()) return true;
    take_newest();
    for (int i = 0; i < tries; ++i) {
        usbdevfs_bulktransfer transfer{.ep = endpoint_,
                                       .len = static_cast<unsigned>(length_),
                                       .timeout = patience_ms,
                                       .data = packet_.data()};
        if (ioctl(node_, USBDEVFS_BULK, &transfer) == static_cast<int>(length_)) return true;
        if (unsigned halted = endpoint_; errno == EPIPE) ioctl(node_, USBDEVFS_CLEAR_HALT, &halted);
    }
    return false;
}

}  // namespace knurl::drivers::usb

#pragma once
// As many datagrams as one system call gives.

#include <array>
#include <cstddef>
#include <span>

#include <sys/socket.h>

namespace knurl::bridge {

class Mailbag {
  public:
    static constexpr std::size_t most = 32;
    static constexpr std::size_t bytes = 2048;  // of one: larger ones are nobody's of ours, and are cut off

    Mailbag() noexcept {
        for (std::size_t i = 0; i < most; ++i) {
            pieces_[i] = {.iov_base = buffers_[i].data(), .iov_len = bytes};
            messages_[i].msg_hdr = {};
            messages_[i].msg_hdr.msg_iov = &pieces_[i];
            messages_[i].msg_hdr.msg_iovlen = 1;
            messages_[i].msg_hdr.msg_name = &from_[i];
        }
    }
    Mailbag(const Mailbag&) = delete;
    Mailbag& operator=(const Mailbag&) = delete;

    /// Those that are there, never waiting. How many.
    std::size_t receive(int socket) noexcept {
        for (auto& message : messages_) message.msg_hdr.msg_namelen = sizeof(sockaddr_storage);
        const int got = ::recvmmsg(socket, messages_.data(), most, MSG_DONTWAIT, nullptr);
        return got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    std::span<std::byte> datagram(std::size_t i) noexcept {
        return {buffers_[i].data(), messages_[i].msg_len};
    }
    const sockaddr_storage& from(std::size_t i) const noexcept { return from_[i]; }
    socklen_t from_length(std::size_t i) const noexcept { return messages_[i].msg_hdr.msg_namelen; }

  private:
    std::array<std::array<std::byte, bytes>, most> buffers_;
    std::array<iovec, most> pieces_;
    std::array<mmsghdr, most> messages_;
    std::array<sockaddr_storage, most> from_;
};

}  // namespace knurl::bridge

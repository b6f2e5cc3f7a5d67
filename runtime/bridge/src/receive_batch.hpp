#pragma once
// Receives as many datagrams as one system call returns.

#include <array>
#include <cstddef>
#include <span>

#include <sys/socket.h>

#include "peer_address.hpp"

namespace knurl::bridge {

class ReceiveBatch {
  public:
    static constexpr std::size_t most = 32;
    static constexpr std::size_t bytes = 2048;  // of one datagram; a larger one is not the protocol's and is
                                                // truncated

    ReceiveBatch() noexcept {
        for (std::size_t i = 0; i < most; ++i) {
            pieces_[i] = {.iov_base = buffers_[i].data(), .iov_len = bytes};
            messages_[i].msg_hdr = {};
            messages_[i].msg_hdr.msg_iov = &pieces_[i];
            messages_[i].msg_hdr.msg_iovlen = 1;
            messages_[i].msg_hdr.msg_name = &from_[i].address;
            messages_[i].msg_hdr.msg_control = infos_[i].bytes;
        }
    }
    ReceiveBatch(const ReceiveBatch&) = delete;
    ReceiveBatch& operator=(const ReceiveBatch&) = delete;

    /// Receives the datagrams that have arrived, without waiting. Returns how many.
    std::size_t receive(int socket) noexcept {
        for (auto& message : messages_) {
            message.msg_hdr.msg_namelen = sizeof(sockaddr_storage);
            message.msg_hdr.msg_controllen = PacketInfo::room;
        }
        const int got = ::recvmmsg(socket, messages_.data(), most, MSG_DONTWAIT, nullptr);
        return got > 0 ? static_cast<std::size_t>(got) : 0;
    }
    std::span<std::byte> datagram(std::size_t i) noexcept {
        return {buffers_[i].data(), messages_[i].msg_len};
    }
    const PeerAddress& from(std::size_t i) noexcept {
        from_[i].length = messages_[i].msg_hdr.msg_namelen;
        from_[i].came_in_at(messages_[i].msg_hdr);
        return from_[i];
    }

  private:
    std::array<std::array<std::byte, bytes>, most> buffers_;
    std::array<iovec, most> pieces_;
    std::array<mmsghdr, most> messages_;
    std::array<PeerAddress, most> from_;
    std::array<PacketInfo, most> infos_;
};

}  // namespace knurl::bridge

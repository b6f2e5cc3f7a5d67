#pragma once
// Sends datagrams to many peers with few system calls.

#include <array>
#include <cerrno>
#include <cstddef>
#include <span>

#include <sys/socket.h>

#include "path_mtu.hpp"
#include "peer_address.hpp"

namespace knurl::bridge {

class OutQueue {
  public:
    static constexpr std::size_t most = 64;

    explicit OutQueue(int socket) noexcept : socket_(socket) {}
    OutQueue(const OutQueue&) = delete;
    OutQueue& operator=(const OutQueue&) = delete;

    /// A buffer for the next datagram.
    std::span<std::byte> room() noexcept {
        if (size_ == most) flush();
        return buffers_[size_];
    }
    /// Queues it with `bytes`. `mtu` learns if the path to that peer carries less; it must live until
    /// flush(). Null: the length was only a probe.
    void put(std::size_t bytes, const PeerAddress& to, PathMtu* mtu) noexcept {
        pieces_[size_] = {.iov_base = buffers_[size_].data(), .iov_len = bytes};
        messages_[size_].msg_hdr = {};
        to.address_to(messages_[size_].msg_hdr, to_[size_], from_[size_]);
        messages_[size_].msg_hdr.msg_iov = &pieces_[size_];
        messages_[size_].msg_hdr.msg_iovlen = 1;
        mtus_[size_++] = mtu;
    }

    /// What the kernel does not accept is lost, as on any network.
    void flush() noexcept {
        for (std::size_t done = 0; done < size_;) {
            const int sent = ::sendmmsg(socket_, messages_.data() + done, static_cast<unsigned>(size_ - done),
                                        MSG_DONTWAIT | MSG_NOSIGNAL);
            if (sent > 0) {
                done += static_cast<std::size_t>(sent);
                continue;
            }
            if (errno == EMSGSIZE && mtus_[done] != nullptr) mtus_[done]->refused();
            ++done;  // an error of one peer must not affect the next one
        }
        size_ = 0;
    }

  private:
    int socket_;
    std::size_t size_ = 0;
    std::array<std::array<std::byte, datagram_bytes>, most> buffers_;
    std::array<sockaddr_storage, most> to_;
    std::array<PacketInfo, most> from_;
    std::array<iovec, most> pieces_;
    std::array<mmsghdr, most> messages_;
    std::array<PathMtu*, most> mtus_;
};

}  // namespace knurl::bridge

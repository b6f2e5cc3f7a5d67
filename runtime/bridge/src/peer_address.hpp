#pragma once
// The sender of a datagram, and the local address at which it arrived. A bridge that listens at all addresses
// (0.0.0.0, [::]) has one socket. The kernel would answer from the address that the route back suggests. But
// the other end's socket is connected to the address that it called, and accepts nothing from another.

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <netinet/in.h>
#include <sys/socket.h>

namespace knurl::bridge {

/// Room for the control messages of one datagram, in either direction.
struct alignas(cmsghdr) PacketInfo {
    static constexpr std::size_t room = CMSG_SPACE(sizeof(in6_pktinfo));
    static_assert(room >= CMSG_SPACE(sizeof(in_pktinfo)));
    std::byte bytes[room];
};

struct PeerAddress {
    sockaddr_storage address{};
    socklen_t length = 0;        // 0: no address
    int own_family = AF_UNSPEC;  // AF_UNSPEC: the kernel chooses the address of an answer
    in6_addr own{};              // for AF_INET, in its first four bytes

    /// Reads the control messages of a received datagram.
    void came_in_at(const msghdr& message) noexcept {
        own_family = AF_UNSPEC;
        for (const cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr;
             each = CMSG_NXTHDR(const_cast<msghdr*>(&message), const_cast<cmsghdr*>(each))) {
            if (each->cmsg_level == IPPROTO_IP && each->cmsg_type == IP_PKTINFO) {
                in_pktinfo info;
                std::memcpy(&info, CMSG_DATA(each), sizeof info);
                own_family = AF_INET;
                std::memcpy(&own, &info.ipi_spec_dst, sizeof info.ipi_spec_dst);
            } else if (each->cmsg_level == IPPROTO_IPV6 && each->cmsg_type == IPV6_PKTINFO) {
                in6_pktinfo info;
                std::memcpy(&info, CMSG_DATA(each), sizeof info);
                own_family = AF_INET6;
                own = info.ipi6_addr;
            }
        }
    }

    /// Addresses `message` to this peer, from the local address that it called. `name` and `info` must live
    /// as long as it.
    void address_to(msghdr& message, sockaddr_storage& name, PacketInfo& info) const noexcept {
        name = address;
        message.msg_name = &name;
        message.msg_namelen = length;
        if (own_family == AF_INET) {
            in_pktinfo from{};  // any interface
            std::memcpy(&from.ipi_spec_dst, &own, sizeof from.ipi_spec_dst);
            attach(message, info, IPPROTO_IP, IP_PKTINFO, from);
        } else if (own_family == AF_INET6) {
            in6_pktinfo from{};
            from.ipi6_addr = own;
            attach(message, info, IPPROTO_IPV6, IPV6_PKTINFO, from);
        }
    }

  private:
    template <class Info>
    static void attach(msghdr& message, PacketInfo& room, int level, int type, const Info& info) noexcept {
        std::memset(room.bytes, 0, sizeof room.bytes);
        message.msg_control = room.bytes;
        message.msg_controllen = CMSG_SPACE(sizeof info);
        cmsghdr* const header = CMSG_FIRSTHDR(&message);
        header->cmsg_level = level;
        header->cmsg_type = type;
        header->cmsg_len = CMSG_LEN(sizeof info);
        std::memcpy(CMSG_DATA(header), &info, sizeof info);
    }
};

}  // namespace knurl::bridge

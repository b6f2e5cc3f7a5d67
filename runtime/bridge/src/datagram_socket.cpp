#include "datagram_socket.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

namespace knurl::bridge {

shm::UniqueFd make_datagram_socket(int family) {
    shm::UniqueFd fd(::socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!fd) return fd;
    const int whole = IP_PMTUDISC_DO;
    ::setsockopt(fd.get(), IPPROTO_IP, IP_MTU_DISCOVER, &whole, sizeof whole);
    const int whole6 = IPV6_PMTUDISC_DO;
    if (family == AF_INET6) ::setsockopt(fd.get(), IPPROTO_IPV6, IPV6_MTU_DISCOVER, &whole6, sizeof whole6);
    const int room = 1 << 20;  // the kernel grants what is allowed
    ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
    return fd;
}

}  // namespace knurl::bridge

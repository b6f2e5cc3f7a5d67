#pragma once
// A descriptor whose last close takes as long as its maker likes.

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/shm/fd.hpp>

namespace knurl::test {

/// A TCP connection to itself, full, of which one end lingers for an hour, or until this object ends.
class Lingering {
  public:
    Lingering() {
        const shm::UniqueFd listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const any = reinterpret_cast<sockaddr*>(&address);
        lingers_ = shm::UniqueFd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        // The receiver takes little, the sender holds much: most of it stays unsent.
        const int little = 2048;
        ::setsockopt(listener.get(), SOL_SOCKET, SO_RCVBUF, &little, sizeof little);
        const linger hour{.l_onoff = 1, .l_linger = 3600};
        if (::bind(listener.get(), any, size) != 0 || ::listen(listener.get(), 1) != 0 ||
            ::getsockname(listener.get(), any, &size) != 0 || ::connect(lingers_.get(), any, size) != 0 ||
            ::setsockopt(lingers_.get(), SOL_SOCKET, SO_LINGER, &hour, sizeof hour) != 0)
            throw std::runtime_error(std::string("TCP on loopback: ") + std::strerror(errno));
        other_end_ = shm::UniqueFd(::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC));
        const std::array<char, 65536> bytes{};
        while (::send(lingers_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) > 0) {
        }
    }
    /// Resets the connection: nobody lingers any more.
    ~Lingering() { other_end_.reset(); }
    Lingering(const Lingering&) = delete;
    Lingering& operator=(const Lingering&) = delete;

    int fd() const { return lingers_.get(); }
    /// From now on others alone hold it. The caller knows that somebody does: else this is the last close.
    void let_go() { lingers_.reset(); }
    /// The same where others may have closed it already: a thread makes what may be the last close.
    void let_go_aside() {
        closing_ = std::jthread([last = std::move(lingers_)]() mutable { last.reset(); });
    }

  private:
    shm::UniqueFd other_end_, lingers_;
    std::jthread closing_;
};

}  // namespace knurl::test

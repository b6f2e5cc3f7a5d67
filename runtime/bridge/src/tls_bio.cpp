#include "tls_bio.hpp"

#include <cerrno>
#include <new>

#include <sys/socket.h>

namespace knurl::bridge {

namespace {

SocketBio& socket_of(BIO* bio) noexcept {
    return *static_cast<SocketBio*>(BIO_get_data(bio));
}

int finish(BIO* bio, ssize_t result, bool reading) noexcept {
    BIO_clear_retry_flags(bio);
    if (result > 0) return static_cast<int>(result);
    SocketBio& socket = socket_of(bio);
    if (result == 0) {
        socket.ended = socket.ended || reading;
        return 0;
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) {
        socket.error = errno;
        return -1;
    }
    if (reading)
        BIO_set_retry_read(bio);
    else
        BIO_set_retry_write(bio);
    return -1;
}

int write_bytes(BIO* bio, const char* from, int bytes) noexcept {
    return finish(
        bio, ::send(socket_of(bio).fd, from, static_cast<std::size_t>(bytes), MSG_NOSIGNAL | MSG_DONTWAIT),
        false);
}

int read_bytes(BIO* bio, char* into, int bytes) noexcept {
    SocketBio& socket = socket_of(bio);
    const ssize_t got = ::recv(socket.fd, into, static_cast<std::size_t>(bytes), MSG_DONTWAIT);
    if (got > 0 && !socket.spoke) {
        socket.spoke = true;
        socket.first = static_cast<unsigned char>(*into);
    }
    return finish(bio, got, true);
}

long control(BIO* bio, int command, long, void*) noexcept {
    if (command == BIO_CTRL_FLUSH) return 1;  // nothing is buffered
    if (command == BIO_CTRL_EOF) return socket_of(bio).ended ? 1 : 0;
    return 0;
}

/// Created once, and kept for the process's life.
const BIO_METHOD* method() {
    static const BIO_METHOD* const made = [] {
        BIO_METHOD* m = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "knurl socket");
        if (m == nullptr || BIO_meth_set_write(m, write_bytes) != 1 ||
            BIO_meth_set_read(m, read_bytes) != 1 || BIO_meth_set_ctrl(m, control) != 1)
            throw std::bad_alloc();
        return m;
    }();
    return made;
}

}  // namespace

BIO* make_socket_bio(SocketBio& socket) {
    BIO* bio = BIO_new(method());
    if (bio == nullptr) throw std::bad_alloc();
    BIO_set_data(bio, &socket);
    BIO_set_init(bio, 1);
    return bio;
}

}  // namespace knurl::bridge

#pragma once
// A socket for OpenSSL. Its own socket BIO writes with write(2), which kills the application by SIGPIPE when
// the peer has gone. A library must not do that.

#include <openssl/bio.h>

namespace knurl::bridge {

struct SocketBio {
    int fd = -1;
    int error = 0;       // of the last call that failed permanently
    bool ended = false;  // the peer has sent end of file
    bool spoke = false;  // a byte has arrived
    unsigned char first = 0;

    /// A TLS connection begins with a record of a handshake (22) or an alert (21).
    bool began_as_tls() const noexcept { return first == 22 || first == 21; }
};

/// Throws std::bad_alloc. `socket` must outlive it.
BIO* make_socket_bio(SocketBio& socket);

}  // namespace knurl::bridge

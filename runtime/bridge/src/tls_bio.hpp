#pragma once
// A socket for OpenSSL. Its own socket BIO writes with write(2), which ends the whole application by SIGPIPE
// when the peer has gone; a library must not.

#include <openssl/bio.h>

namespace knurl::bridge {

struct SocketBio {
    int fd = -1;
    int error = 0;       // of the last call that failed for good
    bool ended = false;  // the peer sent its end of file
    bool spoke = false;  // a byte has come
    unsigned char first = 0;

    /// A TLS connection begins with a record of a handshake (22) or an alert (21).
    bool began_as_tls() const noexcept { return first == 22 || first == 21; }
};

/// Throws std::bad_alloc. `socket` must outlive it.
BIO* make_socket_bio(SocketBio& socket);

}  // namespace knurl::bridge

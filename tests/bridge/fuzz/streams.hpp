#pragma once
// Shared by the targets: a stranger's bytes into a connection.

#include <cstddef>
#include <cstdint>
#include <span>

#include <poll.h>
#include <sys/socket.h>

#include "../../fuzz/require.hpp"
#include "frame_stream.hpp"

namespace knurl::fuzz {

using namespace bridge;

struct Ends {
    shm::UniqueFd ours, theirs;
};

inline Ends connected() {
    int fds[2];
    require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, fds) == 0);
    return {shm::UniqueFd(fds[0]), shm::UniqueFd(fds[1])};
}

/// Reads all answers, so that nothing waits for a reader.
inline void discard(const shm::UniqueFd& theirs) {
    char bytes[4096];
    while (::recv(theirs.get(), bytes, sizeof bytes, MSG_DONTWAIT) > 0) {
    }
}

}  // namespace knurl::fuzz

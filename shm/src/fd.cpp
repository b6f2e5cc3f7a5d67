#include <unistd.h>

#include <knurl/shm/fd.hpp>

namespace knurl::shm {

void UniqueFd::reset() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
}

}  // namespace knurl::shm

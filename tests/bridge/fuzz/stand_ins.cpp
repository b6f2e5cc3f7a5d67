// For what the targets do not look at.

#include <knurl/protocol/attach.hpp>

std::uint64_t knurl::protocol::wire_hash() noexcept {
    return 1;
}

// For parts that the targets do not test.

#include <knurl/protocol/attach.hpp>

std::uint64_t knurl::protocol::wire_hash() noexcept {
    return 1;
}

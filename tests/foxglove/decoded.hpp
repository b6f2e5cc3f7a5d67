#pragma once
// Messages as others read them.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <knurl/json/json.hpp>
#include <knurl/messages/schemas.hpp>

namespace knurl::test {

struct Encoded {
    const messages::Schema& schema;
    std::vector<std::byte> bytes;
};

/// By ros2msg.py, which has none of our code.
Json decoded(const std::vector<Encoded>& messages);
/// By Foxglove's own readers; none: they are not there, and `why` says so.
std::optional<Json> decoded_by_foxglove(const std::vector<Encoded>& messages, std::string& why);

}  // namespace knurl::test

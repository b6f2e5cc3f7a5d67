#pragma once
// The parameters of each representation as a plain C struct: the rows of its table, one after the other,
// behind its size. The structs of the client's headers may change their order; these may only grow at their
// end, where Field::since puts what is new.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <knurl/reps/kind.hpp>

namespace knurl::capi {

struct Member {
    const Field* field = nullptr;
    std::size_t offset = 0;  // in the C struct
};

struct Layout {
    std::vector<Member> members;      // in the order of the C struct
    std::size_t size = 0;             // of the C struct
    std::size_t first_size = 0;       // of the first version's: no caller has less
    std::vector<std::byte> defaults;  // of the parameters as the client has them

    /// Parameters from a C struct, whose size was checked; what it does not have keeps its default.
    void read(const void* params, std::span<std::byte> out) const;
    /// Members that fit into params->size.
    void write(std::span<const std::byte> from, void* params) const;
};

/// Of each kind.
std::span<const Layout> layouts();

/// The member's name in C: '_' for each '.'.
std::string member_name(const Field& field);

}  // namespace knurl::capi

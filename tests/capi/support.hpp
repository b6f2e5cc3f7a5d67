#pragma once
// Calls of the C interface, and what they say when they fail.

#include <cctype>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <knurl.h>
#include <knurl_offline.h>

namespace capi_test {

inline constexpr std::int64_t ms = 1'000'000, s = 1'000'000'000;  // ns

/// KNURL_OK.
inline testing::AssertionResult did(int code) {
    if (code == KNURL_OK) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "code " << code << ": " << knurl_error(nullptr) << " " << knurl_offline_error();
}

/// One line that says something: no line break, no other control character.
inline testing::AssertionResult one_line(const char* text) {
    const std::string line = text;
    if (line.size() < 10) return testing::AssertionFailure() << "the line is '" << line << "'";
    for (const char c : line)
        if (std::iscntrl(static_cast<unsigned char>(c)))
            return testing::AssertionFailure() << "control character " << int{c} << " in: " << line;
    return testing::AssertionSuccess();
}

/// A code below 0, and its line.
inline testing::AssertionResult fails(int wanted, int code, const std::string& words = "") {
    if (code != wanted)
        return testing::AssertionFailure()
               << "code " << code << " instead of " << wanted << "; the last line: " << knurl_error(nullptr);
    const std::string line = knurl_error(nullptr);
    if (line.find(words) == std::string::npos)
        return testing::AssertionFailure() << "'" << words << "' is not in: " << line;
    return one_line(line.c_str());
}
/// As fails, of the other library.
inline testing::AssertionResult fails_offline(int wanted, int code, const std::string& words = "") {
    if (code != wanted)
        return testing::AssertionFailure()
               << "code " << code << " instead of " << wanted << "; the last line: " << knurl_offline_error();
    const std::string line = knurl_offline_error();
    if (line.find(words) == std::string::npos)
        return testing::AssertionFailure() << "'" << words << "' is not in: " << line;
    return one_line(line.c_str());
}

/// A struct as a later version of the library may have it.
template <class T>
struct Later {
    T known{};
    std::uint64_t tail[3] = {};
    Later() { known.size = sizeof *this; }
    explicit Later(const T& from) : known(from) { known.size = sizeof *this; }
};

template <class T>
T sized() {
    T result;
    std::memset(static_cast<void*>(&result), 0, sizeof result);
    result.size = sizeof result;
    return result;
}

/// Sizes that no version of the library takes for this struct.
template <class T>
std::vector<std::uint64_t> wrong_sizes() {
    return {0,
            1,
            8,
            sizeof(T) - 8,
            sizeof(T) - 1,
            sizeof(T) + 1,
            1u << 17,
            std::uint64_t{1} << 40,
            ~std::uint64_t{0}};
}

inline knurl_plane plane(double offset, double stiffness) {
    knurl_plane params;
    knurl_default_plane(&params);
    params.offset = offset;
    params.stiffness = stiffness;
    return params;
}
/// In full effect with its first cycle.
inline knurl_constant_force at_once(double x, double y, double z) {
    knurl_constant_force params;
    knurl_default_constant_force(&params);
    params.force = {x, y, z};
    params.recovery = 0;
    return params;
}

}  // namespace capi_test

#pragma once
// The keys file of a bridge: who may connect, in which role. One line per key: `name role 64-hex-digits`; '#'
// begins a comment. Anybody who can read it can move a motor, so a file that others can read is refused.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::bridge {

/// Each role includes the ones before it.
enum class Role : std::uint8_t {
    observe = 0,  // read reports
    render = 1,   // share a device that somebody else has switched on
    control = 2,  // claim, arm, reset
};
std::string_view role_name(Role role) noexcept;
std::optional<Role> parse_role(std::string_view word) noexcept;

inline constexpr std::size_t key_bytes = 32;
// letters, digits, '.', '_', '-': it appears in logs and in names of claims
inline constexpr std::size_t max_key_name = 63;
inline constexpr std::size_t max_keys = 1024;  // in one file

struct Key {
    std::string name;  // the identity in the handshake; not secret
    Role role = Role::observe;
    std::array<std::byte, key_bytes> secret{};
};

/// A new key from the system's random numbers. Throws std::runtime_error: bad name.
Key make_key(std::string name, Role role);

/// A bridge can create keys. An application must request one, since a bridge does not know a key that the
/// application makes.
enum class KeysOf : std::uint8_t { bridge, application };

/// All keys of a file. Throws std::runtime_error, one line: file missing, readable by others, or file and
/// line of a mistake, and the remedy for `whose`.
std::vector<Key> read_keys(const std::filesystem::path& file, KeysOf whose = KeysOf::bridge);

/// Adds one key; creates the file (0600) if needed. Throws: the name exists, or the file cannot be written.
void add_key(const std::filesystem::path& file, const Key& key);

/// Null: no key of that name.
const Key* find_key(std::span<const Key> keys, std::string_view name) noexcept;

}  // namespace knurl::bridge

#pragma once

/// @file
/// The keys file of a bridge: who may connect, in which role. One line per key: `name role 64-hex-digits`; '#'
/// begins a comment. Anybody who can read it can move a motor, so a file that others can read is refused.

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
    /// Read reports.
    observe = 0,
    /// Share a device that somebody else has switched on.
    render = 1,
    /// Claim, arm, reset.
    control = 2,
};
/// Its word in the file.
std::string_view role_name(Role role) noexcept;
/// Nothing: no role is called so.
std::optional<Role> parse_role(std::string_view word) noexcept;

/// Bytes of a secret.
inline constexpr std::size_t key_bytes = 32;
/// Longest name: letters, digits, '.', '_', '-', since it appears in logs and in names of claims.
inline constexpr std::size_t max_key_name = 63;
/// Most keys in one file.
inline constexpr std::size_t max_keys = 1024;

/// One line of the file.
struct Key {
    /// The identity in the handshake; not secret.
    std::string name;
    /// What its owner may do.
    Role role = Role::observe;
    /// What its owner shows to have.
    std::array<std::byte, key_bytes> secret{};
};

/// A new key from the system's random numbers. Throws std::runtime_error: bad name.
Key make_key(std::string name, Role role);

/// A bridge can create keys. An application must request one, since a bridge does not know a key that the
/// application makes.
enum class KeysOf : std::uint8_t {
    /// It can add a key.
    bridge,
    /// It has the line that it was given.
    application
};

/// All keys of a file. Throws std::runtime_error, one line: file missing, readable by others, or file and
/// line of a mistake, and the remedy for `whose`.
std::vector<Key> read_keys(const std::filesystem::path& file, KeysOf whose = KeysOf::bridge);

/// Adds one key; creates the file (0600) if needed. Throws: the name exists, or the file cannot be written.
void add_key(const std::filesystem::path& file, const Key& key);

/// Null: no key of that name.
const Key* find_key(std::span<const Key> keys, std::string_view name) noexcept;

}  // namespace knurl::bridge

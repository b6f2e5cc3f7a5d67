#pragma once
// The keys file of a bridge: who may come in, and what for. One line a key: `name role 64-hex-digits`; '#'
// begins a comment. Whoever can read it can move a motor, so a file that others can read is refused.

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

/// Each may do what the ones before it may.
enum class Role : std::uint8_t {
    observe = 0,  // read reports
    render = 1,   // share a device that somebody else has switched on
    control = 2,  // claim, arm, reset
};
std::string_view role_name(Role role) noexcept;
std::optional<Role> parse_role(std::string_view word) noexcept;

inline constexpr std::size_t key_bytes = 32;
// letters, digits, '.', '_', '-': it is in logs and claims' names
inline constexpr std::size_t max_key_name = 63;
inline constexpr std::size_t max_keys = 1024;  // of one file

struct Key {
    std::string name;  // the identity in the handshake; not secret
    Role role = Role::observe;
    std::array<std::byte, key_bytes> secret{};
};

/// A new key from the system's random numbers. Throws std::runtime_error: bad name.
Key make_key(std::string name, Role role);

/// Whoever lets others in makes keys; whoever wants in asks for one, since what it makes itself nobody knows.
enum class KeysOf : std::uint8_t { bridge, application };

/// All keys of a file. Throws std::runtime_error, one line: missing, readable by others, file and line of a
/// mistake, what `whose` can do about it.
std::vector<Key> read_keys(const std::filesystem::path& file, KeysOf whose = KeysOf::bridge);

/// Adds one key; makes the file (0600) if there is none. Throws: the name is taken, the file cannot be
/// written.
void add_key(const std::filesystem::path& file, const Key& key);

/// Null: no key of that name.
const Key* find_key(std::span<const Key> keys, std::string_view name) noexcept;

}  // namespace knurl::bridge

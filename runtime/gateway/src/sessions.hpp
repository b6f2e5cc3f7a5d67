#pragma once
// Who a caller is: one-time tokens, sessions of the page, keys. Secrets are compared in constant time: how long a
// refusal takes says nothing about how much of a guess is right.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/bridge/keys.hpp>
#include <knurl/gateway/socket.hpp>

namespace knurl::gateway {

/// What a caller has shown to be.
struct Identity {
    Role role = Role::observe;
    std::string session;
    std::optional<bridge::Key> key{};  // of who has shown one
};

class Sessions {
  public:
    using Time = std::chrono::steady_clock::time_point;
    Sessions(std::size_t most, std::chrono::seconds idle, std::vector<bridge::Key> keys)
        : most_(most), idle_(idle), keys_(std::move(keys)) {}

    /// The one before is void.
    std::string new_token(Role role, Time now);
    /// The secret of a new session, for a cookie. Nothing: no such token, used already, or too old.
    std::optional<std::string> login_by_token(std::string_view token, Time now);
    std::optional<std::string> login_by_key(std::string_view key, Time now);

    /// Whose cookie it is; it counts as used.
    std::optional<Identity> by_cookie(std::string_view secret, Time now);
    /// Whose key it is (64 hexadecimal digits).
    std::optional<Identity> by_key(std::string_view key) const;
    /// Other keys from now on. Sessions of keys that are not among them end.
    void admit(std::vector<bridge::Key> keys);
    /// False: it is by a key that is admitted no more.
    bool stands(const Identity& identity) const { return !identity.key || holds(*identity.key); }
    /// A session is in use: it has a socket.
    void touch(std::string_view session, Time now);
    std::size_t count() const { return sessions_.size(); }

  private:
    using Secret = std::array<unsigned char, 16>;
    struct Session {
        Secret secret;
        Role role;
        std::string name;
        Time used;
        std::optional<bridge::Key> key;
    };
    std::string begin(Role role, Time now, std::optional<bridge::Key> key = {});
    bool holds(const bridge::Key& key) const;
    const bridge::Key* key_of(std::string_view key) const;

    std::size_t most_;
    std::chrono::seconds idle_;
    std::vector<bridge::Key> keys_;
    std::vector<Session> sessions_;
    std::uint64_t begun_ = 0;
    struct Token {
        Secret secret;
        Role role;
        Time made;
    };
    std::optional<Token> token_;
};

}  // namespace knurl::gateway

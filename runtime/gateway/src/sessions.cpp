#include "sessions.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <openssl/crypto.h>
#include <sys/random.h>

namespace knurl::gateway {

namespace {

template <std::size_t N>
std::array<unsigned char, N> random_secret() {
    std::array<unsigned char, N> bytes{};
    std::size_t have = 0;
    while (have < N) {
        const ssize_t got = ::getrandom(bytes.data() + have, N - have, 0);
        if (got < 0 && errno != EINTR)
            throw std::runtime_error(std::string("no random numbers: getrandom: ") + std::strerror(errno));
        if (got > 0) have += static_cast<std::size_t>(got);
    }
    return bytes;
}

template <class Bytes>
std::string secret_text(const Bytes& bytes) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const auto each : bytes) {
        const auto value = static_cast<unsigned>(each);
        text += digits[value >> 4];
        text += digits[value & 15];
    }
    return text;
}

/// Both as text, of one length: what the caller has sent is not decoded before it is compared.
bool same_secret(std::string_view a, const std::string& b) {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), b.size()) == 0;
}

Role role_of(bridge::Role role) {
    return static_cast<Role>(role);
}
static_assert(static_cast<int>(Role::observe) == static_cast<int>(bridge::Role::observe) &&
              static_cast<int>(Role::render) == static_cast<int>(bridge::Role::render) &&
              static_cast<int>(Role::control) == static_cast<int>(bridge::Role::control));

}  // namespace

std::string Sessions::new_token(Role role, Time now) {
    token_ = Token{.secret = random_secret<16>(), .role = role, .made = now};
    return secret_text(token_->secret);
}

std::optional<std::string> Sessions::login_by_token(std::string_view token, Time now) {
    if (!token_ || now - token_->made > idle_ || !same_secret(token, secret_text(token_->secret))) return {};
    const Role role = token_->role;
    token_.reset();
    return begin(role, now);
}

std::optional<std::string> Sessions::login_by_key(std::string_view key, Time now) {
    const bridge::Key* found = key_of(key);
    if (!found) return {};
    return begin(role_of(found->role), now, *found);
}

std::string Sessions::begin(Role role, Time now, std::optional<bridge::Key> key) {
    std::erase_if(sessions_, [&](const Session& each) { return now - each.used > idle_; });
    if (sessions_.size() >= most_)
        sessions_.erase(std::min_element(sessions_.begin(), sessions_.end(),
                                         [](const Session& a, const Session& b) { return a.used < b.used; }));
    sessions_.push_back({.secret = random_secret<16>(),
                         .role = role,
                         .name = std::to_string(++begun_),
                         .used = now,
                         .key = std::move(key)});
    return secret_text(sessions_.back().secret);
}

std::optional<Identity> Sessions::by_cookie(std::string_view secret, Time now) {
    Session* found = nullptr;
    for (Session& each : sessions_)  // all of them, whichever it is
        if (same_secret(secret, secret_text(each.secret))) found = &each;
    if (!found || now - found->used > idle_) return {};
    found->used = now;
    return Identity{.role = found->role, .session = found->name, .key = found->key};
}

const bridge::Key* Sessions::key_of(std::string_view key) const {
    const std::string small = [&] {
        std::string text(key);
        for (char& c : text)
            if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
        return text;
    }();
    const bridge::Key* found = nullptr;
    for (const bridge::Key& each : keys_)
        if (same_secret(small, secret_text(each.secret))) found = &each;
    return found;
}

std::optional<Identity> Sessions::by_key(std::string_view key) const {
    const bridge::Key* found = key_of(key);
    if (!found) return {};
    return Identity{.role = role_of(found->role), .session = "key " + found->name, .key = *found};
}

bool Sessions::holds(const bridge::Key& key) const {
    return std::any_of(keys_.begin(), keys_.end(), [&](const bridge::Key& each) {
        return each.name == key.name && each.role == key.role && each.secret == key.secret;
    });
}

void Sessions::admit(std::vector<bridge::Key> keys) {
    keys_ = std::move(keys);
    std::erase_if(sessions_, [this](const Session& each) { return each.key && !holds(*each.key); });
}

void Sessions::touch(std::string_view session, Time now) {
    for (Session& each : sessions_)
        if (each.name == session) each.used = now;
}

}  // namespace knurl::gateway

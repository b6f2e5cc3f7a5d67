#pragma once
// What the handles of libknurl.so stand for.

#include <chrono>

#include "handles.hpp"

namespace knurl::capi {

struct ClientObject final : Object {
    static constexpr Type its_type = Type::client;
    explicit ClientObject(Client connected) : Object(its_type), client(std::move(connected)) {}

    Client client;
};

struct HandObject final : Object {
    static constexpr Type its_type = Type::hand;
    explicit HandObject(Claim claimed);
    explicit HandObject(Observer observer);
    void close() noexcept override;

    /// Throws Failed for an observer, which changes nothing.
    Claim& claim();
    Observer& reader() { return claim_ ? *claim_ : *observer_; }

    void keep(const AnyHandle& added);
    /// Throws Failed: no such representation, or of another kind.
    AnyHandle named(knurl_id id);
    AnyHandle named(knurl_id id, std::uint32_t kind);

    std::atomic<std::int64_t> grace_ns{-1};  // of knurl_keep_alive; below 0: it is off
    std::atomic<std::int64_t> progress_ns{0};

  private:
    std::optional<Claim> claim_;
    std::optional<Observer> observer_;
    std::mutex mutex_;
    std::vector<std::optional<AnyHandle>> added_;  // by slot
};

struct SendingObject final : Object {
    static constexpr Type its_type = Type::sending;
    explicit SendingObject(Sending begun) : Object(its_type), sending(std::move(begun)) {}
    void close() noexcept override;

    std::mutex mutex;  // a Sending belongs to one thread at a time
    std::optional<Sending> sending;
};

/// Renews the claim of this hand, as its grace says, from now on.
void keep_alive_from_now_on(const std::shared_ptr<HandObject>& hand);

/// Of a wait that another thread may end by closing the handle.
inline constexpr std::chrono::nanoseconds slice = std::chrono::milliseconds(20);
/// As good as for ever, and the clock can add it to the present.
inline constexpr std::chrono::nanoseconds longest_wait = std::chrono::hours(24 * 365);
inline std::chrono::nanoseconds time_of(std::int64_t ns) {
    return std::chrono::nanoseconds(ns < 0 ? 0 : ns);
}
inline knurl_vec3 to_c(const Vec3& v) {
    return {v.x, v.y, v.z};
}
inline Vec3 from_c(const knurl_vec3& v) {
    return {v.x, v.y, v.z};
}
inline knurl_id to_c(RepresentationId id) {
    return std::uint64_t{id.generation} << 32 | id.slot;
}
inline RepresentationId from_c(knurl_id id) {
    return {.slot = static_cast<std::uint32_t>(id), .generation = static_cast<std::uint32_t>(id >> 32)};
}
inline std::string text_or(const char* text, const char* otherwise) {
    return text != nullptr ? text : otherwise;
}

/// Copies a text, shortened to the room that there is.
template <std::size_t N>
void copy_text(char (&to)[N], const std::string& from) {
    const std::size_t length = std::min(from.size(), N - 1);
    std::memcpy(to, from.data(), length);
    std::memset(to + length, 0, N - length);
}

}  // namespace knurl::capi

#pragma once
// The state that a servo keeps between cycles, as 64-bit words, for an input log's keyframe. Each class lists
// its members once, in `state`, for both directions.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace knurl::servo {

class StateWords {
  public:
    enum class To { words, state };

    StateWords(std::span<std::uint64_t> words, To to) noexcept : words_(words), to_(to) {}

    template <class... T>
    void operator()(T&... members) noexcept {
        (one(members), ...);
    }
    /// Number of words visited; if it exceeds the capacity, they did not fit.
    std::size_t visited() const noexcept { return visited_; }

  private:
    template <class T>
    void one(T& member) noexcept {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            if (visited_ < words_.size()) move(member, words_[visited_]);
            ++visited_;
        } else if constexpr (requires { member.data(); }) {  // an array, a vector, a matrix
            for (std::size_t i = 0; i < static_cast<std::size_t>(member.size()); ++i) one(member.data()[i]);
        } else if constexpr (requires { member.coeffs(); }) {  // a quaternion
            one(member.coeffs());
        } else {
            member.state(*this);
        }
    }
    template <class T>
    void move(T& member, std::uint64_t& word) noexcept {
        if (to_ == To::words) {
            word = 0;
            std::memcpy(&word, &member, sizeof member);
        } else if constexpr (std::is_same_v<T, bool>) {
            member = word != 0;
        } else {
            std::memcpy(&member, &word, sizeof member);
        }
    }

    std::span<std::uint64_t> words_;
    To to_;
    std::size_t visited_ = 0;
};

}  // namespace knurl::servo

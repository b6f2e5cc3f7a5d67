#pragma once
// CDR, the encoding of ROS 2's messages (OMG Common Data Representation, plain, little endian): four bytes that say
// so, then the members in order. Each is aligned to its size, counted from behind those four bytes.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace knurl::messages {

class CdrWriter {
  public:
    /// What each message begins with: CDR, little endian, no options.
    static constexpr std::byte encapsulation[] = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    static_assert(std::endian::native == std::endian::little);

    CdrWriter() : bytes_(std::begin(encapsulation), std::end(encapsulation)) {}

    /// A number; of a bool one byte.
    template <class T>
    requires(std::is_arithmetic_v<T> || std::is_same_v<T, std::byte>) void put(T value) {
        align(sizeof value);
        append(&value, sizeof value);
    }
    /// A text, with its length and a zero at its end.
    void text(std::string_view said) {
        count(said.size() + 1);
        append(said.data(), said.size());
        bytes_.push_back(std::byte{0});
    }
    /// How many elements of a sequence follow.
    void count(std::size_t elements) { put(static_cast<std::uint32_t>(elements)); }
    /// What is laid out in memory as CDR lays it out.
    void raw(std::span<const std::byte> bytes) { append(bytes.data(), bytes.size()); }

    std::vector<std::byte> take() { return std::move(bytes_); }
    std::size_t size() const { return bytes_.size(); }

  private:
    void align(std::size_t to) {
        const std::size_t over = (bytes_.size() - std::size(encapsulation)) % to;
        if (over > 0) bytes_.resize(bytes_.size() + to - over);
    }
    void append(const void* from, std::size_t n) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + n);
        if (n > 0) std::memcpy(bytes_.data() + at, from, n);
    }
    std::vector<std::byte> bytes_;
};

}  // namespace knurl::messages

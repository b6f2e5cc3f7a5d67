#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <knurl/vrpn/wire.hpp>

namespace knurl::vrpn {

namespace {

constexpr std::string_view version = "vrpn: ver. 07.38";
constexpr std::string_view same_version = "vrpn: ver. 07.";  // 07.xx is spoken alike
constexpr std::string_view magic = "vrpn: ver. ";
constexpr std::size_t mode_at = 18;

constexpr std::size_t padded(std::size_t bytes) noexcept {
    return (bytes + 7) / 8 * 8;
}

std::string_view text_of(std::span<const std::byte> bytes) noexcept {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool printable(std::string_view text) noexcept {
    return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

}  // namespace

Split split(std::span<const std::byte>& bytes, Message& message) noexcept {
    if (bytes.size() < 4) return Split::more;
    Payload words(bytes);
    const auto length = words.take<std::uint32_t>();
    // Before anything is computed from it: a length of 0 must not wrap round.
    if (length < header_bytes || length > header_bytes + most_payload) return Split::bad;
    const std::size_t payload = length - header_bytes;
    const std::size_t all = header_bytes + padded(payload);
    if (bytes.size() < all) return Split::more;
    message.header.seconds = words.take<std::int32_t>();
    message.header.microseconds = words.take<std::int32_t>();
    message.header.sender = words.take<std::int32_t>();
    message.header.type = words.take<std::int32_t>();
    message.header.sequence = words.take<std::uint32_t>();
    message.payload = bytes.subspan(header_bytes, payload);
    bytes = bytes.subspan(all);
    return Split::whole;
}

void append(std::vector<std::byte>& bytes, const Header& header, std::span<const std::byte> payload) {
    const std::array<std::uint32_t, 6> words{static_cast<std::uint32_t>(header_bytes + payload.size()),
                                             static_cast<std::uint32_t>(header.seconds),
                                             static_cast<std::uint32_t>(header.microseconds),
                                             static_cast<std::uint32_t>(header.sender),
                                             static_cast<std::uint32_t>(header.type),
                                             header.sequence};
    for (const std::uint32_t word : words) {
        const auto big = big_endian(word);
        bytes.insert(bytes.end(), big.begin(), big.end());
    }
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    bytes.resize(bytes.size() + padded(payload.size()) - payload.size());
}

std::array<std::byte, cookie_bytes> cookie() noexcept {
    std::array<std::byte, cookie_bytes> bytes{};
    std::memcpy(bytes.data(), version.data(), version.size());
    bytes[16] = bytes[17] = std::byte{' '};
    bytes[mode_at] = std::byte{'0'};
    return bytes;
}

Cookie read_cookie(std::span<const std::byte, cookie_bytes> bytes) {
    const std::string_view text = text_of(bytes);
    if (!text.starts_with(magic)) return {"it does not speak VRPN"};
    if (!text.starts_with(same_version)) {
        const std::string_view said = text.substr(0, version.size());
        return {fmt::format("it speaks '{}', and this server '{}': use a client of VRPN 07",
                            printable(said) ? said : magic, version)};
    }
    if (text[mode_at] != '0')
        return {
            "it asks this server to write a log file, which it does not do: connect without remote logging"};
    return {};
}

std::optional<std::uint16_t> requested_port(std::span<const std::byte> datagram) noexcept {
    std::string_view text = text_of(datagram);
    text = text.substr(0, text.find('\0'));
    const std::size_t space = text.find(' ');
    if (text.size() > most_name || space == 0 || space == std::string_view::npos) return std::nullopt;
    std::string_view digits = text.substr(space + 1);
    while (digits.ends_with('\n') || digits.ends_with(' ')) digits.remove_suffix(1);
    if (digits.empty() || digits.size() > 5) return std::nullopt;
    std::uint32_t port = 0;
    for (const char c : digits) {
        if (c < '0' || c > '9') return std::nullopt;
        port = 10 * port + static_cast<std::uint32_t>(c - '0');
    }
    if (port < 1024 || port > 65535) return std::nullopt;
    return static_cast<std::uint16_t>(port);
}

PayloadWriter& PayloadWriter::put_text(std::string_view text, std::size_t room) {
    const std::size_t taken = std::min(text.size(), room - 1);
    for (std::size_t i = 0; i < taken; ++i) bytes_.push_back(static_cast<std::byte>(text[i]));
    bytes_.resize(bytes_.size() + room - taken);
    return *this;
}

std::optional<std::string> described_name(std::span<const std::byte> payload) {
    Payload words(payload);
    const auto count = words.take<std::int32_t>();
    const std::span<const std::byte> rest = words.rest();
    if (!words.ok() || count < 1 || static_cast<std::size_t>(count) > std::min(rest.size(), most_name + 1))
        return std::nullopt;
    const std::string_view text = text_of(rest.first(static_cast<std::size_t>(count) - 1));
    if (rest[text.size()] != std::byte{0} || !printable(text)) return std::nullopt;
    return std::string(text);
}

void put_name(PayloadWriter& payload, std::string_view name) {
    const std::string_view cut = name.substr(0, most_name);
    payload.put(static_cast<std::int32_t>(cut.size() + 1)).put_text(cut, cut.size() + 1);
}

}  // namespace knurl::vrpn

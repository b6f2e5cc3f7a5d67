#include "imd_reader.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include <arpa/inet.h>
#include <fmt/format.h>

namespace dock {

namespace {

constexpr std::size_t header_bytes = 8;

std::int32_t big_endian(const std::byte* at) {
    std::uint32_t word;
    std::memcpy(&word, at, sizeof word);
    return static_cast<std::int32_t>(ntohl(word));
}

/// The server's 32-bit words in this machine's byte order.
template <class T>
T words(const std::byte* at, bool swapped) {
    static_assert(sizeof(T) % 4 == 0 && std::is_trivially_copyable_v<T>);
    std::uint32_t raw[sizeof(T) / 4];
    std::memcpy(raw, at, sizeof raw);
    if (swapped)
        for (auto& word : raw) word = __builtin_bswap32(word);
    return std::bit_cast<T>(raw);
}

void append(std::string& to, std::uint32_t word) {
    to.append(reinterpret_cast<const char*>(&word), sizeof word);
}

}  // namespace

void ImdReader::feed(std::span<const std::byte> bytes) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(std::exchange(used_, 0)));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void ImdReader::greet(std::int32_t type, std::span<const std::byte> length) {
    if (type != static_cast<std::int32_t>(ImdType::handshake))
        throw ImdError(
            fmt::format("it did not begin with IMD's handshake (type 4) but with {}; is this the port of a "
                        "simulation with interactive molecular dynamics?",
                        type));
    const auto own = words<std::int32_t>(length.data(), false),
               other = words<std::int32_t>(length.data(), true);
    if (own != imd_version && other != imd_version)
        throw ImdError(fmt::format(
            "it speaks version {} of IMD; this program speaks version {}",
            std::abs(static_cast<double>(own)) < std::abs(static_cast<double>(other)) ? own : other,
            imd_version));
    swapped_ = other == imd_version;
}

std::optional<ImdFrame> ImdReader::coordinates(std::span<const std::byte> body) {
    ImdFrame frame;
    frame.energies = std::exchange(energies_, {});
    frame.atoms.resize(atoms_);
    for (std::size_t i = 0; i < atoms_; ++i) {
        const auto at = words<std::array<float, 3>>(body.data() + 12 * i, swapped());
        frame.atoms[i] = {at[0], at[1], at[2]};
        if (!frame.atoms[i].allFinite())
            throw ImdError(fmt::format("atom {}'s place is no number: the simulation has come apart", i));
    }
    return frame;
}

std::optional<ImdFrame> ImdReader::next() {
    std::optional<ImdFrame> frame;
    while (!frame && !ended_ && bytes_.size() - used_ >= header_bytes) {
        const std::byte* at = bytes_.data() + used_;
        const std::int32_t type = big_endian(at), length = big_endian(at + 4);
        if (!greeted()) {
            greet(type, {at + 4, 4});
            used_ += header_bytes;
            continue;
        }
        std::size_t body = 0;
        switch (static_cast<ImdType>(type)) {
            case ImdType::energies:
                if (length != 1)
                    throw ImdError(
                        fmt::format("a message of energies has length {}, and must have 1", length));
                body = sizeof(ImdEnergies);
                break;
            case ImdType::coordinates:
                if (length < 1 || length > most_atoms)
                    throw ImdError(
                        fmt::format("a frame of {} atoms; 1 to {} are possible", length, most_atoms));
                if (atoms_ != 0 && static_cast<std::size_t>(length) != atoms_)
                    throw ImdError(
                        fmt::format("a frame of {} atoms, and there were {} before", length, atoms_));
                body = 12 * static_cast<std::size_t>(length);
                break;
            case ImdType::disconnect:
            case ImdType::kill:
                ended_ = true;
                break;
            case ImdType::pause:
                paused_ = true;
                break;
            case ImdType::error:
                throw ImdError("the simulation reports an error; its own output says which");
            default:
                throw ImdError(fmt::format("a message of type {} makes no sense from a simulation", type));
        }
        if (bytes_.size() - used_ < header_bytes + body) break;
        if (static_cast<ImdType>(type) == ImdType::energies)
            energies_ = words<ImdEnergies>(at + header_bytes, swapped());
        if (static_cast<ImdType>(type) == ImdType::coordinates) {
            atoms_ = static_cast<std::size_t>(length);
            frame = coordinates({at + header_bytes, body});
            paused_ = false;
        }
        used_ += header_bytes + body;
    }
    return frame;
}

std::string imd_header(ImdType type, std::int32_t length) {
    std::string bytes;
    append(bytes, htonl(static_cast<std::uint32_t>(type)));
    append(bytes, htonl(static_cast<std::uint32_t>(length)));
    return bytes;
}

std::string imd_force(std::int32_t atom, const Eigen::Vector3f& force, bool swapped) {
    std::string bytes = imd_header(ImdType::forces, 1);
    const auto add = [&](std::uint32_t word) { append(bytes, swapped ? __builtin_bswap32(word) : word); };
    add(static_cast<std::uint32_t>(atom));
    for (int i = 0; i < 3; ++i) add(std::bit_cast<std::uint32_t>(force[i]));
    return bytes;
}

}  // namespace dock

// Any bytes from a simulation, cut anywhere, give the same frames as in one piece, or the same error. The
// first byte chooses the cuts; the second decides whether a handshake precedes the bytes.

#include <cstdlib>
#include <string>

#include "imd_reader.hpp"

using namespace dock;

namespace {

struct Read {
    std::size_t frames = 0;
    double sum = 0;
    std::string complaint;
    bool ended = false;
    bool operator==(const Read&) const = default;
};

Read read(const std::string& bytes, std::size_t cut) {
    Read result;
    ImdReader reader;
    try {
        for (std::size_t at = 0; at < bytes.size(); at += cut) {
            const std::string piece = bytes.substr(at, cut);
            reader.feed({reinterpret_cast<const std::byte*>(piece.data()), piece.size()});
            while (const auto frame = reader.next()) {
                ++result.frames;
                if (frame->atoms.empty()) std::abort();
                for (const auto& atom : frame->atoms) result.sum += atom.cast<double>().sum();
            }
        }
    } catch (const ImdError& error) {
        result.complaint = error.what();
    }
    result.ended = reader.ended();
    return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) return 0;
    std::string bytes;
    if (data[1] & 1)
        bytes = std::string("\0\0\0\4", 4) +
                (data[1] & 2 ? std::string("\2\0\0\0", 4) : std::string("\0\0\0\2", 4));
    bytes.append(reinterpret_cast<const char*>(data + 2), size - 2);
    if (!(read(bytes, 1 + data[0]) == read(bytes, bytes.size() + 1))) std::abort();
    return 0;
}

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <zstd.h>

#include <knurl/recording/mcap.hpp>
#include <knurl/words/printable.hpp>

#include "mcap_parts.hpp"

namespace knurl::recording {

using namespace mcap;

namespace {

constexpr std::uint64_t largest_record = 64u << 20;       // bytes; Knurl's have one or two MiB,
constexpr std::uint64_t largest_attachment = 512u << 20;  // except attachments

struct TooShort {};

/// Takes values from the front, one after the other.
class Parts {
  public:
    explicit Parts(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <class T>
    T take() {
        T value;
        std::memcpy(&value, bytes(sizeof value).data(), sizeof value);
        return value;
    }
    std::span<const std::byte> bytes(std::uint64_t n) {
        if (n > rest_.size()) throw TooShort();
        const auto front = rest_.first(n);
        rest_ = rest_.subspan(n);
        return front;
    }
    std::string text() {
        const auto all = bytes(take<std::uint32_t>());
        return {reinterpret_cast<const char*>(all.data()), all.size()};
    }
    McapMetadata map() {
        McapMetadata values;
        for (Parts all(bytes(take<std::uint32_t>())); !all.rest_.empty();) {
            std::string key = all.text();
            values[key] = all.text();
        }
        return values;
    }
    std::span<const std::byte> rest() const { return rest_; }

  private:
    std::span<const std::byte> rest_;
};

std::unique_ptr<std::istream> opened(const std::string& path) {
    auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
    if (!*file) throw std::runtime_error(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)));
    return file;
}

/// 0: it is no file with a size.
std::uint64_t size_of(const std::string& path) {
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    return failed ? 0 : bytes;
}

}  // namespace

McapReader::McapReader(const std::string& path) : McapReader(opened(path), size_of(path), path) {}

McapReader::McapReader(std::unique_ptr<std::istream> file, std::uint64_t bytes, const std::string& path)
    : path_(path), file_(std::move(file)), size_(bytes) {
    char begin[magic.size()] = {};
    if (size_ < sizeof begin || !file_->read(begin, sizeof begin) ||
        std::string_view(begin, sizeof begin) != magic)
        fail("is no MCAP file; give one that knurl record made");
    at_ = sizeof begin;
    crc_ = crc_of(magic);
    try {
        while (!ended_ && chunk_.empty() && read_record()) {
        }
    } catch (const TooShort&) {
        fail(fmt::format("the record before byte {} makes no sense: the file was changed", at_));
    }
}

void McapReader::fail(const std::string& what) const {
    throw std::runtime_error(path_ + ": " + words::printable(what, 300));
}

const McapMetadata* McapReader::metadata(const std::string& name) const {
    const auto found = metadata_.find(name);
    return found == metadata_.end() ? nullptr : &found->second;
}

std::uint16_t McapReader::channel(const std::string& topic) const {
    const auto found = channels_.find(topic);
    return found == channels_.end() ? std::uint16_t{0} : found->second;
}

bool McapReader::next(Message& out) {
    try {
        for (;;) {
            while (next_ < chunk_.size()) {
                Parts parts(std::span<const std::byte>(chunk_).subspan(next_));
                const auto op = parts.take<std::uint8_t>();
                Parts content(parts.bytes(parts.take<std::uint64_t>()));
                next_ = chunk_.size() - parts.rest().size();
                if (op != static_cast<std::uint8_t>(Op::message)) continue;
                out.channel = content.take<std::uint16_t>();
                content.take<std::uint32_t>();
                out.time_ns = static_cast<std::int64_t>(content.take<std::uint64_t>());
                content.take<std::uint64_t>();
                out.data = content.rest();
                return true;
            }
            if (ended_ || !read_record()) return false;
        }
    } catch (const TooShort&) {
        fail(fmt::format("the record before byte {} makes no sense: the file was changed", at_));
    }
}

/// Reads the next record. False: end of the file.
bool McapReader::read_record() {
    std::byte head[record_head];
    const auto cut = [&] {
        cut_off_ = at_;
        ended_ = true;
        return false;
    };
    if (size_ - at_ < sizeof head || !file_->read(reinterpret_cast<char*>(head), sizeof head)) return cut();
    Parts parts(head);
    const auto op = static_cast<Op>(parts.take<std::uint8_t>());
    const auto length = parts.take<std::uint64_t>();
    if (length > size_ - at_ - sizeof head) return cut();
    if (length > (op == Op::attachment ? largest_attachment : largest_record))
        fail(fmt::format("the record at byte {} is too long to be one of ours", at_));
    record_.resize(length);
    if (!file_->read(reinterpret_cast<char*>(record_.data()), static_cast<std::streamsize>(length)))
        return cut();

    const std::uint32_t crc_before = crc_;
    const std::uint64_t begin = at_;
    crc_ = crc_of(text_of(record_), crc_of(text_of(head), crc_));
    at_ += sizeof head + length;
    Parts content{std::span<const std::byte>(record_)};
    switch (op) {
        case Op::header:
            content.text();
            library_ = content.text();
            break;
        case Op::channel: {
            const auto id = content.take<std::uint16_t>();
            content.take<std::uint16_t>();
            channels_[content.text()] = id;
            break;
        }
        case Op::metadata: {
            const std::string name = content.text();
            metadata_[name] = content.map();
            break;
        }
        case Op::attachment:
            note_attachment(record_, begin + sizeof head);
            break;
        case Op::chunk:
            try {
                open_chunk(record_);
            } catch (const TooShort&) {
                fail(fmt::format("the chunk at byte {} makes no sense: the file was changed", begin));
            }
            break;
        case Op::data_end: {
            ended_ = true;
            if (const auto stated = content.take<std::uint32_t>(); stated != 0 && stated != crc_before)
                fail("its checksum is not that of its contents: the file was changed after it was recorded");
            return false;
        }
        default:
            break;
    }
    return true;
}

/// Its position; it is read again when needed.
void McapReader::note_attachment(std::span<const std::byte> content, std::uint64_t at) {
    if (content.size() < sizeof(std::uint32_t)) throw TooShort();
    const auto checked = content.first(content.size() - sizeof(std::uint32_t));
    Parts parts(content);
    parts.take<std::uint64_t>();
    parts.take<std::uint64_t>();
    const std::string name = parts.text();
    parts.text();
    const auto bytes = parts.take<std::uint64_t>();
    const std::uint64_t begin = content.size() - parts.rest().size();
    parts.bytes(bytes);
    const auto crc = parts.take<std::uint32_t>();
    if (crc != 0 && crc_of(text_of(checked)) != crc)
        fail(
            fmt::format("attachment {} does not match its checksum: the file was changed after it was "
                        "recorded",
                        name));
    attachments_[name] = {.at = at + begin, .bytes = bytes};
}

std::optional<std::vector<std::byte>> McapReader::attachment(const std::string& name) {
    const auto found = attachments_.find(name);
    if (found == attachments_.end()) return std::nullopt;
    std::vector<std::byte> bytes(found->second.bytes);
    const auto back = file_->tellg();
    if (!file_->seekg(static_cast<std::streamoff>(found->second.at)) ||
        !file_->read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())) ||
        !file_->seekg(back))
        fail("cannot be read: " + std::string(std::strerror(errno)));
    return bytes;
}

void McapReader::open_chunk(std::span<const std::byte> content) {
    Parts parts(content);
    parts.take<std::uint64_t>();
    parts.take<std::uint64_t>();
    const auto plain = parts.take<std::uint64_t>();
    const auto crc = parts.take<std::uint32_t>();
    const std::string compression = parts.text();
    const auto packed = parts.bytes(parts.take<std::uint64_t>());
    if (plain > largest_record) throw TooShort();
    // Before memory is taken for what a changed length claims.
    if (compression == "zstd") {
        const unsigned long long stated = ZSTD_getFrameContentSize(packed.data(), packed.size());
        if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated != plain) throw TooShort();
    }
    chunk_.resize(compression == "zstd" || packed.size() == plain ? plain : 0);
    next_ = 0;
    if (compression == "zstd") {
        const std::size_t n = ZSTD_decompress(chunk_.data(), chunk_.size(), packed.data(), packed.size());
        if (ZSTD_isError(n) != 0 || n != plain) throw TooShort();
    } else if (compression.empty() && packed.size() == plain) {
        std::copy(packed.begin(), packed.end(), chunk_.begin());
    } else {
        fail("its chunks are compressed by '" + compression + "'; knurl record writes zstd");
    }
    if (crc != 0 && crc_of(text_of(chunk_)) != crc)
        fail(fmt::format(
            "the chunk before byte {} does not match its checksum: the file was changed after it was "
            "recorded",
            at_));
}

}  // namespace knurl::recording

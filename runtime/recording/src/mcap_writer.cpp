#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <knurl/recording/mcap.hpp>

#include "mcap_parts.hpp"

namespace knurl::recording {

using namespace mcap;

namespace {

void put_string(std::string& to, std::string_view text) {
    put(to, static_cast<std::uint32_t>(text.size()));
    to += text;
}

void put_map(std::string& to, const McapMetadata& values) {
    std::string all;
    for (const auto& [key, value] : values) {
        put_string(all, key);
        put_string(all, value);
    }
    put_string(to, all);
}

template <class Key, class Value>
void put_map(std::string& to, const std::map<Key, Value>& values) {
    put(to, static_cast<std::uint32_t>(values.size() * (sizeof(Key) + sizeof(Value))));
    for (const auto& [key, value] : values) {
        put(to, key);
        put(to, value);
    }
}

std::string record(Op op, std::string_view content) {
    std::string all;
    put(all, static_cast<std::uint8_t>(op));
    put(all, std::uint64_t{content.size()});
    return all += content;
}

}  // namespace

McapWriter::McapWriter(const std::string& path, const std::string& library, Existing existing)
    : path_(path), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644)) {
    if (!file_)
        throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
    struct stat there {};
    if (::fstat(file_.get(), &there) == 0 && S_ISREG(there.st_mode) && there.st_size > 0) {
        if (existing == Existing::kept)
            throw std::runtime_error(path + ": is there already; --force replaces it, or give another name");
        if (::ftruncate(file_.get(), 0) != 0)
            throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, std::strerror(errno)));
    }
    std::string header;
    put_string(header, "");  // profile: none
    put_string(header, library);
    if (!write(std::string(magic) + record(Op::header, header))) throw std::runtime_error(problem_);
}

McapWriter::~McapWriter() = default;

/// Writes all of it or nothing.
bool McapWriter::write(std::string_view bytes) {
    const std::uint64_t at = at_;
    const std::uint32_t crc = crc_;
    if (write_on(bytes)) return true;
    take_back(at, crc);
    return false;
}

bool McapWriter::write_on(std::string_view bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t n = ::write(file_.get(), bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n > 0) {
            done += static_cast<std::size_t>(n);
            continue;
        }
        problem_ = fmt::format("{}: cannot be written: {}", path_, std::strerror(n < 0 ? errno : ENOSPC));
        return false;
    }
    at_ += bytes.size();
    crc_ = crc_of(bytes, crc_);
    return true;
}

/// Half a chunk would look like a file that was cut off.
void McapWriter::take_back(std::uint64_t at, std::uint32_t crc) {
    at_ = at;
    crc_ = crc;
    const auto end = static_cast<off_t>(at);
    if (::ftruncate(file_.get(), end) != 0 || ::lseek(file_.get(), end, SEEK_SET) != end)
        problem_ += fmt::format("; behind byte {} it is not whole", at_);
}

bool McapWriter::attach(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                        std::span<const std::byte> data, const std::function<void()>& between) {
    constexpr std::size_t slice = 1 << 20;
    const auto time = static_cast<std::uint64_t>(time_ns);
    std::string front;
    put(front, time);
    put(front, time);
    put_string(front, name);
    put_string(front, media_type);
    put(front, std::uint64_t{data.size()});
    std::string head;
    put(head, static_cast<std::uint8_t>(Op::attachment));
    put(head, std::uint64_t{front.size() + data.size() + sizeof(std::uint32_t)});
    const std::uint64_t at = at_;
    const std::uint32_t crc = crc_;
    std::uint32_t own = crc_of(front);
    bool written = write_on(head + front);
    for (std::size_t done = 0; written && done < data.size(); done += slice) {
        const std::string_view part = text_of(data.subspan(done, std::min(slice, data.size() - done)));
        own = crc_of(part, own);
        written = write_on(part);
        between();
    }
    std::string tail;
    put(tail, own);
    if (!written || !write_on(tail)) {
        take_back(at, crc);
        return false;
    }
    std::string index;
    for (const std::uint64_t value : {at, at_ - at, time, time, std::uint64_t{data.size()}})
        put(index, value);
    put_string(index, name);
    put_string(index, media_type);
    attachment_index_.push_back(record(Op::attachment_index, index));
    return true;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& encoding,
                                      const McapSchema* schema) {
    std::uint16_t schema_id = 0;
    if (schema != nullptr) {
        schema_id = static_cast<std::uint16_t>(schemas_.size() + 1);
        std::string content;
        put(content, schema_id);
        put_string(content, schema->name);
        put_string(content, schema->encoding);
        put_string(content, schema->text);
        schemas_.push_back(record(Op::schema, content));
    }
    const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
    std::string content;
    put(content, id);
    put(content, schema_id);
    put_string(content, topic);
    put_string(content, encoding);
    put_map(content, McapMetadata{});
    channels_.push_back(record(Op::channel, content));
    if (!write((schema != nullptr ? schemas_.back() : "") + channels_.back()))
        throw std::runtime_error(problem_);
    counts_[id] = 0;
    return id;
}

void McapWriter::add_metadata(const std::string& name, const McapMetadata& values) {
    std::string content;
    put_string(content, name);
    put_map(content, values);
    const std::string all = record(Op::metadata, content);
    std::string index;
    put(index, at_);
    put(index, std::uint64_t{all.size()});
    put_string(index, name);
    if (!write(all)) throw std::runtime_error(problem_);
    metadata_index_.push_back(record(Op::metadata_index, index));
}

void McapWriter::message(std::uint16_t channel, std::int64_t time_ns, std::span<const std::byte> head,
                         std::span<const std::byte> data) {
    const auto time = static_cast<std::uint64_t>(time_ns);
    first_ = pending_ == 0 ? time : std::min(first_, time);
    last_ = pending_ == 0 ? time : std::max(last_, time);
    ++pending_;
    std::string& places = chunk_messages_[channel];
    put(places, time);
    put(places, std::uint64_t{chunk_.size()});
    put(chunk_, static_cast<std::uint8_t>(Op::message));
    put(chunk_,
        std::uint64_t{sizeof channel + sizeof(std::uint32_t) + 2 * sizeof time + head.size() + data.size()});
    put(chunk_, channel);
    put(chunk_, sequences_[channel]++);
    put(chunk_, time);
    put(chunk_, time);
    chunk_ += text_of(head);
    chunk_ += text_of(data);
}

bool McapWriter::flush() {
    if (pending_ == 0) return true;
    constexpr int level = 1;  // fast, since a recorder must keep up; higher levels gain a few percent
    std::string compressed(ZSTD_compressBound(chunk_.size()), '\0');
    compressed.resize(
        ZSTD_compress(compressed.data(), compressed.size(), chunk_.data(), chunk_.size(), level));

    std::string content;
    put(content, first_);
    put(content, last_);
    put(content, std::uint64_t{chunk_.size()});
    put(content, crc_of(chunk_));
    put_string(content, "zstd");
    put(content, std::uint64_t{compressed.size()});
    content += compressed;
    std::string all = record(Op::chunk, content);
    ChunkIndex index{.first = first_,
                     .last = last_,
                     .at = at_,
                     .bytes = all.size(),
                     .compressed = compressed.size(),
                     .plain = chunk_.size(),
                     .message_indexes = {}};
    for (const auto& [channel, places] : chunk_messages_) {
        index.message_indexes[channel] = at_ + all.size();
        std::string of_channel;
        put(of_channel, channel);
        put_string(of_channel, places);
        all += record(Op::message_index, of_channel);
    }
    index.index_bytes = all.size() - index.bytes;
    const bool written = write(all);
    if (written) {
        chunks_.push_back(std::move(index));
        for (const auto& [channel, places] : chunk_messages_) counts_[channel] += places.size() / 16;
    }
    chunk_.clear();
    chunk_messages_.clear();
    pending_ = 0;
    return written;
}

bool McapWriter::finish() {
    if (!flush()) return false;
    std::string end;
    put(end, crc_);
    if (!write(record(Op::data_end, end))) return false;

    std::string summary;
    for (const auto* group : {&schemas_, &channels_})
        for (const std::string& one : *group) summary += one;
    std::string statistics;
    std::uint64_t messages = 0, first = chunks_.empty() ? 0 : chunks_.front().first, last = 0;
    for (const auto& [channel, count] : counts_) messages += count;
    for (const ChunkIndex& chunk : chunks_) {
        first = std::min(first, chunk.first);
        last = std::max(last, chunk.last);
    }
    put(statistics, messages);
    put(statistics, static_cast<std::uint16_t>(schemas_.size()));
    for (const std::size_t n :
         {channels_.size(), attachment_index_.size(), metadata_index_.size(), chunks_.size()})
        put(statistics, static_cast<std::uint32_t>(n));
    put(statistics, first);
    put(statistics, last);
    put_map(statistics, counts_);
    summary += record(Op::statistics, statistics);
    for (const ChunkIndex& chunk : chunks_) {
        std::string index;
        for (const std::uint64_t value : {chunk.first, chunk.last, chunk.at, chunk.bytes}) put(index, value);
        put_map(index, chunk.message_indexes);
        put(index, chunk.index_bytes);
        put_string(index, "zstd");
        put(index, chunk.compressed);
        put(index, chunk.plain);
        summary += record(Op::chunk_index, index);
    }
    for (const auto* group : {&attachment_index_, &metadata_index_})
        for (const std::string& one : *group) summary += one;

    std::string footer;
    put(footer, at_);
    put(footer, std::uint64_t{0});  // no summary offsets
    // The checksum covers the footer up to itself.
    std::string tail = summary + record(Op::footer, footer + std::string(sizeof(std::uint32_t), '\0'));
    tail.resize(tail.size() - sizeof(std::uint32_t));
    put(tail, crc_of(tail));
    return write(tail + std::string(magic));
}

}  // namespace knurl::recording

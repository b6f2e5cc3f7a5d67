#pragma once
// MCAP, the file format that Foxglove and PlotJuggler open (https://mcap.dev/spec): the part that a recording
// needs.
//
//   magic Header Schema... Channel... Metadata { Attachment | Chunk MessageIndex... }... DataEnd
//   Schema... Channel... Statistics ChunkIndex... AttachmentIndex... MetadataIndex... Footer magic
//
// Messages lie in chunks, each compressed separately (zstd) and with its own checksum. An index behind the
// last chunk gives their positions, so that a reader can seek. A file that was cut off has no index, but its
// whole chunks are read.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <istream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <knurl/shm/fd.hpp>

namespace knurl::recording {

using McapMetadata = std::map<std::string, std::string>;

struct McapSchema {
    std::string name, encoding, text;
};

/// What to do with an existing file that is not empty.
enum class Existing { kept, replaced };

class McapWriter {
  public:
    static constexpr std::size_t chunk_bytes = 1 << 20;

    /// Creates the file. Throws std::runtime_error.
    McapWriter(const std::string& path, const std::string& library, Existing existing = Existing::replaced);
    ~McapWriter();

    // Before the first message. Channels are numbered from 1; without a schema if only Knurl reads them.
    std::uint16_t add_channel(const std::string& topic, const std::string& encoding,
                              const McapSchema* schema);
    void add_metadata(const std::string& name, const McapMetadata& values);
    /// Placed before the messages since the last flush. `between`: called after each MiB, since a disk may be
    /// slow. False: it could not be written, as in flush().
    bool attach(const std::string& name, const std::string& media_type, std::int64_t time_ns,
                std::span<const std::byte> data, const std::function<void()>& between);

    void message(std::uint16_t channel, std::int64_t time_ns, std::span<const std::byte> head,
                 std::span<const std::byte> data);
    /// True: all since the last flush is in the file. False: it could not be written, and `problem` says why.
    /// It is dropped, and the file is as before.
    bool flush();
    bool full() const noexcept { return chunk_.size() >= chunk_bytes; }
    std::uint64_t pending() const noexcept { return pending_; }  // messages since the last flush
    /// Writes index and end. False: the disk is full; the messages can still be read.
    bool finish();
    std::uint64_t bytes() const noexcept { return at_; }
    const std::string& problem() const noexcept { return problem_; }

  private:
    struct ChunkIndex {
        std::uint64_t first = 0, last = 0, at = 0, bytes = 0, index_bytes = 0, compressed = 0, plain = 0;
        std::map<std::uint16_t, std::uint64_t> message_indexes;
    };
    bool write(std::string_view bytes);
    bool write_on(std::string_view bytes);
    void take_back(std::uint64_t at, std::uint32_t crc);
    std::string definitions() const;

    std::string path_;
    shm::UniqueFd file_;
    std::uint64_t at_ = 0;
    std::uint32_t crc_ = 0;  // of all bytes so far
    std::string problem_;
    std::vector<std::string> schemas_, channels_;                 // records
    std::vector<std::string> metadata_index_, attachment_index_;  // likewise
    std::string chunk_;
    std::map<std::uint16_t, std::string> chunk_messages_;  // time and position of each, by channel
    std::uint64_t first_ = 0, last_ = 0, pending_ = 0;     // of this chunk
    std::vector<ChunkIndex> chunks_;
    std::map<std::uint16_t, std::uint64_t> counts_;
    std::map<std::uint16_t, std::uint32_t> sequences_;
};

class McapReader {
  public:
    /// Reads up to the first message. Throws std::runtime_error: one line, with the path.
    explicit McapReader(const std::string& path);
    /// The same from any bytes, so many; `path` begins its errors.
    McapReader(std::unique_ptr<std::istream> file, std::uint64_t bytes, const std::string& path);

    struct Message {
        std::uint16_t channel = 0;
        std::int64_t time_ns = 0;
        std::span<const std::byte> data;  // until the next call
    };
    /// False: that was the last one. Throws std::runtime_error: the file was changed.
    bool next(Message& out);

    const std::string& library() const noexcept { return library_; }
    const McapMetadata* metadata(const std::string& name) const;
    /// Searches the part of the file that was read. None: it is not there.
    std::optional<std::vector<std::byte>> attachment(const std::string& name);
    /// 0: there is none.
    std::uint16_t channel(const std::string& topic) const;
    /// After next() has returned false: the file was cut off after this many whole bytes.
    std::optional<std::uint64_t> cut_off_at() const noexcept { return cut_off_; }

  private:
    bool read_record();
    void open_chunk(std::span<const std::byte> content);
    void note_attachment(std::span<const std::byte> content, std::uint64_t at);
    [[noreturn]] void fail(const std::string& what) const;

    std::string path_;
    std::unique_ptr<std::istream> file_;
    std::uint64_t size_ = 0, at_ = 0;
    std::uint32_t crc_ = 0;
    std::string library_;
    std::map<std::string, McapMetadata> metadata_;
    std::map<std::string, std::uint16_t> channels_;
    struct Attachment {
        std::uint64_t at = 0, bytes = 0;
    };
    std::map<std::string, Attachment> attachments_;
    std::vector<std::byte> record_, chunk_;
    std::size_t next_ = 0;  // in chunk_
    bool ended_ = false;
    std::optional<std::uint64_t> cut_off_;
};

}  // namespace knurl::recording

// Any bytes as a recording, as they are (first byte 0) or as records with valid lengths and checksums:
// refused in one line, or reports and inputs within their bounds. A piece (pieces.hpp) becomes a record; its
// control byte has the record's kind, and which parts are made valid.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <zlib.h>
#include <zstd.h>

#include <knurl/recording/recording.hpp>

#include "pieces.hpp"
#include "refusal.hpp"

using namespace knurl;
using fuzz::require;

namespace {

constexpr char magic[] = "\x89MCAP0\r\n";
constexpr unsigned kind_mask = 15, message = 5, chunk = 6, attachment = 9, metadata = 12, data_end = 15;
constexpr unsigned right = 16,    // the record is put into the form of its kind
    packed = 32, whole = 64,      // of a chunk: compressed; with its checksum
    of_reports = 32, of_us = 64;  // of a message: its channel; as long as a report, or the head of an input

template <class T>
void put(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void put_text(std::string& to, std::string_view text) {
    put(to, static_cast<std::uint32_t>(text.size()));
    to += text;
}
void put_record(std::string& to, unsigned op, std::string_view content) {
    to += static_cast<char>(op);
    put(to, std::uint64_t{content.size()});
    to += content;
}
std::uint32_t crc_of(std::string_view bytes) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// The header, channels and metadata that Knurl writes.
std::string valid_head() {
    std::string head(magic, 8), content;
    put_text(content, "");
    put_text(content, "Knurl 0.1.0");
    put_record(head, 1, content);
    for (const auto& [id, topic] : {std::pair(1, "/x/report"), {2, "/knurl/inputs"}}) {
        content.clear();
        put(content, static_cast<std::uint16_t>(id));
        put(content, std::uint16_t{0});
        put_text(content, topic);
        put_record(head, 4, content);
    }
    std::string map;
    const auto tell = [&map](std::string_view key, std::string_view value) {
        put_text(map, key);
        put_text(map, value);
    };
    for (const char* key : {"servo", "device", "address", "profile"}) tell(key, "x");
    tell("version", "0.1.0");
    for (const char* key : {"wire", "tape", "device_figures", "realtime_offset_ns"}) tell(key, "1");
    for (const char* key : {"rate",
                            "max_dt",
                            "silence",
                            "start_active",
                            "sleep",
                            "clamp_stiffness",
                            "budget",
                            "rise_speed",
                            "automatic_recovery",
                            "limits.peak_force",
                            "limits.continuous_force",
                            "limits.peak_torque",
                            "limits.thermal_time",
                            "limits.slew",
                            "limits.slew_fault_time",
                            "limits.speed_damping_from",
                            "limits.speed_fault",
                            "limits.speed_damping",
                            "limits.power",
                            "limits.power_time",
                            "limits.ramp_up",
                            "limits.ramp_down",
                            "limits.claim_ramp",
                            "limits.arm_speed",
                            "limits.stall",
                            "limits.clock_jump",
                            "limits.workspace_margin",
                            "limits.off"})
        tell(key, "1000");
    content.clear();
    put_text(content, "knurl");
    put_text(content, map);
    put_record(head, metadata, content);
    return head;
}

/// Makes records of pieces.
class Builder {
  public:
    void add(unsigned control, std::string_view bytes) {
        const unsigned op = control & kind_mask;
        std::string content;
        if ((control & right) == 0) {
            content = bytes;
        } else if (op == message) {
            return add_message(control, bytes);
        } else if (op == chunk) {
            content = chunk_of(control);
        } else if (op == attachment) {
            content.assign(16, '\0');
            put_text(content, "asset-0000000000000000000000000000000000000000000000000000000000000000");
            put_text(content, "");
            put(content, std::uint64_t{bytes.size()});
            content += bytes;
            put(content, crc_of(content));
        } else if (op == data_end) {
            put(content, crc_of(file));
        } else {
            content = bytes;
        }
        put_record(file, op, content);
    }
    std::string file = valid_head();

  private:
    void add_message(unsigned control, std::string_view bytes) {
        std::string content;
        put(content, static_cast<std::uint16_t>((control & of_reports) != 0 ? 1 : 2));
        content.append(20, '\0');
        std::string body(bytes);
        if ((control & of_us) != 0)
            body.resize((control & of_reports) != 0 ? 4 + sizeof(Report)
                                                    : std::max<std::size_t>(8, body.size()));
        put_record(chunk_, message, content + body);
    }
    std::string chunk_of(unsigned control) {
        std::string content(16, '\0'), inside = chunk_;
        put(content, std::uint64_t{chunk_.size()});
        put(content, (control & whole) != 0 ? crc_of(chunk_) : 0);
        if ((control & packed) != 0) {
            inside.resize(ZSTD_compressBound(chunk_.size()));
            inside.resize(ZSTD_compress(inside.data(), inside.size(), chunk_.data(), chunk_.size(), 1));
        }
        put_text(content, (control & packed) != 0 ? "zstd" : "");
        put(content, std::uint64_t{inside.size()});
        chunk_.clear();
        return content + inside;
    }
    std::string chunk_;
};

void check_recording(std::string bytes) {
    const std::uint64_t size = bytes.size();
    recording::RecordingReader reader(
        recording::McapReader(std::make_unique<std::istringstream>(std::move(bytes)), size, "r.mcap"),
        "r.mcap");
    require(reader.info().options.rate >= 500, "a servo has a rate");
    using Item = recording::RecordingReader::Item;
    std::size_t items = 0;
    for (Item item = reader.next(); item != Item::end; item = reader.next()) ++items;
    require(reader.next() == Item::end, "the end stays the end");
    require(!reader.cut_off_at() || *reader.cut_off_at() <= size, "it is cut off within itself");
    try {
        reader.require_this_build();
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "r.mcap: ");
    }
    try {
        reader.asset({});
        require(false, "an asset has the digest that its name says");
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1) return 0;
    std::string bytes;
    if (data[0] == 0) {
        bytes.assign(reinterpret_cast<const char*>(data + 1), size - 1);
    } else {
        Builder builder;
        fuzz::Pieces pieces({data + 1, size - 1});
        for (fuzz::Pieces::Piece piece; pieces.next(piece);)
            builder.add(piece.control,
                        {reinterpret_cast<const char*>(piece.bytes.data()), piece.bytes.size()});
        bytes = std::move(builder.file);
    }
    try {
        check_recording(std::move(bytes));
    } catch (const std::runtime_error& error) {
        fuzz::check_refusal(error.what(), "r.mcap: ");
    }
    return 0;
}

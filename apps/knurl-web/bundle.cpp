#include "bundle.hpp"

#include <array>
#include <deque>
#include <stdexcept>
#include <string>
#include <utility>

#include <openssl/sha.h>
#include <zlib.h>

namespace knurl::web {

namespace {

std::string_view type_of(std::string_view path) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 9> types{{
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".txt", "text/plain; charset=utf-8"},
        {".json", "application/json"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".ico", "image/x-icon"},
        {".wasm", "application/wasm"},
    }};
    for (const auto& [end, type] : types)
        if (path.ends_with(end)) return type;
    return "application/octet-stream";
}

std::string name_of(std::string_view content) {
    std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
    SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(), digest.data());
    constexpr std::string_view digits = "0123456789abcdef";
    std::string name;
    for (std::size_t i = 0; i < 12; ++i) {
        name += digits[digest[i] >> 4];
        name += digits[digest[i] & 15];
    }
    return name;
}

/// Empty: it would not become smaller.
std::string compressed(std::string_view content) {
    z_stream stream{};
    constexpr int gzip = 15 + 16;
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, gzip, 9, Z_DEFAULT_STRATEGY) != Z_OK) return {};
    std::string out(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return whole && out.size() < content.size() ? out : std::string();
}

}  // namespace

const std::vector<gateway::StaticFile>& page_files() {
    static std::deque<std::string> texts;  // what the views below look at
    static const std::vector<gateway::StaticFile> files = [] {
        std::vector<gateway::StaticFile> made;
        for (const BundledFile& each : bundled_files()) {
            const std::string& name = texts.emplace_back(name_of(each.content));
            const std::string& gzip = texts.emplace_back(compressed(each.content));
            made.push_back({.path = each.path,
                            .content_type = type_of(each.path),
                            .etag = name,
                            .content = each.content,
                            .gzip = gzip});
        }
        return made;
    }();
    return files;
}

}  // namespace knurl::web

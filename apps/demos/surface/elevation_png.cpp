#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <png.h>

#include "elevation.hpp"
#include "elevation_words.hpp"

namespace surface {
namespace {

constexpr png_alloc_size_t most_at_once =
    64 << 20;                              // bytes that libpng may allocate, whatever a damaged chunk says
constexpr std::size_t most_packed = 1032;  // the best compression ratio of deflate

struct Source {
    std::string_view rest;
};

/// libpng reports errors by longjmp. So everything with a destructor is in this struct, outside the jump.
struct Decoding {
    Source source;
    png_structp png = nullptr;
    png_infop info = nullptr;
    char problem[256] = {};
    std::vector<unsigned char> bytes;
    std::vector<png_bytep> row_starts;
    ~Decoding() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_error(png_structp png, png_const_charp text) {
    auto* decoding = static_cast<Decoding*>(png_get_error_ptr(png));
    std::strncpy(decoding->problem, text, sizeof decoding->problem - 1);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

png_voidp allocate(png_structp, png_alloc_size_t bytes) {
    return bytes > most_at_once ? nullptr : std::malloc(bytes);
}
void release(png_structp, png_voidp memory) {
    std::free(memory);
}

void read_from(png_structp png, png_bytep out, std::size_t count) {
    auto* source = static_cast<Source*>(png_get_io_ptr(png));
    if (source->rest.size() < count) png_error(png, "it ends too early");
    std::memcpy(out, source->rest.data(), count);
    source->rest.remove_prefix(count);
}

/// False: `problem` has the reason. Contains no object with a destructor.
bool read_header(Decoding& d) {
    if (setjmp(png_jmpbuf(d.png))) return false;
    png_set_read_fn(d.png, &d.source, read_from);
    png_read_info(d.png, d.info);
    return true;
}

bool read_pixels(Decoding& d) {
    if (setjmp(png_jmpbuf(d.png))) return false;
    png_read_image(d.png, d.row_starts.data());
    png_read_end(d.png, d.info);
    return true;
}

std::optional<double> text_number(const Decoding& d, const char* key, const std::string& name) {
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(d.png, d.info, &texts, &count);
    for (int i = 0; i < count; ++i) {
        if (std::strcmp(texts[i].key, key) != 0 || texts[i].text == nullptr) continue;
        Words words{.rest = texts[i].text};
        const std::string_view word = words.next();
        const auto value = number_with_comma(word);
        const bool thousands =
            word.find(',') != word.npos && word.size() - word.find(',') == 4 && word[0] != '0';
        if (!value || !(*value > 0) || !std::isfinite(*value) || thousands || !words.next().empty())
            throw std::runtime_error(fmt::format(
                "{}: the PNG's text {} is \"{}\", not a number above 0; write it with a decimal point", name,
                key, shown(texts[i].text)));
        return value;
    }
    return std::nullopt;
}

/// The grey value that means "nothing here". None: every pixel is a height.
std::optional<double> transparent(const Decoding& d) {
    png_bytep alphas = nullptr;
    int count = 0;
    png_color_16p grey = nullptr;
    if ((png_get_tRNS(d.png, d.info, &alphas, &count, &grey) & PNG_INFO_tRNS) == 0 || grey == nullptr)
        return std::nullopt;
    return grey->gray;
}

}  // namespace

ElevationModel read_png(std::string_view bytes, const std::string& name) {
    Decoding d;
    d.source.rest = bytes;
    d.png =
        png_create_read_struct_2(PNG_LIBPNG_VER_STRING, &d, on_error, on_warning, nullptr, allocate, release);
    if (d.png == nullptr) throw std::runtime_error(name + ": libpng could not start (out of memory?)");
    d.info = png_create_info_struct(d.png);
    if (d.info == nullptr) throw std::runtime_error(name + ": libpng could not start (out of memory?)");

    const auto damaged = [&] {
        return std::runtime_error(fmt::format(
            "{}: this PNG is damaged or truncated ({}); write or fetch it again", name, d.problem));
    };
    if (!read_header(d)) throw damaged();
    const long columns = png_get_image_width(d.png, d.info), rows = png_get_image_height(d.png, d.info);
    if (png_get_color_type(d.png, d.info) != PNG_COLOR_TYPE_GRAY)
        throw std::runtime_error(name +
                                 ": this PNG has colours or transparency, heights are one channel; export it "
                                 "as 16-bit greyscale");
    if (const int depth = png_get_bit_depth(d.png, d.info); depth != 16)
        throw std::runtime_error(
            fmt::format("{}: this PNG has {} bits a sample, which would be felt as stairs; export "
                        "it as 16-bit greyscale",
                        name, depth));
    check_sides(name, rows, columns);

    // Before memory is allocated by a damaged header.
    const auto wanted = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    if (2 * wanted / most_packed > bytes.size())
        throw std::runtime_error(
            fmt::format("{}: this PNG is damaged or truncated: its {} bytes cannot hold {} x {} samples; "
                        "write or fetch it again",
                        name, bytes.size(), rows, columns));
    const auto row_bytes = static_cast<std::size_t>(columns) * 2;
    d.bytes.resize(static_cast<std::size_t>(rows) * row_bytes);
    for (long r = 0; r < rows; ++r)
        d.row_starts.push_back(d.bytes.data() + static_cast<std::size_t>(r) * row_bytes);
    if (!read_pixels(d)) throw damaged();

    ElevationModel model{.rows = static_cast<int>(rows), .columns = static_cast<int>(columns)};
    model.counts.reserve(d.bytes.size() / 2);
    for (std::size_t i = 0; i < d.bytes.size(); i += 2)
        model.counts.push_back(d.bytes[i] * 256 + d.bytes[i + 1]);
    if (const auto gap = transparent(d))
        for (std::size_t i = 0; i < model.counts.size(); ++i)
            if (model.counts[i] == *gap)
                throw cell_error(name, i, model.columns, no_height(fmt::format("{}, transparent", *gap)));
    check_byte_order(model, name);
    model.metres_per_count = text_number(d, key_metres_per_count, name);
    model.metres_per_cell = text_number(d, key_metres_per_cell, name);
    model.scale_source = "the PNG's text";
    return model;
}

}  // namespace surface

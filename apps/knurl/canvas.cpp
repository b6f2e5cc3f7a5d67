#include "canvas.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <png.h>

namespace knurl::cli {

namespace {

struct Glyph {
    char letter;
    std::string_view dots;  // 3 wide, 5 high, row by row
};

constexpr Glyph glyphs[] = {
    {'0', "####.##.##.####"}, {'1', ".#.##..#..#.###"}, {'2', "##...#.#.#..###"}, {'3', "###..#.##..####"},
    {'4', "#.##.####..#..#"}, {'5', "####..##...###."}, {'6', ".###..####.####"}, {'7', "###..#.#.#..#.."},
    {'8', "####.#####.####"}, {'9', "####.####..###."}, {'A', ".#.#.#####.##.#"}, {'B', "##.#.###.#.###."},
    {'C', ".###..#..#...##"}, {'D', "##.#.##.##.###."}, {'E', "####..##.#..###"}, {'F', "####..##.#..#.."},
    {'G', ".###..#.##.#.##"}, {'H', "#.##.#####.##.#"}, {'I', "###.#..#..#.###"}, {'J', "..#..#..##.#.#."},
    {'K', "#.##.###.#.##.#"}, {'L', "#..#..#..#..###"}, {'M', "#.########.##.#"}, {'N', "##.#.##.##.##.#"},
    {'O', ".#.#.##.##.#.#."}, {'P', "##.#.###.#..#.."}, {'Q', ".#.#.##.#.#..##"}, {'R', "##.#.###.#.##.#"},
    {'S', ".###...#...###."}, {'T', "###.#..#..#..#."}, {'U', "#.##.##.##.####"}, {'V', "#.##.##.##.#.#."},
    {'W', "#.##.########.#"}, {'X', "#.##.#.#.#.##.#"}, {'Y', "#.##.#.#..#..#."}, {'Z', "###..#.#.#..###"},
    {'.', ".............#."}, {',', "..........#.#.."}, {':', "....#.....#...."}, {'=', "...###...###..."},
    {'-', "......###......"}, {'+', "....#.###.#...."}, {'/', "..#..#.#.#..#.."}, {'(', ".#.#..#..#...#."},
    {')', ".#...#..#..#.#."}, {'%', "#.#..#.#.#..#.#"},
};

static_assert([] {
    for (const Glyph& glyph : glyphs)
        if (glyph.dots.size() != 15) return false;
    return true;
}());

}  // namespace

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width * height) * 3, 255) {}

void Canvas::blend(int x, int y, double share, Colour colour) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_ || !(share > 0)) return;
    share = std::min(share, 1.0);
    std::uint8_t* pixel = &pixels_[static_cast<std::size_t>(y * width_ + x) * 3];
    const double parts[] = {colour.red, colour.green, colour.blue};
    for (int i = 0; i < 3; ++i)
        pixel[i] = static_cast<std::uint8_t>(std::lround((1 - share) * pixel[i] + share * 255 * parts[i]));
}

void Canvas::dot(double x, double y, double radius, Colour colour) {
    line(x, y, x, y, 2 * radius, colour);
}

void Canvas::line(double x0, double y0, double x1, double y1, double width, Colour colour) {
    const double half = width / 2, dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy;
    const auto from = [&](double a, double b) {
        return static_cast<int>(std::floor(std::min(a, b) - half - 1));
    };
    const auto to = [&](double a, double b) {
        return static_cast<int>(std::ceil(std::max(a, b) + half + 1));
    };
    for (int y = std::max(0, from(y0, y1)); y <= std::min(height_ - 1, to(y0, y1)); ++y) {
        for (int x = std::max(0, from(x0, x1)); x <= std::min(width_ - 1, to(x0, x1)); ++x) {
            const double along =
                square > 0 ? std::clamp(((x - x0) * dx + (y - y0) * dy) / square, 0.0, 1.0) : 0.0;
            const double away = std::hypot(x - x0 - along * dx, y - y0 - along * dy);
            blend(x, y, half + 0.5 - away, colour);  // a soft edge of one pixel
        }
    }
}

void Canvas::circle(double x, double y, double radius, double width, Colour colour) {
    constexpr int parts = 120;
    for (int i = 0; i < parts; ++i) {
        const double a = 2 * std::numbers::pi * i / parts, b = 2 * std::numbers::pi * (i + 1) / parts;
        line(x + radius * std::cos(a), y + radius * std::sin(a), x + radius * std::cos(b),
             y + radius * std::sin(b), width, colour);
    }
}

void Canvas::words(double x, double y, std::string_view text, int size, Colour colour) {
    int left = static_cast<int>(std::lround(x));
    const int top = static_cast<int>(std::lround(y));
    for (const char c : text) {
        const char letter = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
        for (const Glyph& glyph : glyphs) {
            if (glyph.letter != letter) continue;
            for (int i = 0; i < static_cast<int>(glyph.dots.size()); ++i) {
                if (glyph.dots[static_cast<std::size_t>(i)] != '#') continue;
                for (int k = 0; k < size * size; ++k)
                    blend(left + i % 3 * size + k % size, top + i / 3 * size + k / size, 1, colour);
            }
        }
        left += 4 * size;
    }
}

void Canvas::write(const std::string& path) const {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width_);
    image.height = static_cast<png_uint_32>(height_);
    image.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&image, path.c_str(), 0, pixels_.data(), 0, nullptr) == 0)
        throw std::runtime_error(path + ": cannot be written: " + image.message);
}

}  // namespace knurl::cli

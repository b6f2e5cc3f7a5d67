#pragma once
// A picture in memory: dots, lines, a few words; written as a PNG.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace knurl::cli {

struct Colour {
    double red = 0, green = 0, blue = 0;  // 0 to 1
};

class Canvas {
  public:
    Canvas(int width, int height);  // white

    // Pixels from the left and from the top; what is outside is not drawn.
    void dot(double x, double y, double radius, Colour colour);
    void line(double x0, double y0, double x1, double y1, double width, Colour colour);
    void circle(double x, double y, double radius, double width, Colour colour);
    /// Capitals, digits and . , : = - + / ( ) %; others are blank. `size`: pixels of a letter's dot.
    void words(double x, double y, std::string_view text, int size, Colour colour);

    /// Throws std::runtime_error: the file cannot be written.
    void write(const std::string& path) const;

  private:
    void blend(int x, int y, double share, Colour colour);

    int width_, height_;
    std::vector<std::uint8_t> pixels_;  // RGB, row by row
};

}  // namespace knurl::cli

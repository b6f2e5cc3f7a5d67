// Files of elevation models: what is read, and the one-line message for what cannot be read.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "surface/elevation.hpp"
#include "surface/relief.hpp"

namespace {

using surface::ElevationModel;
using testing::AllOf;
using testing::HasSubstr;

class Elevation : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  ("knurl-elevation-" + std::to_string(getpid()) + "-" +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path file(const std::string& name, const std::string& bytes) {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    std::string refusal(const std::filesystem::path& path) {
        try {
            surface::load_elevation(path);
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), HasSubstr(path.filename().string()));
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
            return error.what();
        }
        return "it was read";
    }

    /// A greyscale (or other) PNG written by libpng.
    std::filesystem::path png(const std::string& name, int columns, int rows, int depth,
                              int colour = PNG_COLOR_TYPE_GRAY,
                              const std::vector<std::pair<std::string, std::string>>& texts = {},
                              int interlace = PNG_INTERLACE_NONE) {
        const auto path = folder_ / name;
        FILE* out = std::fopen(path.c_str(), "wb");
        png_structp p = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
        png_infop info = png_create_info_struct(p);
        png_init_io(p, out);
        png_set_IHDR(p, info, static_cast<png_uint_32>(columns), static_cast<png_uint_32>(rows), depth,
                     colour, interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
        for (auto [key, value] : texts) {
            png_text text{};
            text.compression = PNG_TEXT_COMPRESSION_NONE;
            text.key = key.data();
            text.text = value.data();
            png_set_text(p, info, &text, 1);
        }
        if (transparent_) {
            png_color_16 colour_of{};
            colour_of.gray = *transparent_;
            png_set_tRNS(p, info, nullptr, 0, &colour_of);
        }
        png_write_info(p, info);
        const auto row_bytes = png_get_rowbytes(p, info);
        std::vector<unsigned char> bytes(row_bytes * static_cast<std::size_t>(rows));
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<unsigned char>(i * 37);
        std::vector<png_bytep> starts;
        for (int r = 0; r < rows; ++r)
            starts.push_back(bytes.data() + row_bytes * static_cast<std::size_t>(r));
        png_write_image(p, starts.data());
        png_write_end(p, info);
        png_destroy_write_struct(&p, &info);
        std::fclose(out);
        written_ = bytes;
        return path;
    }

    std::filesystem::path folder_;
    std::vector<unsigned char> written_;
    std::optional<png_uint_16> transparent_ = {};  // the grey that png() marks as transparent
};

TEST_F(Elevation, A16BitPngIsReadToTheCountWithItsScale) {
    for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
        const auto path =
            png("hills.png", 7, 5, 16, PNG_COLOR_TYPE_GRAY,
                {{"knurl:metres_per_count", "0.25"}, {"knurl:metres_per_cell", "83.03"}}, interlace);
        const ElevationModel model = surface::load_elevation(path);
        EXPECT_EQ(model.rows, 5);
        EXPECT_EQ(model.columns, 7);
        ASSERT_EQ(model.counts.size(), 35u);
        for (std::size_t i = 0; i < 35; ++i)
            EXPECT_EQ(model.counts[i], written_[2 * i] * 256 + written_[2 * i + 1]);
        EXPECT_EQ(model.metres_per_count, 0.25);
        EXPECT_EQ(model.metres_per_cell, 83.03);
        EXPECT_EQ(model.name, "hills.png");
    }
}

TEST_F(Elevation, APngWithoutScaleSaysNothingOfIt) {
    const ElevationModel model = surface::load_elevation(png("bare.png", 4, 4, 16));
    EXPECT_FALSE(model.metres_per_count);
    EXPECT_FALSE(model.metres_per_cell);
}

TEST_F(Elevation, OtherPngsAreRefusedWithWhatToDo) {
    EXPECT_THAT(refusal(png("shallow.png", 5, 5, 8)),
                AllOf(HasSubstr("8 bits"), HasSubstr("16-bit greyscale")));
    EXPECT_THAT(refusal(png("colours.png", 5, 5, 16, PNG_COLOR_TYPE_RGB)), HasSubstr("16-bit greyscale"));
    EXPECT_THAT(refusal(png("row.png", 50, 1, 16)), AllOf(HasSubstr("1 row of 50"), HasSubstr("4 x 4")));
}

TEST_F(Elevation, ATruncatedPngIsRefusedWhereverItEnds) {
    const auto whole = png("whole.png", 20, 20, 16);
    std::ifstream in(whole, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t length = 8; length < bytes.size(); length += 7)
        EXPECT_THAT(refusal(file("cut.png", bytes.substr(0, length))), HasSubstr("truncated")) << length;
}

TEST_F(Elevation, PgmsOfBothKindsAreRead) {
    std::string binary = "P5\n# by hand\n4 4\n65535\n";
    for (int i = 0; i < 16; ++i) binary += {static_cast<char>(i), static_cast<char>(255 - i)};
    const ElevationModel five = surface::load_elevation(file("b.pgm", binary));
    for (int i = 0; i < 16; ++i) EXPECT_EQ(five.counts[static_cast<std::size_t>(i)], i * 256 + 255 - i);

    const ElevationModel two = surface::load_elevation(
        file("t.pgm", "P2 4 4 1000\n0 1 2 3 # west\n4 5 6 7\n8 9 10 11 12 13 14 1000\n"));
    EXPECT_EQ(two.counts.front(), 0);
    EXPECT_EQ(two.counts.back(), 1000);
}

TEST_F(Elevation, BadPgmsAreRefused) {
    EXPECT_THAT(refusal(file("8.pgm", "P5 4 4 255\n0123456789abcdef")), HasSubstr("16 bits"));
    EXPECT_THAT(refusal(file("cut.pgm", "P5 4 4 65535\n0123")),
                AllOf(HasSubstr("truncated"), HasSubstr("2 of 16")));
    EXPECT_THAT(refusal(file("cut2.pgm", "P2 4 4 65535\n1 2 3")),
                AllOf(HasSubstr("truncated"), HasSubstr("3 of 16")));
    EXPECT_THAT(refusal(file("range.pgm", "P2 4 4 1000\n1 2 3 4 5 6 7 8 9 10 1001 1 1 1 1 1")),
                AllOf(HasSubstr("row 3, column 3"), HasSubstr("1001")));
    EXPECT_THAT(refusal(file("head.pgm", "P2 four 4 1000\n")), HasSubstr("header"));
    EXPECT_THAT(refusal(file("row.pgm", "P2 9 1 1000\n1 2 3 4 5 6 7 8 9")), HasSubstr("1 row of 9"));
}

const char* const grid_head = "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 30\nNODATA_value -9999\n";

TEST_F(Elevation, EsriGridsAreReadInMetres) {
    const ElevationModel model = surface::load_elevation(
        file("g.asc", std::string(grid_head) + "1 2 3 4\n5 6 7 8\n9 10 11.5 12\n13 14 15 -1e1\n"));
    EXPECT_EQ(model.counts[10], 11.5);
    EXPECT_EQ(model.counts[15], -10);
    EXPECT_EQ(model.metres_per_count, 1);
    EXPECT_EQ(model.metres_per_cell, 30);
}

TEST_F(Elevation, AnEsriGridInDegreesIsScaledByItsLatitudeAndSaysSo) {
    const ElevationModel model =
        surface::load_elevation(file("deg.asc",
                                     "NCOLS 4\nNROWS 4\nXLLCENTER -84\nYLLCENTER 60\nCELLSIZE 0.001\n1 2 3 4 "
                                     "5 6 7 8 9 10 11 12 13 14 15 16"));
    EXPECT_NEAR(*model.metres_per_cell, 111.195 * std::sqrt(0.5), 0.02);
    EXPECT_THAT(model.scale_source, HasSubstr("degrees"));
}

TEST_F(Elevation, CellsWithoutHeightAreNamedByRowAndColumn) {
    const std::string head = grid_head;
    EXPECT_THAT(refusal(file("nan.asc", head + "1 2 3 4\n5 6 nan 8\n9 10 11 12\n13 14 15 16")),
                AllOf(HasSubstr("row 2, column 3"), HasSubstr("no height"), HasSubstr("gdal_fillnodata")));
    EXPECT_THAT(refusal(file("gap.asc", head + "1 2 3 4\n5 6 7 8\n9 10 11 12\n13 -9999 15 16")),
                HasSubstr("row 4, column 2"));
    EXPECT_THAT(refusal(file("word.asc", head + "1 2 3 4\n5 x7 7 8\n9 10 11 12\n13 14 15 16")),
                AllOf(HasSubstr("row 2, column 2"), HasSubstr("x7")));
    EXPECT_THAT(refusal(file("first.asc", head + "nan 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16")),
                HasSubstr("row 1, column 1"));
}

TEST_F(Elevation, BadEsriGridsAreRefused) {
    const std::string head = grid_head;
    EXPECT_THAT(refusal(file("cut.asc", head + "1 2 3 4 5")),
                AllOf(HasSubstr("truncated"), HasSubstr("5 of 16")));
    EXPECT_THAT(refusal(file("more.asc", head + "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17")),
                HasSubstr("more than"));
    EXPECT_THAT(refusal(file("lacks.asc", "ncols 4\nnrows 4\n1 2 3 4")), HasSubstr("cellsize"));
    EXPECT_THAT(refusal(file("odd.asc", "ncols 4\nncows 4\ncellsize 1\n1 2 3")), HasSubstr("ncows"));
    EXPECT_THAT(refusal(file("row.asc", "ncols 9\nnrows 1\ncellsize 1\n1 2 3 4 5 6 7 8 9")),
                HasSubstr("1 row of 9"));
}

const std::string sixteen = "1 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16\n";

TEST_F(Elevation, AGridIsReadHoweverItsHeaderIsWritten) {
    const std::string head = "ncols 4\nnrows 4\ncellsize 30\n";
    for (const auto& [what, text] : std::vector<std::pair<std::string, std::string>>{
             {"a byte order mark", "\xef\xbb\xbf" + head + sixteen},
             {"dx and dy", "ncols 4\nnrows 4\ndx 30\ndy 30.0000\n" + sixteen},
             {"comments", "# made by us\n// here\n; so\n" + head + "# heights\n" + sixteen + "# end\n"},
             {"carriage returns",
              "ncols 4\r\nnrows 4\r\ncellsize 30\r\n1 2 3 4\r\n5 6 7 8\r\n9 10 11 12\r\n13 14 15 16\r\n"},
             {"another order",
              "NODATA_value -9999\ncellsize 3.0e+01\nYLLCENTER 5e6\nNROWS 4\nNCOLS 4\n" + sixteen},
             {"no value for what is not there", head + "NODATA_value null\n" + sixteen},
             {"one line", "ncols 4 nrows 4 cellsize 30 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16"},
         }) {
        SCOPED_TRACE(what);
        const ElevationModel model = surface::load_elevation(file("g.asc", text));
        EXPECT_EQ(model.metres_per_cell, 30);
        for (int i = 0; i < 16; ++i) EXPECT_EQ(model.counts[static_cast<std::size_t>(i)], i + 1);
    }
}

TEST_F(Elevation, WhatStandsForNoHeightIsKnownHoweverItIsWritten) {
    const std::string head = "ncols 4\nnrows 4\ncellsize 30\n";
    for (const auto& [nodata, cell] : std::vector<std::pair<std::string, std::string>>{
             {"", "-9999"},
             {"", "-9999.0"},
             {"", "-32768"},
             {"", "-3.40282e+38"},
             {"", "null"},
             {"", "NaN"},
             {"", "1.#QNAN"},
             {"-9999", "-9999.000"},
             {"-3.4028234663852886e+38", "-3.40282e+38"},
             {"-3.40282e+38", "-3.4028234663852886e+38"},
             {"-1.7976931348623157e+308", "-1.797693e+308"},
             {"-99999.9", "-99999.8984375"},
             {"9999", "9999"},
             {"nan", "-nan"},
             {"void", "VOID"},
             {"", "-1e+20"},
         }) {
        SCOPED_TRACE(nodata + " in the header, " + cell);
        const std::string text = head + (nodata.empty() ? "" : "NODATA_value " + nodata + "\n") +
                                 "1 2 3 4\n5 6 7 " + cell + "\n9 10 11 12\n13 14 15 16\n";
        EXPECT_THAT(refusal(file("gap.asc", text)),
                    AllOf(HasSubstr("row 2, column 4 has no height (" + cell + ")")));
    }
    // If the header names another value, -9999 is a height in the deepest sea, but a gap of a merged grid on
    // land.
    std::string sea = head + "NODATA_value -32768\n-9999";
    for (int i = 1; i < 16; ++i) sea += " -" + std::to_string(9999 - 100 * i);
    EXPECT_EQ(surface::load_elevation(file("deep.asc", sea)).counts[0], -9999);
    EXPECT_THAT(refusal(file("land.asc", head + "NODATA_value -32768\n-9999" + sixteen.substr(1))),
                HasSubstr("row 1, column 1 has no height (-9999)"));
}

TEST_F(Elevation, WhatATerminalWouldObeyIsNotPassedOn) {
    const std::string head = "ncols 4\nnrows 4\ncellsize 30\n", red = "\x1b[31mred";
    EXPECT_THAT(refusal(file("cell.asc", head + red + sixteen.substr(1))), HasSubstr("\"?[31mred\""));
    EXPECT_THAT(refusal(file("key.asc", head + "r" + red + " 3\n" + sixteen)), HasSubstr("\"r?[31mred\""));
    EXPECT_THAT(refusal(file("value.asc", "ncols " + red + "\n")),
                HasSubstr("\"?[31mred\", not a whole number"));
    EXPECT_THAT(refusal(file("head.pgm", "P2 " + red + " 4 1000\n")), HasSubstr("\"?[31mred\""));
}

TEST_F(Elevation, GridsThatWouldBeReadAskewAreRefused) {
    EXPECT_THAT(refusal(file("swapped.asc",
                             "ncols 4\nnrows 5\ncellsize 1\n1 2 3 4 5\n6 7 8 9 10\n1 2 3 4 5\n6 7 8 9 10\n")),
                HasSubstr("there are 4 lines of 5 heights; swap the two"));
    EXPECT_THAT(refusal(file("oblong.asc", "ncols 4\nnrows 4\ndx 1\ndy 2\n" + sixteen)),
                HasSubstr("are no squares"));
    EXPECT_THAT(refusal(file("half.asc", "ncols 4\nnrows 4\ndx 1\n" + sixteen)),
                HasSubstr("cellsize, or dx and dy"));
    EXPECT_THAT(refusal(file("twice.asc", "ncols 4\nncols 5\nnrows 4\ncellsize 1\n" + sixteen)),
                HasSubstr("ncols twice"));
    EXPECT_THAT(refusal(file("utf16.asc", std::string("\xff\xfen\0c\0", 6))), HasSubstr("UTF-16"));
    EXPECT_THAT(refusal(file("mixed.asc", "ncols 4\nnrows 4\ncellsize 1\n1,5 2.5 3 4\n" + sixteen)),
                HasSubstr("row 1, column 2 is \"2.5\", but others have a decimal comma"));
}

TEST_F(Elevation, DecimalCommasAreReadAndSaid) {
    const ElevationModel model = surface::load_elevation(
        file("comma.asc", "ncols 4\nnrows 4\ncellsize 2,5\n1,25 2 3 4\n5 6 7 8\n9 10 11 12\n13 14 15 16\n"));
    EXPECT_EQ(model.counts[0], 1.25);
    EXPECT_EQ(model.metres_per_cell, 2.5);
    EXPECT_THAT(model.notes, testing::ElementsAre(HasSubstr("decimal comma")));
    const ElevationModel png_model = surface::load_elevation(
        png("c.png", 4, 4, 16, PNG_COLOR_TYPE_GRAY, {{"knurl:metres_per_count", "0,25"}}));
    EXPECT_EQ(png_model.metres_per_count, 0.25);
    for (const char* text : {"1,234", "about 3", "-1", "1.000,5"})
        EXPECT_THAT(refusal(png("c.png", 4, 4, 16, PNG_COLOR_TYPE_GRAY, {{"knurl:metres_per_cell", text}})),
                    HasSubstr(std::string("metres_per_cell is \"") + text + "\", not a number above 0"));
}

TEST_F(Elevation, AFineLocalGridIsNotInDegrees) {
    const std::string head = "ncols 4\nnrows 4\ncellsize 0.05\n";
    for (const char* corner : {"xllcorner 0\nyllcorner 0\n", "xllcenter 0\nyllcenter 0\n",
                               "xllcorner -0.1\nyllcorner -0.1\n", ""}) {
        const ElevationModel model = surface::load_elevation(file("local.asc", corner + head + sixteen));
        EXPECT_EQ(model.metres_per_cell, 0.05) << corner;
    }
    // Without such a statement, the steepness decides.
    const std::string flat = "1.01 1.02 1.03 1.02 1.01 1.0 1.01 1.02 1.03 1.02 1.01 1.0 1.01 1.02 1.03 1.02";
    EXPECT_EQ(surface::load_elevation(file("mm.asc", "xllcorner 12.5\nyllcorner 3\n" + head + flat))
                  .metres_per_cell,
              0.05);
    EXPECT_NEAR(*surface::load_elevation(file("deg.asc", "xllcorner 12.5\nyllcorner 3\n" + head + sixteen))
                     .metres_per_cell,
                0.05 * 111195, 20);
}

/// 8 x 8 smooth samples in the form of a P5 file; the first bytes are a blank and a '#'.
std::string samples() {
    std::string bytes;
    for (int i = 0; i < 64; ++i) {
        const int value = 0x2023 + 300 * (i % 8) + 7 * i;
        bytes += {static_cast<char>(value >> 8), static_cast<char>(value)};
    }
    return bytes;
}

TEST_F(Elevation, APgmMayHaveCommentsAndLineEndsOfAnyKind) {
    const std::string s = samples();
    for (const std::string& head : std::vector<std::string>{
             "P5\n8 8\n65535\n", "P5 8 8 65535 ", "P5\r\n8 8\r\n65535\r\n",
             "P5 # gimp\n# by us\n8# w\n 8 # h\n65535\n", "P5\n8 8\n65535\n# by a camera\n",
             "P5\n8 8\n65535 # c\n", "P5\n8 8\n65535# c\r\n", "P5\n8 8\n65535\n# a\n# b\r\n",
             "P5#\n8#\n8#\n20000\n"}) {
        for (const std::string& behind : std::vector<std::string>{"", "\n", "\r\n"}) {
            const ElevationModel model = surface::load_elevation(file("c.pgm", head + s + behind));
            for (int i = 0; i < 64; ++i)
                ASSERT_EQ(model.counts[static_cast<std::size_t>(i)], 0x2023 + 300 * (i % 8) + 7 * i)
                    << head << behind;
        }
    }
    const ElevationModel two =
        surface::load_elevation(file("two.pgm", "P5 8 8 65535\n" + s + "P5 8 8 65535\n" + s));
    EXPECT_EQ(two.counts[0], 0x2023);
    EXPECT_THAT(two.notes, testing::ElementsAre(HasSubstr("several pictures")));
}

TEST_F(Elevation, APgmThatIsNotWhatItsHeaderSaysIsRefused) {
    const std::string s = samples();
    EXPECT_THAT(refusal(file("more.pgm", "P5 8 8 65535\n" + s + "123")),
                HasSubstr("131 bytes follow this PGM's header, but its 64 samples of 16 bits take 128"));
    EXPECT_THAT(refusal(file("above.pgm", "P5 8 8 9000\n" + s)),
                HasSubstr("row 1, column 4 is 9148, above the largest"));
    std::string slope;  // 256 x 256
    for (int i = 0; i < 256 * 256; ++i) {
        const int value = 8192 + 20 * (i % 256) + 7 * (i / 256);
        slope += {static_cast<char>(value), static_cast<char>(value >> 8)};
    }
    EXPECT_THAT(refusal(file("little.pgm", "P5 256 256 65535\n" + slope)), HasSubstr("little-endian"));
    std::string swapped;  // too small for a test of noise
    for (int i = 0; i < 16; ++i) swapped += {static_cast<char>(10 * i), '\x01'};
    EXPECT_THAT(
        refusal(file("little_10.pgm", "P5 4 4 1023\n" + swapped)),
        HasSubstr("row 1, column 2 is 2561, above the largest value that the header states (1023); with the "
                  "bytes of each swapped none is"));
    EXPECT_THAT(refusal(file("plain.pgm", "P2 4 4 1000\n" + sixteen + "17\n")),
                HasSubstr("\"17\" follows the 16"));
    EXPECT_THAT(refusal(file("none.pgm", "P5 8 8 0\n" + s)), HasSubstr("largest value is 0: that is none"));
    EXPECT_THAT(refusal(file("above16.pgm", "P5 8 8 70000\n" + s)), HasSubstr("at most 65535"));
}

TEST_F(Elevation, TransparentPixelsHaveNoHeight) {
    transparent_ = 2 * 37 * 256 + 3 * 37;  // of the second pixel
    EXPECT_THAT(refusal(png("gap.png", 4, 4, 16)),
                HasSubstr("row 1, column 2 has no height (19055, transparent)"));
    transparent_ = 1;
    EXPECT_EQ(surface::load_elevation(png("whole.png", 4, 4, 16)).counts.size(), 16u);
}

TEST_F(Elevation, WhatIsNoModelAtAllIsRefused) {
    EXPECT_THAT(refusal(file("letter.txt", "Dear reader, this is no picture.")),
                HasSubstr("no elevation model"));
    EXPECT_THAT(refusal(file("photo.jpg", "\xff\xd8\xff\xe0 JFIF")), HasSubstr("no elevation model"));
    EXPECT_THAT(refusal(file("empty.png", "")), HasSubstr("empty"));
    EXPECT_THAT(refusal(folder_ / "absent.png"), HasSubstr("cannot be opened"));
    EXPECT_THAT(refusal(folder_), HasSubstr("is a folder"));
}

TEST(Relief, HeightsKeepTheHorizontalScaleTimesTheExaggeration) {
    ElevationModel model{.rows = 40, .columns = 40, .metres_per_count = 0.5, .metres_per_cell = 100};
    for (int i = 0; i < 1600; ++i)
        model.counts.push_back(100 + 10 * (i % 40));  // 10 counts = 5 m a cell: slope 1/20
    const auto relief = surface::make_relief(model, {.cell = 0.5e-3, .exaggeration = 2, .smoothing = 0});
    const surface::Terrain terrain(relief.grid);
    EXPECT_NEAR(terrain.jet(0, 0).fx, 2.0 / 20, 1e-12);
    EXPECT_NEAR(terrain.lowest() + terrain.highest(), 0, 1e-15);
    EXPECT_THAT(relief.statement, AllOf(HasSubstr("0.5 mm per cell of 100 m"), HasSubstr("1 : 200000")));
}

TEST(Relief, AModelWithoutScaleIsStretchedAndSaysSo) {
    ElevationModel model{.rows = 10, .columns = 10};
    for (int i = 0; i < 100; ++i) model.counts.push_back(i % 7);
    const auto relief = surface::make_relief(model, {.smoothing = 0, .default_range = 10e-3});
    const surface::Terrain terrain(relief.grid);
    EXPECT_NEAR(terrain.highest() - terrain.lowest(), 10e-3, 1e-12);
    EXPECT_THAT(relief.statement, HasSubstr("states no scale"));
}

TEST(Relief, FlatOrTowerHighModelsAreRefused) {
    ElevationModel flat{.rows = 4, .columns = 4, .counts = std::vector<double>(16, 5.0)};
    EXPECT_THROW(surface::make_relief(flat, {}), std::runtime_error);
    ElevationModel tower{.rows = 4,
                         .columns = 4,
                         .counts = std::vector<double>(16, 0.0),
                         .metres_per_count = 1,
                         .metres_per_cell = 1};
    tower.counts[5] = 1000;
    EXPECT_THROW(surface::make_relief(tower, {}), std::runtime_error);
}

}  // namespace

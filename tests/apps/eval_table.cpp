#include "eval_table.hpp"

#include <charconv>
#include <cstdio>
#include <sstream>

#include <gtest/gtest.h>

namespace knurl::test {

namespace {

std::string line(const char* format, double a, double b) {
    char text[128];
    std::snprintf(text, sizeof text, format, a, b);
    return text;
}

}  // namespace

Evaluated eval(const std::string& scene, const std::string& motion, const std::vector<std::string>& more) {
    const Folder folder;
    std::vector<std::string> words = {
        "eval",  "--scene",           folder.file("S.toml", scene), "--motion", folder.file("M.csv", motion),
        "--out", folder.path("F.csv")};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = knurl(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    Evaluated result{.rows = {}, .csv = text_of_file(folder.path("F.csv")), .remarks = outcome.err};

    std::istringstream lines(result.csv);
    std::string text;
    std::getline(lines, text);
    EXPECT_EQ(text, "t,x,y,z,fx,fy,fz,tx,ty,tz,px,py,pz");
    while (std::getline(lines, text)) {
        double values[13] = {};
        const char* at = text.data();
        const char* const end = at + text.size();
        for (double& value : values) {
            const auto parsed = std::from_chars(at, end, value);
            EXPECT_EQ(parsed.ec, std::errc()) << text;
            at = parsed.ptr + 1;
        }
        Row row;
        row.t = values[0];
        for (std::size_t i = 0; i < 3; ++i) {
            row.x[i] = values[1 + i];
            row.f[i] = values[4 + i];
            row.torque[i] = values[7 + i];
            row.p[i] = values[10 + i];
        }
        result.rows.push_back(row);
    }
    return result;
}

std::string rest_at(double z, double seconds) {
    return press(z, z, seconds);
}

std::string press(double z0, double z1, double seconds) {
    return "t,x,y,z\n" + line("%.17g,0,0,%.17g\n", 0, z0) + line("%.17g,0,0,%.17g\n", seconds, z1);
}

}  // namespace knurl::test

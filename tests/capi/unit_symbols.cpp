// What the libraries export, what the headers declare, and what the tests call are the same functions.

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

namespace capi_test {
namespace {

using Names = std::set<std::string>;

std::string output_of(const std::string& command) {
    std::string text;
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
    std::array<char, 4096> some;
    while (const std::size_t got = std::fread(some.data(), 1, some.size(), pipe))
        text.append(some.data(), got);
    if (::pclose(pipe) != 0) throw std::runtime_error(command + " failed");
    return text;
}

/// Every dynamic symbol that the library defines, but for the name of its version.
Names exported_by(const std::string& library) {
    std::istringstream lines(output_of(std::string(KNURL_NM) + " -D --defined-only " + library));
    Names names;
    for (std::string address, type, name; lines >> address >> type >> name;) {
        if (type == "A" && name == "KNURL_0") continue;
        EXPECT_EQ(name.substr(name.find('@')), "@@KNURL_0") << name << " has no version";
        EXPECT_EQ(type, "T") << name << " is no function";
        names.insert(name.substr(0, name.find('@')));
    }
    return names;
}

/// Without comments, in which a name is no call.
std::string text_of(const std::filesystem::path& file) {
    std::ifstream lines(file);
    std::string text;
    for (std::string line; std::getline(lines, line);) text += line.substr(0, line.find("//")) + "\n";
    return text;
}

bool of_a_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}
/// The names knurl_... that stand before a parenthesis; `after`: those alone that are the first after this word.
Names called_in(const std::string& text, const std::string& after = "") {
    Names names;
    std::size_t from = 0;
    for (;;) {
        if (!after.empty() && (from = text.find(after, from)) == std::string::npos) return names;
        const std::size_t parenthesis = text.find('(', from);
        if (parenthesis == std::string::npos) return names;
        std::size_t begin = parenthesis;
        while (begin > 0 && of_a_name(text[begin - 1])) --begin;
        const std::string name = text.substr(begin, parenthesis - begin);
        if (name.starts_with("knurl_")) names.insert(name);
        from = parenthesis + 1;
    }
}
Names declared_in(const std::string& header) {
    return called_in(text_of(std::filesystem::path(KNURL_HEADERS) / header), "\nKNURL_API");
}

std::string joined(const Names& names) {
    std::string text;
    for (const std::string& name : names) text += " " + name;
    return text;
}
Names without(const Names& all, const Names& others) {
    Names left;
    std::set_difference(all.begin(), all.end(), others.begin(), others.end(),
                        std::inserter(left, left.end()));
    return left;
}

TEST(CSymbols, exported_are_the_declared_functions_and_nothing_else) {
    EXPECT_EQ(exported_by(KNURL_SO), declared_in("knurl.h"));
    EXPECT_EQ(exported_by(KNURL_OFFLINE_SO), declared_in("knurl_offline.h"));
    EXPECT_GT(declared_in("knurl.h").size(), 50u);
    EXPECT_GT(declared_in("knurl_offline.h").size(), 12u);
}

TEST(CSymbols, each_function_is_called_by_a_test) {
    Names exported = exported_by(KNURL_SO);
    exported.merge(exported_by(KNURL_OFFLINE_SO));
    Names called;
    for (const auto& entry : std::filesystem::directory_iterator(KNURL_CAPI_TESTS)) {
        const std::string name = entry.path().filename();
        if (name.starts_with("unit_") || name.starts_with("e2e_"))
            called.merge(called_in(text_of(entry.path())));
    }
    EXPECT_EQ(joined(without(exported, called)), "") << "are called by no test";
    // The wrappers of the kinds are functions of the header; kinds_table.py sees to each.
    const Names wrappers = called_in(text_of(KNURL_KINDS_HEADER), "\nstatic inline");
    EXPECT_EQ(joined(without(without(called, exported), wrappers)), "")
        << "are called, and no library has them";
}

}  // namespace
}  // namespace capi_test

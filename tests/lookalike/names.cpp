// Every documented name is there, and no other; whatever is not available says so.

#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "dhd.h"
#include "drd.h"
#include "hd.h"

namespace {

using Names = std::set<std::string>;

bool in_a_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// The functions that one of the headers declares: names of theirs that stand before a parenthesis.
Names declared(const std::string& header) {
    std::ifstream file(std::string(KNURL_LOOKALIKE_SOURCES) + "/" + header);
    EXPECT_TRUE(file) << header;
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    Names names;
    for (std::size_t end = text.find('('); end != std::string::npos; end = text.find('(', end + 1)) {
        std::size_t begin = end;
        while (begin > 0 && in_a_name(text[begin - 1])) --begin;
        const std::string name = text.substr(begin, end - begin);
        if (name.starts_with("dhd") || name.starts_with("drd") || name.starts_with("hd")) names.insert(name);
    }
    return names;
}

Names exported(const std::string& library) {
    const std::string command = std::string(KNURL_NM) + " -D --defined-only " + library;
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error(command);
    std::string text;
    std::array<char, 4096> some;
    while (const std::size_t got = std::fread(some.data(), 1, some.size(), pipe))
        text.append(some.data(), got);
    ::pclose(pipe);
    std::istringstream lines(text);
    Names names;
    for (std::string address, type, name; lines >> address >> type >> name;) names.insert(name);
    return names;
}

Names operator+(Names a, const Names& b) {
    a.insert(b.begin(), b.end());
    return a;
}

TEST(LookalikeNames, the_headers_have_as_many_functions_as_the_bindings_bind) {
    // forcedimension_core binds 159 dhd and 65 drd functions when it is imported; 19 more are of other versions.
    EXPECT_EQ(declared("dhd.h").size(), 159u + 19u);
    EXPECT_EQ(declared("drd.h").size(), 65u);
    EXPECT_EQ(declared("hd.h").size(), 36u);
}

TEST(LookalikeNames, a_library_exports_the_vendors_names_and_nothing_else) {
    EXPECT_EQ(exported(KNURL_AS_DHD "/libdhd.so.3"), declared("dhd.h") + declared("drd.h"));
    EXPECT_EQ(exported(KNURL_AS_HD "/libHD.so"), declared("hd.h"));
}

TEST(LookalikeNames, programs_find_the_names_under_each_file_name) {
    for (const char* file : {"libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so"}) {
        void* const library = ::dlopen((std::string(KNURL_AS_DHD "/") + file).c_str(), RTLD_NOW | RTLD_LOCAL);
        ASSERT_NE(library, nullptr) << ::dlerror();
        for (const std::string& name : declared("dhd.h") + declared("drd.h"))
            EXPECT_NE(::dlsym(library, name.c_str()), nullptr) << file << " has no " << name;
        // One library under several names: what libdhd opened, libdrd knows.
        EXPECT_EQ(::dlsym(library, "dhdOpen"), reinterpret_cast<void*>(&dhdOpen)) << file;
        ::dlclose(library);
    }
    for (const char* file : {"libHD.so", "libHD.so.3.4"}) {
        void* const library = ::dlopen((std::string(KNURL_AS_HD "/") + file).c_str(), RTLD_NOW | RTLD_LOCAL);
        ASSERT_NE(library, nullptr) << ::dlerror();
        for (const std::string& name : declared("hd.h"))
            EXPECT_NE(::dlsym(library, name.c_str()), nullptr) << file << " has no " << name;
        ::dlclose(library);
    }
}

TEST(LookalikeNames, where_fdsdk_leads_is_the_same_library) {
    namespace fs = std::filesystem;
    int found = 0;
    for (const auto& platform : fs::directory_iterator(KNURL_AS_DHD "/lib/release")) {
        for (const char* file : {"libdrd.so.3", "libdhd.so.3"}) {
            EXPECT_TRUE(fs::equivalent(platform.path() / file, KNURL_AS_DHD "/libdhd.so.3")) << platform;
            ++found;
        }
    }
    EXPECT_EQ(found, 2);
}

TEST(LookalikeNames, the_version_is_that_which_the_bindings_ask_for) {
    int version[4] = {};
    dhdGetSDKVersion(&version[0], &version[1], &version[2], &version[3]);
    EXPECT_EQ(version[0], 3);
    EXPECT_EQ(version[1], 16);
    dhdGetSDKVersion(nullptr, nullptr, nullptr, nullptr);
    EXPECT_EQ(std::string(dhdGetSDKVersionStr()).substr(0, 6), "3.16.0");
}

}  // namespace

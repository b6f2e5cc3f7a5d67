// The keys file, and the one line for each mistake in it.

#include <fstream>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <knurl/bridge/keys.hpp>

#include "../temp_folder.hpp"
#include "net_pair.hpp"

namespace knurl::bridge::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Keys : public testing::Test {
  protected:
    void write(const std::string& text, mode_t mode = 0600) {
        std::ofstream(file_) << text;
        ::chmod(file_.c_str(), mode);
    }
    std::string mistake() {
        try {
            read_keys(file_);
        } catch (const std::runtime_error& error) {
            EXPECT_THAT(error.what(), testing::StartsWith(file_.string() + ": "));
            EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
            return error.what();
        }
        return "no error";
    }

    knurl::test::TempFolder folder_;
    fs::path file_ = folder_ / "keys";
    const std::string hex_ = std::string(62, '0') + "fA";
};

TEST_F(Keys, OfEveryRoleWithCommentsAndBlankLines) {
    write("# the lab\n\nviewer observe " + hex_ + "\n  pc-2.lab   render\t" + hex_ +
          "   # Anna's\nme control " + hex_);
    const std::vector<Key> keys = read_keys(file_);
    ASSERT_EQ(keys.size(), 3u);
    EXPECT_EQ(keys[0].role, Role::observe);
    EXPECT_EQ(keys[1].name, "pc-2.lab");
    EXPECT_EQ(keys[1].role, Role::render);
    EXPECT_EQ(keys[2].role, Role::control);
    EXPECT_EQ(keys[2].secret[31], std::byte{0xfa});
    EXPECT_EQ(find_key(keys, "me"), &keys[2]);
    EXPECT_EQ(find_key(keys, "m"), nullptr);
}

TEST_F(Keys, ThatAreMadeAreReadBack) {
    const Key first = make_key("a", Role::observe), second = make_key("b", Role::control);
    EXPECT_NE(first.secret, second.secret);
    add_key(file_, first);
    add_key(file_, second);
    struct stat status {};
    ASSERT_EQ(::stat(file_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u);
    const std::vector<Key> keys = read_keys(file_);
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].secret, first.secret);
    EXPECT_EQ(keys[1].secret, second.secret);
    EXPECT_EQ(keys[1].role, Role::control);
}

TEST_F(Keys, BehindALastLineWithoutItsEndBeginANewLine) {
    write("a observe " + hex_);
    add_key(file_, make_key("b", Role::control));
    EXPECT_EQ(read_keys(file_).size(), 2u);
}

TEST_F(Keys, ANameTwiceIsRefused) {
    add_key(file_, make_key("a", Role::observe));
    EXPECT_THROW(add_key(file_, make_key("a", Role::control)), std::runtime_error);
    write("a observe " + hex_ + "\na control " + hex_ + "\n");
    EXPECT_THAT(mistake(), HasSubstr("line 2: a second key named 'a'"));
}

TEST_F(Keys, AFileThatOthersMayReadIsRefused) {
    for (const mode_t mode : {0640u, 0604u, 0620u, 0602u, 0610u}) {
        write("a observe " + hex_, mode);
        EXPECT_THAT(mistake(), HasSubstr("chmod 600")) << std::oct << mode;
        EXPECT_THROW(add_key(file_, make_key("b", Role::control)), std::runtime_error);
    }
}

TEST_F(Keys, MistakesNameTheLine) {
    write("# one\na watch " + hex_);
    EXPECT_THAT(mistake(), HasSubstr("line 2: unknown role 'watch'; observe, render or control"));
    write("a control 123");
    EXPECT_THAT(mistake(), HasSubstr("line 1: the key has 3 characters; 64 hexadecimal digits"));
    write("a control " + std::string(64, 'g'));
    EXPECT_THAT(mistake(), HasSubstr("64 hexadecimal digits"));
    write("a control " + hex_ + " b");
    EXPECT_THAT(mistake(), HasSubstr("line 1: unexpected 'b' after the key"));
    write("a/b control " + hex_);
    EXPECT_THAT(mistake(), HasSubstr("bad name 'a/b'"));
    write("a");
    EXPECT_THAT(mistake(), HasSubstr("unknown role ''"));
}

TEST_F(Keys, NoFileAndNoKeySayHowToMakeOne) {
    EXPECT_THAT(mistake(), HasSubstr("knurl-bridge keygen"));
    write("# nothing yet\n");
    EXPECT_THAT(mistake(), HasSubstr("knurl-bridge keygen"));
    file_ = folder_.path();
    EXPECT_THAT(mistake(), HasSubstr("not a regular file"));
    EXPECT_THROW(make_key("", Role::observe), std::runtime_error);
    EXPECT_THROW(make_key(std::string(64, 'a'), Role::observe), std::runtime_error);
}

TEST_F(Keys, AFileOfRubbishIsRefusedWithOneLine) {
    write(std::string(2'000'000, 'x'));
    EXPECT_THAT(mistake(), HasSubstr("too long"));
    write(std::string("a\0b control ", 12) + hex_);
    EXPECT_THAT(mistake(), HasSubstr("bad name"));
}

}  // namespace
}  // namespace knurl::bridge::test

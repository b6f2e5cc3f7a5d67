// runtime/measure/output_file: a file is complete, or stays as it was and a line gives the reason.

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/measure/output_file.hpp>

#include "../refusal.hpp"
#include "../temp_folder.hpp"

namespace knurl::measure {
namespace {

namespace fs = std::filesystem;

class OutputFile : public testing::Test {
  protected:
    std::string path() const { return folder_ / "run.json"; }
    std::string text() const {
        std::ifstream file(path(), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    auto files() const { return std::distance(fs::directory_iterator(folder_.path()), {}); }

  private:
    knurl::test::TempFolder folder_;
};

TEST_F(OutputFile, HoldsTheNewTextAndNothingOfTheOld) {
    write_file(path(), std::string(100'000, 'x'));
    write_file(path(), "new\n");
    EXPECT_EQ(text(), "new\n");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFile, IsAsItWasIfTheNewTextDoesNotFit) {
    write_file(path(), "old\n");
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{.rlim_cur = 4096, .rlim_max = before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);  // the call fails instead
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string said = knurl::test::refusal_of([&] { write_file(path(), std::string(100'000, 'x')); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(said, path() + ": cannot be written: File too large");
    EXPECT_EQ(text(), "old\n");
    EXPECT_EQ(files(), 1) << "nothing half written lies beside it";
}

TEST_F(OutputFile, ThatCannotBeWrittenIsKnownBeforeTheWork) {
    const std::string nowhere = path() + "/run.json";
    const std::string said = knurl::test::refusal_of([&] { require_writable(nowhere); });
    EXPECT_EQ(said, nowhere + ": cannot be written: No such file or directory");
    EXPECT_EQ(knurl::test::refusal_of([&] { write_file(nowhere, "new\n"); }), said);
    require_writable("-");
    require_writable(path());
    EXPECT_EQ(files(), 0) << "who only asks leaves nothing";
    write_file(path(), "old\n");
    require_writable(path());
    EXPECT_EQ(text(), "old\n");
    EXPECT_EQ(files(), 1);
}

TEST_F(OutputFile, OfAPipeIsThePipe) {
    ASSERT_EQ(::mkfifo(path().c_str(), 0600), 0);
    const int pipe = ::open(path().c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    write_file(path(), "new\n");
    std::array<char, 16> read{};
    EXPECT_EQ(::read(pipe, read.data(), read.size()), 4);
    EXPECT_STREQ(read.data(), "new\n");
    ::close(pipe);
    EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace knurl::measure

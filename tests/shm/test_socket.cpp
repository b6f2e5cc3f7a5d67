#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "../lingering.hpp"
#include "../refusal.hpp"
#include "../rights.hpp"
#include "../temp_folder.hpp"

namespace knurl::shm::socket_tests {
namespace {

namespace fs = std::filesystem;

std::size_t open_descriptors() {
    std::size_t n = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/self/fd")) ++n;
    return n;
}

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text));
}

class Socket : public testing::Test {
  protected:
    UniqueFd accepted() {
        pollfd event{.fd = listener_.get(), .events = POLLIN, .revents = 0};
        ::poll(&event, 1, 10000);
        return accept_from(listener_);
    }
    void connect() {
        listener_ = listen_at(path_, 0660, 8);
        client_ = connect_to(path_);
        servo_ = accepted();
        ASSERT_TRUE(servo_);
    }

    test::TempFolder folder_;
    fs::path path_ = folder_ / "default.sock";
    UniqueFd listener_, client_, servo_;
    std::array<std::byte, 64> buffer_{};
};

TEST_F(Socket, CarriesWholeMessagesBothWays) {
    connect();
    ASSERT_TRUE(send_message(client_, bytes_of("first")));
    ASSERT_TRUE(send_message(client_, bytes_of("second one")));
    EXPECT_EQ(receive_message(servo_, buffer_).bytes, 5u);
    EXPECT_EQ(receive_message(servo_, buffer_).bytes, 10u);
    EXPECT_EQ(std::memcmp(buffer_.data(), "second one", 10), 0);
    ASSERT_TRUE(send_message(servo_, bytes_of("answer")));
    EXPECT_EQ(receive_message(client_, buffer_).bytes, 6u);
}

TEST_F(Socket, HasTheModeThatWasAskedFor) {
    listener_ = listen_at(path_, 0660, 8);
    struct stat status {};
    ASSERT_EQ(::stat(path_.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0660u);
}

TEST_F(Socket, HandsOverDescriptorsThatDoNotSurviveExec) {
    connect();
    Segment segment = Segment::create("knurl-test", 4096);
    segment.data()[9] = std::byte{7};
    const int fds[] = {segment.fd(), servo_.get()};
    ASSERT_TRUE(send_message(servo_, bytes_of("take"), fds));
    const Received received = receive_message(client_, buffer_);
    ASSERT_EQ(received.fds.size(), 2u);
    EXPECT_FALSE(received.truncated);
    EXPECT_TRUE(::fcntl(received.fds[0].get(), F_GETFD) & FD_CLOEXEC);
    EXPECT_EQ(Segment::open(received.fds[0].get(), 4096, Segment::Access::read_only).data()[9], std::byte{7});
}

TEST_F(Socket, TellsThatThePeerIsGone) {
    connect();
    ASSERT_TRUE(send_message(client_, bytes_of("last words")));
    client_.reset();
    EXPECT_EQ(receive_message(servo_, buffer_).bytes, 10u);
    EXPECT_TRUE(receive_message(servo_, buffer_).closed);
    EXPECT_FALSE(send_message(servo_, bytes_of("anyone?")));  // and no SIGPIPE
}

TEST_F(Socket, NeedNotBlock) {
    connect();
    const Received received = receive_message(servo_, buffer_, Block::no);
    EXPECT_TRUE(received.nothing);
    EXPECT_FALSE(received.closed);
    EXPECT_FALSE(accept_from(listener_));
}

TEST_F(Socket, APeerThatDoesNotReadCannotBlockTheSender) {
    connect();
    int sent = 0;
    while (sent < 100000 && send_message(servo_, bytes_of("report"))) ++sent;
    EXPECT_GT(sent, 0);
    EXPECT_LT(sent, 100000);
}

TEST_F(Socket, SaysThatAMessageWasTooLongAndKeepsNoneOfItsDescriptors) {
    connect();
    const std::string text(200, 'x');
    const int fds[] = {client_.get(), client_.get()};
    ASSERT_TRUE(send_message(client_, bytes_of(text), fds));
    const std::size_t before = open_descriptors();
    const Received received = receive_message(servo_, buffer_);
    EXPECT_TRUE(received.truncated);
    EXPECT_TRUE(received.fds.empty());
    EXPECT_EQ(open_descriptors(), before);
}

TEST_F(Socket, APlainMessageIsTaken) {
    connect();
    EXPECT_TRUE(receive_plain_message(servo_, buffer_).nothing);
    ASSERT_TRUE(send_message(client_, bytes_of("one")));
    ASSERT_TRUE(send_message(client_, bytes_of("three")));
    const Received first = receive_plain_message(servo_, buffer_);
    EXPECT_EQ(first.bytes, 3u);
    EXPECT_FALSE(first.carries_descriptors || first.truncated || first.closed || first.nothing);
    EXPECT_EQ(receive_plain_message(servo_, buffer_).bytes, 5u);
    ASSERT_TRUE(send_message(client_, bytes_of(std::string(200, 'x'))));
    EXPECT_TRUE(receive_plain_message(servo_, buffer_).truncated);
    EXPECT_TRUE(receive_plain_message(servo_, buffer_).nothing) << "it is taken all the same";
    client_.reset();
    EXPECT_TRUE(receive_plain_message(servo_, buffer_).closed);
}

// The descriptor would keep whoever receives it, or throws it away, for an hour.
TEST_F(Socket, AMessageWithADescriptorIsLeftWhereItIs) {
    connect();
    test::Lingering lingering;
    const int fds[] = {lingering.fd()};
    ASSERT_TRUE(send_message(client_, bytes_of("take"), fds));
    lingering.let_go();
    const std::size_t before = open_descriptors();
    for (int i = 0; i < 2; ++i) {
        const Received received = receive_plain_message(servo_, buffer_);
        EXPECT_TRUE(received.carries_descriptors);
        EXPECT_EQ(received.bytes, 4u);
        EXPECT_EQ(std::memcmp(buffer_.data(), "take", 4), 0);
        EXPECT_TRUE(received.fds.empty());
    }
    EXPECT_EQ(open_descriptors(), before);
}

// For a test: descriptors without send_message's bound.
void send_many(int to, std::size_t many, int fd) {
    std::vector<int> fds(many, fd);
    std::vector<std::byte> control(CMSG_SPACE(many * sizeof(int)));
    char letter = 'x';
    iovec data{.iov_base = &letter, .iov_len = 1};
    msghdr message{};
    message.msg_iov = &data;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(many * sizeof(int));
    std::memcpy(CMSG_DATA(header), fds.data(), many * sizeof(int));
    ASSERT_EQ(::sendmsg(to, &message, 0), 1);
}

TEST_F(Socket, WhoMayBeHeldUpReceivesEveryDescriptorThatCanBeSent) {
    connect();
    constexpr std::size_t most = 253;
    send_many(client_.get(), most, client_.get());
    const std::size_t before = open_descriptors();
    {
        const Received received = receive_every_descriptor(servo_.get(), buffer_);
        EXPECT_EQ(received.fds.size(), most);
        EXPECT_FALSE(received.descriptors_lost);
        EXPECT_EQ(open_descriptors(), before + most);
    }
    EXPECT_EQ(open_descriptors(), before);
    EXPECT_TRUE(receive_every_descriptor(servo_.get(), buffer_).nothing);
}

TEST_F(Socket, AHostileSenderCannotFillOurDescriptorTable) {
    connect();
    // What send_message refuses, a hostile client does by itself: 200 descriptors at once.
    constexpr std::size_t many = 200;
    std::array<int, many> fds;
    fds.fill(client_.get());
    EXPECT_NE(test::refusal_of([&] { send_message(client_, bytes_of("x"), fds); }), "accepted");
    send_many(client_.get(), many, client_.get());

    const std::size_t before = open_descriptors();
    const Received received = receive_message(servo_, buffer_);
    EXPECT_TRUE(received.truncated);
    EXPECT_TRUE(received.fds.empty());
    EXPECT_EQ(open_descriptors(), before);
}

TEST_F(Socket, KnowsWhoIsAtTheOtherEnd) {
    connect();
    const PeerCredentials peer = credentials_of(servo_);
    EXPECT_EQ(peer.pid, ::getpid());
    EXPECT_EQ(peer.uid, ::geteuid());
    EXPECT_EQ(peer.gid, ::getegid());
}

TEST_F(Socket, ReplacesTheSocketThatADeadServoLeftBehind) {
    listener_ = listen_at(path_, 0660, 8);
    listener_.reset();
    ASSERT_TRUE(fs::exists(path_));
    connect();
    EXPECT_TRUE(send_message(client_, bytes_of("alive")));
}

TEST_F(Socket, DoesNotTouchALiveServo) {
    connect();
    const std::string error = test::refusal_of([&] { listen_at(path_, 0660, 8); });
    EXPECT_NE(error.find("another servo named default is running"), std::string::npos) << error;
    client_ = connect_to(path_);  // the first one still answers
    EXPECT_TRUE(accepted());
}

TEST_F(Socket, DoesNotTouchALiveServoWithAFullBacklog) {
    listener_ = listen_at(path_, 0660, 0);
    client_ = connect_to(path_);  // never accepted: the next one would have to wait
    EXPECT_NE(test::refusal_of([&] { listen_at(path_, 0660, 0); }), "accepted");
    EXPECT_TRUE(fs::exists(path_));
}

TEST_F(Socket, DoesNotWaitForeverForAPlaceInAFullBacklog) {
    listener_ = listen_at(path_, 0660, 0);
    client_ = connect_to(path_);
    EXPECT_NE(test::refusal_of([&] { connect_to(path_, std::chrono::milliseconds(1)); }).find("stopped?"),
              std::string::npos);
}

TEST_F(Socket, NeverRemovesAFileThatIsNotASocket) {
    std::ofstream(path_) << "precious";
    EXPECT_NE(test::refusal_of([&] { listen_at(path_, 0660, 8); }), "accepted");
    EXPECT_EQ(fs::file_size(path_), 8u);
}

TEST_F(Socket, NobodyElsesLockOnTheFolderKeepsItFromStarting) {
    const fs::path folder = path_.parent_path();
    const UniqueFd held(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    ASSERT_EQ(::flock(held.get(), LOCK_EX), 0);
    connect();
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "the socket";
}

TEST_F(Socket, InAFolderInWhichOthersMayReplaceItItIsRefused) {
    const fs::path folder = path_.parent_path();
    ASSERT_EQ(::chmod(folder.c_str(), 0777), 0);
    const std::string writable = test::refusal_of([&] { listen_at(path_, 0660, 8); });
    EXPECT_NE(writable.find("others may write there"), std::string::npos) << writable;
    ASSERT_EQ(::chmod(folder.c_str(), 01777), 0);
    listener_ = listen_at(path_, 0660, 8);  // sticky, like /tmp: only its owner may remove a socket
    listener_.reset();
    ASSERT_EQ(::chmod(folder.c_str(), 0755), 0);
    KNURL_NEEDS(knurl::test::missing_other_user());
    ASSERT_EQ(::chown(folder.c_str(), 12345, static_cast<gid_t>(-1)), 0);
    const std::string foreign = test::refusal_of([&] { listen_at(path_, 0660, 8); });
    EXPECT_NE(foreign.find("belongs to user 12345"), std::string::npos) << foreign;
    ASSERT_EQ(::chown(folder.c_str(), ::geteuid(), static_cast<gid_t>(-1)), 0);
}

TEST_F(Socket, SaysWhatToDoAboutAPathThatCannotBe) {
    EXPECT_NE(test::refusal_of([&] { listen_at(folder_ / "none" / "x.sock", 0660, 8); }).find("create it"),
              std::string::npos);
    EXPECT_NE(test::refusal_of([&] { listen_at(folder_ / std::string(200, 'x'), 0660, 8); }).find("107"),
              std::string::npos);
    EXPECT_NE(test::refusal_of([&] { connect_to(path_); }).find("running?"), std::string::npos);
}

}  // namespace
}  // namespace knurl::shm::socket_tests

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <knurl/shm/segment.hpp>

#include "../huge_view.hpp"
#include "../refusal.hpp"

namespace knurl::shm {
namespace {

TEST(Segment, IsZeroAndSharedByWhoeverOpensItsDescriptor) {
    Segment ours = Segment::create("knurl-test", 10000);
    ASSERT_EQ(ours.size(), 10000u);
    for (std::size_t i = 0; i < ours.size(); ++i) ASSERT_EQ(ours.data()[i], std::byte{0});
    const Segment theirs = Segment::open(ours.fd(), 10000, Segment::Access::read_only);
    std::memcpy(ours.data() + 4096, "touch", 5);
    EXPECT_EQ(std::memcmp(theirs.data() + 4096, "touch", 5), 0);
    EXPECT_NE(theirs.fd(), ours.fd());
}

TEST(Segment, IsWhollyPresentFromTheStart) {
    const std::size_t bytes = 64 * 4096;
    Segment segment = Segment::create("knurl-test", bytes);
    std::vector<unsigned char> present(64);
    ASSERT_EQ(::mincore(segment.data(), bytes, present.data()), 0);
    for (const unsigned char page : present) EXPECT_TRUE(page & 1);
}

TEST(Segment, CannotBeShrunkOrGrown) {
    const Segment segment = Segment::create("knurl-test", 8192);
    EXPECT_NE(::ftruncate(segment.fd(), 4096), 0);
    EXPECT_NE(::ftruncate(segment.fd(), 16384), 0);
}

TEST(Segment, MovesWithItsMapping) {
    Segment first = Segment::create("knurl-test", 4096);
    std::byte* const data = first.data();
    Segment second = std::move(first);
    EXPECT_EQ(second.data(), data);
    EXPECT_EQ(first.size(), 0u);
    EXPECT_EQ(first.data(), nullptr);
    first = std::move(second);
    EXPECT_EQ(first.data(), data);
    first.data()[4095] = std::byte{1};
}

TEST(SealedSegment, ClientsCanMapItReadOnlyAndInNoOtherWay) {
    Segment servo = Segment::create("knurl-test", 4096);
    servo.seal_against_new_writers();
    EXPECT_NE(test::refusal_of([&] { Segment::open(servo.fd(), 4096, Segment::Access::read_write); }),
              "accepted");
    Segment client = Segment::open(servo.fd(), 4096, Segment::Access::read_only);
    EXPECT_NE(::mprotect(client.data(), 4096, PROT_READ | PROT_WRITE), 0);
    EXPECT_EQ(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, client.fd(), 0), MAP_FAILED);
    EXPECT_NE(::pwrite(client.fd(), "x", 1, 0), 1);
    // Nor through a descriptor opened anew.
    const UniqueFd again(
        ::open(("/proc/self/fd/" + std::to_string(client.fd())).c_str(), O_RDWR | O_CLOEXEC));
    if (again) {
        EXPECT_EQ(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, again.get(), 0), MAP_FAILED);
        EXPECT_NE(::pwrite(again.get(), "x", 1, 0), 1);
    }
    // The servo's own mapping, made before, still writes.
    servo.data()[7] = std::byte{42};
    EXPECT_EQ(client.data()[7], std::byte{42});
}

/// Takes pages of a file away, by each way that there is. Each gives 0 or its errno.
int punched(int fd, std::size_t bytes) {
    const int how = FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE;
    return ::fallocate(fd, how, 0, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
}
int removed(Segment& mapped) {
    return ::madvise(mapped.data(), mapped.size(), MADV_REMOVE) == 0 ? 0 : errno;
}

TEST(SegmentOfAWriter, NobodyTakesAPageAwayOnceItIsSealed) {
    Segment servo = Segment::create("knurl-test", 40 * 4096);
    Segment client = Segment::open(servo.fd(), servo.size(), Segment::Access::read_write);
    EXPECT_FALSE(servo.sealed_against_new_writers());
    client.seal_against_new_writers();
    EXPECT_TRUE(servo.sealed_against_new_writers()) << "the seal is the file's, whoever set it";
    const UniqueFd again(
        ::open(("/proc/self/fd/" + std::to_string(client.fd())).c_str(), O_RDWR | O_CLOEXEC));
    for (const int fd : {client.fd(), servo.fd(), again ? again.get() : client.fd()})
        EXPECT_EQ(punched(fd, servo.size()), EPERM);
    EXPECT_EQ(removed(client), EPERM);
    EXPECT_TRUE(servo.has_every_page());
    client.data()[4096] = std::byte{42};
    EXPECT_EQ(servo.data()[4096], std::byte{42}) << "the client still writes";
}

TEST(SegmentOfAReader, NobodyTakesAPageAway) {
    Segment servo = Segment::create("knurl-test", 40 * 4096);
    servo.seal_against_new_writers();
    Segment client = Segment::open(servo.fd(), servo.size(), Segment::Access::read_only);
    EXPECT_EQ(punched(client.fd(), client.size()), EPERM);
    EXPECT_NE(removed(client), 0);
    EXPECT_TRUE(servo.has_every_page());
}

TEST(Segment, IsNotSealedByOtherSeals) {
    Segment segment = Segment::create("knurl-test", 4096);
    ASSERT_EQ(::fcntl(segment.fd(), F_ADD_SEALS, F_SEAL_SEAL), 0);
    EXPECT_FALSE(segment.sealed_against_new_writers());
    EXPECT_NE(test::refusal_of([&] { segment.seal_against_new_writers(); }), "accepted");
}

TEST(Segment, KnowsThatAPageWasTakenAwayThoughItIsBack) {
    Segment servo = Segment::create("knurl-test", 40 * 4096);
    Segment client = Segment::open(servo.fd(), servo.size(), Segment::Access::read_write);
    EXPECT_TRUE(servo.has_every_page());
    ASSERT_EQ(::fallocate(client.fd(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 7 * 4096, 4096), 0);
    EXPECT_FALSE(servo.has_every_page());
    EXPECT_TRUE(servo.has_every_page()) << "to look brings it back";
    ASSERT_EQ(removed(client), 0);
    for (std::size_t at = 0; at < client.size(); at += 4096) client.data()[at] = std::byte{1};
    EXPECT_FALSE(servo.has_every_page());
}

TEST(Segment, WhoseReaderGathersItIntoHugePagesKeepsItsPages) {
    for (const std::size_t pages : {30u, 512u, 1300u}) {
        SCOPED_TRACE(pages);
        Segment loose = Segment::create("knurl-test", pages * 4096),
                held = Segment::create("knurl-test", pages * 4096);
        loose.seal_against_new_writers();
        held.seal_against_new_writers();
        held.hold_pages();
        test::HugeView of_loose(loose.fd(), loose.size()), of_held(held.fd(), held.size());
        ASSERT_TRUE(of_loose.valid() && of_held.valid());
        if (const int error = of_loose.gather(); error != 0)
            GTEST_SKIP() << "this kernel does not gather pages on request: " << std::strerror(error);
        EXPECT_FALSE(loose.has_every_page()) << "else this test proves nothing";
        EXPECT_NE(of_held.gather(), 0);
        EXPECT_TRUE(held.has_every_page());
    }
}

TEST(Segment, HoldsItsPagesNoLongerThanItLives) {
    Segment held = Segment::create("knurl-test", 30 * 4096);
    held.hold_pages();
    Segment moved = std::move(held);
    const UniqueFd file(::dup(moved.fd()));
    test::HugeView view(file.get(), moved.size());
    const int while_it_lives = view.gather();
    EXPECT_NE(while_it_lives, 0) << "a move lets go of nothing";
    moved = Segment();
    if (const int error = view.gather(); error == EINVAL)
        GTEST_SKIP() << "this kernel does not gather pages on request";
    else
        EXPECT_EQ(error, 0);
}

TEST(SegmentOpen, RefusesAnotherSizeAndSaysBoth) {
    const Segment segment = Segment::create("knurl-test", 4096);
    const std::string error =
        test::refusal_of([&] { Segment::open(segment.fd(), 8192, Segment::Access::read_only); });
    EXPECT_NE(error.find("4096"), std::string::npos) << error;
    EXPECT_NE(error.find("8192"), std::string::npos) << error;
}

TEST(SegmentOpen, RefusesWhatIsNotSealedOrNotAMemfd) {
    const UniqueFd unsealed(::memfd_create("unsealed", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    ASSERT_EQ(::ftruncate(unsealed.get(), 4096), 0);
    EXPECT_NE(test::refusal_of([&] { Segment::open(unsealed.get(), 4096, Segment::Access::read_only); }),
              "accepted");
    ASSERT_EQ(::fcntl(unsealed.get(), F_ADD_SEALS, F_SEAL_SHRINK), 0);
    EXPECT_NE(test::refusal_of([&] { Segment::open(unsealed.get(), 4096, Segment::Access::read_only); }),
              "accepted");

    const UniqueFd device(::open("/dev/zero", O_RDWR | O_CLOEXEC));
    EXPECT_NE(test::refusal_of([&] { Segment::open(device.get(), 4096, Segment::Access::read_only); }),
              "accepted");
    EXPECT_NE(test::refusal_of([&] { Segment::open(device.get(), 0, Segment::Access::read_only); }),
              "accepted");
    EXPECT_NE(test::refusal_of([&] { Segment::open(-1, 4096, Segment::Access::read_only); }), "accepted");
}

TEST(SealedSegment, IsReadByOthersAndWrittenByNobody) {
    Segment written = Segment::create("knurl-test", 8192);
    std::memcpy(written.data() + 5000, "for good", 8);
    const UniqueFd fd = Segment::seal(std::move(written));
    EXPECT_EQ(::mmap(nullptr, 8192, PROT_READ | PROT_WRITE, MAP_SHARED, fd.get(), 0), MAP_FAILED);
    EXPECT_EQ(::pwrite(fd.get(), "x", 1, 0), -1);
    EXPECT_NE(::ftruncate(fd.get(), 4096), 0);
    Segment theirs = Segment::open_sealed(fd.get(), 8192);
    EXPECT_EQ(std::memcmp(theirs.data() + 5000, "for good", 8), 0);
    // What one of them writes into its own pages is its own.
    theirs.data()[5000] = std::byte{'F'};
    EXPECT_EQ(std::memcmp(Segment::open_sealed(fd.get(), 8192).data() + 5000, "for good", 8), 0);
}

TEST(SealedSegment, RefusesWhatCanStillBeWritten) {
    const Segment open = Segment::create("knurl-test", 4096);
    const std::string error = test::refusal_of([&] { Segment::open_sealed(open.fd(), 4096); });
    EXPECT_NE(error.find("F_SEAL_WRITE"), std::string::npos) << error;
    Segment written = Segment::create("knurl-test", 4096);
    const UniqueFd fd = Segment::seal(std::move(written));
    EXPECT_NE(test::refusal_of([&] { Segment::open_sealed(fd.get(), 8192); }), "accepted");
}

TEST(SegmentOpen, LeavesTheCallersDescriptorAlone) {
    Segment segment = Segment::create("knurl-test", 4096);
    const int fd = ::dup(segment.fd());
    { const Segment opened = Segment::open(fd, 4096, Segment::Access::read_write); }
    test::refusal_of([&] { Segment::open(fd, 8192, Segment::Access::read_write); });
    EXPECT_EQ(::close(fd), 0);
}

TEST(SegmentColour, SpreadsWhatIsLookedAtOverThePage) {
    for (std::size_t n = 0; n < 128; ++n) {
        EXPECT_EQ(segment_colour(n) % 128, 0u);
        EXPECT_LT(segment_colour(n), segment_colour_bytes);
        EXPECT_NE(segment_colour(n), segment_colour(n + 1));
    }
}

TEST(Segment, RefusesToBeEmpty) {
    EXPECT_NE(test::refusal_of([] { Segment::create("knurl-test", 0); }), "accepted");
}

}  // namespace
}  // namespace knurl::shm

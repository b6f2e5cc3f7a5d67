// The handshake over the servo's socket: who is admitted, who gets a device, and the answers.

#include <filesystem>
#include <limits>
#include <utility>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "../rights.hpp"
#include "process_knurld.hpp"

namespace knurl::test {
namespace {

bool contains(const std::string& whole, const std::string& part) {
    return whole.find(part) != std::string::npos;
}

TEST(Attach, WelcomeNamesTheDevicesAndHandsOverTheirReports) {
    const Home home;
    const Knurld knurld(home, {"--device", "left=sim:premium15", "--device", "sim:cartesian3"});
    RawClient client(home);
    const Answer answer = client.greet();
    ASSERT_TRUE(answer.welcome);
    ASSERT_EQ(answer.welcome->devices, 2u);
    EXPECT_EQ(answer.welcome->servo_pid, static_cast<std::uint32_t>(knurld.pid()));
    EXPECT_STREQ(answer.welcome->names[0], "left");
    EXPECT_STREQ(answer.welcome->names[1], "cartesian3");  // its profile's name
    ASSERT_EQ(answer.fds.size(), 2u);

    const DeviceView view(answer.fds[0].get());
    const protocol::DeviceInfo info = view.info();
    EXPECT_EQ(info.magic, protocol::segment_magic);
    EXPECT_EQ(info.layout_hash, protocol::wire_hash());
    EXPECT_STREQ(info.servo, "default");
    EXPECT_STREQ(info.address, "sim:premium15");
    EXPECT_EQ(info.rate, 1000);
    EXPECT_GT(info.max_stiffness, 0);
    EXPECT_TRUE(eventually([&] { return view.count(protocol::Count::cycles) > 10; }));
}

TEST(Attach, WithoutADescriptorLeftTheServoSaysSo) {
    KNURL_NEEDS(missing_programs_without_descriptors());
    const Home home;
    const Knurld knurld(home);
    rlimit before{};
    ASSERT_EQ(::prlimit(knurld.pid(), RLIMIT_NOFILE, nullptr, &before), 0);
    rlimit full = before;
    // The limit is one of numbers, so it is the lowest that is free.
    const std::filesystem::path descriptors = "/proc/" + std::to_string(knurld.pid()) + "/fd";
    full.rlim_cur = 0;
    while (
        std::filesystem::exists(std::filesystem::symlink_status(descriptors / std::to_string(full.rlim_cur))))
        ++full.rlim_cur;
    ASSERT_EQ(::prlimit(knurld.pid(), RLIMIT_NOFILE, &full, nullptr), 0);
    for (int i = 0; i < 3; ++i) {
        RawClient client(home);
        const Answer answer = client.greet();
        EXPECT_TRUE(contains(text(answer), "no descriptor left for one more client")) << text(answer);
    }
    ASSERT_EQ(::prlimit(knurld.pid(), RLIMIT_NOFILE, &before, nullptr), 0);
    RawClient client(home);
    EXPECT_TRUE(client.greet().welcome) << "it lets clients in again";
}

TEST(Attach, AnObserverThatResetsHoldsNothingAndMayDoNothingElse) {
    const Home home;
    const Knurld knurld(home);
    RawClient holder(home), other(home);
    ASSERT_TRUE(holder.greet("holder").welcome);
    ASSERT_TRUE(other.greet("other").welcome);
    ASSERT_TRUE(holder.claim({}).claimed);
    protocol::ClaimRequest request;
    request.observe = protocol::observe_and_reset;
    request.capacity = {.representations = protocol::max_representations,
                        .batch_bytes = protocol::max_batch_bytes};
    const Answer granted = other.claim(request);
    ASSERT_TRUE(granted.claimed) << text(granted);
    EXPECT_EQ(granted.claimed->capacity.representations, 1u) << "its capacity is the servo's";
    request.observe = protocol::observe_and_reset + 1;
    EXPECT_TRUE(contains(text(other.claim(request)), "observe is 0, 1 or 2"));
}

TEST(Attach, ReportsCannotBeMappedForWriting) {
    const Home home;
    const Knurld knurld(home);
    RawClient client(home);
    const Answer answer = client.greet();
    ASSERT_TRUE(answer.welcome);
    const int fd = answer.fds[0].get();
    const std::size_t bytes = protocol::device_layout().total;
    EXPECT_EQ(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0), MAP_FAILED);
    void* read_only = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
    ASSERT_NE(read_only, MAP_FAILED);
    EXPECT_NE(mprotect(read_only, bytes, PROT_READ | PROT_WRITE), 0);
    munmap(read_only, bytes);
    EXPECT_EQ(pwrite(fd, "x", 1, 0), -1);
    EXPECT_NE(ftruncate(fd, 0), 0);
}

TEST(Attach, AnotherBuildIsRefusedWithReasonAndRemedy) {
    const Home home;
    const Knurld knurld(home);
    protocol::Hello hello;
    hello.layout = protocol::wire_hash();

    RawClient old(home);
    protocol::Hello version = hello;
    version.version = protocol::protocol_version + 7;
    old.send(version);
    const Answer of_version = old.answer();
    EXPECT_TRUE(contains(text(of_version), "build mismatch")) << text(of_version);
    EXPECT_TRUE(contains(text(of_version), "restart")) << text(of_version);
    EXPECT_TRUE(old.answer().hung_up);

    RawClient other(home);
    protocol::Hello layout = hello;
    layout.layout ^= 1;
    other.send(layout);
    EXPECT_TRUE(contains(text(other.answer()), "build mismatch"));
    EXPECT_TRUE(other.answer().hung_up);

    RawClient shorter(home);
    shorter.send_bytes(&hello, sizeof hello - 8);
    EXPECT_TRUE(contains(text(shorter.answer()), "build mismatch"));

    RawClient stranger(home);
    protocol::Hello magic = hello;
    magic.header.magic = 0x12345678;
    stranger.send(magic);
    EXPECT_TRUE(contains(text(stranger.answer()), "not a message of Knurl's"));

    RawClient rude(home);
    rude.send(protocol::ClaimRequest{});
    EXPECT_TRUE(contains(text(rude.answer()), "Hello first"));
}

TEST(Attach, TheSecondIsToldWhoHoldsTheDevice) {
    const Home home;
    const Knurld knurld(home);
    RawClient first(home), second(home);
    ASSERT_TRUE(first.greet("painter").welcome);
    ASSERT_TRUE(second.greet().welcome);
    ASSERT_TRUE(first.claim({}).claimed);
    for (std::uint32_t shared : {0u, 1u}) {
        const Answer answer = second.claim({.shared = shared});
        ASSERT_TRUE(answer.refused);
        EXPECT_EQ(answer.refused->holder_pid, static_cast<std::uint32_t>(getpid()));
        EXPECT_TRUE(contains(text(answer), std::to_string(getpid()))) << text(answer);
        EXPECT_TRUE(contains(text(answer), "painter")) << text(answer);
        EXPECT_TRUE(contains(text(answer), "shared")) << text(answer);
    }
    first.hang_up();
    EXPECT_TRUE(eventually([&] { return second.claim({}).claimed.has_value(); }));
}

TEST(Attach, SharingIsExplicitOnBothSides) {
    const Home home;
    const Knurld knurld(home);
    RawClient a(home), b(home), c(home);
    for (RawClient* client : {&a, &b, &c}) ASSERT_TRUE(client->greet().welcome);
    EXPECT_TRUE(a.claim({.shared = 1}).claimed);
    EXPECT_TRUE(b.claim({.shared = 1}).claimed);
    EXPECT_TRUE(c.claim({.shared = 0}).refused);
    EXPECT_TRUE(c.claim({.observe = 1}).claimed);
}

TEST(Attach, ReleaseMakesRoomWithoutHangingUp) {
    const Home home;
    const Knurld knurld(home);
    RawClient a(home), b(home);
    ASSERT_TRUE(a.greet().welcome);
    ASSERT_TRUE(b.greet().welcome);
    const Answer held = a.claim({});
    ASSERT_TRUE(held.claimed);
    a.send(protocol::Release{.slot = held.claimed->slot, .device = 0});
    EXPECT_TRUE(eventually([&] { return b.claim({}).claimed.has_value(); }));
    // Not twice, and not somebody else's.
    a.send(protocol::Release{.slot = held.claimed->slot, .device = 0});
    EXPECT_TRUE(contains(text(a.answer()), "does not hold"));
}

TEST(Attach, TheTableOfClientsShowsWhoIsThereAndIsFreedAfterDeath) {
    const Home home;
    const Knurld knurld(home);
    RawClient watcher(home);
    const Answer welcome = watcher.greet();
    const DeviceView view(welcome.fds.at(0).get());
    EXPECT_EQ(view.held_rows(), 0u);
    {
        RawClient client(home);
        ASSERT_TRUE(client.greet("pain\nter").welcome);
        const Answer held = client.claim({.shared = 1});
        ASSERT_TRUE(held.claimed);
        const protocol::ClientRow& row = view.row(held.claimed->slot);
        EXPECT_EQ(row.pid.load(), static_cast<std::uint64_t>(getpid()));
        EXPECT_EQ(row.role.load(), 1u);
        EXPECT_EQ(row.shared.load(), 1u);
        EXPECT_EQ(row.sequence.load() % 2, 0u);
        char name[protocol::name_bytes];
        for (std::size_t i = 0; i < sizeof name / 8; ++i) {
            const std::uint64_t word = row.name[i].load();
            std::memcpy(name + 8 * i, &word, 8);
        }
        EXPECT_STREQ(name, "pain?ter");  // it appears on other people's terminals
        const Answer observing = client.claim({.observe = 1});
        ASSERT_TRUE(observing.claimed);
        EXPECT_EQ(view.row(observing.claimed->slot).role.load(), 2u);
        EXPECT_EQ(view.held_rows(), 2u);
    }
    EXPECT_TRUE(eventually([&] { return view.held_rows() == 0; }));
}

TEST(Attach, WhatAClaimMayAskForHasBounds) {
    const Home home;
    const Knurld knurld(home);
    RawClient client(home);
    ASSERT_TRUE(client.greet().welcome);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    using protocol::ClaimRequest;
    const std::pair<ClaimRequest, const char*> mistakes[] = {
        {{.device = 1}, "device 1 of 1"},
        {{.observe = 3}, "observe"},
        {{.shared = 7}, "shared"},
        {{.capacity = {.representations = 0}}, "0 representations; allowed: 1 to 1024"},
        {{.capacity = {.representations = 1025}}, "1025 representations"},
        {{.capacity = {.batch_bytes = 4}}, "batches of 4 bytes"},
        {{.capacity = {.batch_bytes = 0xffffffff}}, "batches of 4294967295 bytes"},
        {{.capacity = {.batch_bytes = 32 * 1024 + 1}}, "multiples of 8"},
        {{.workspace_radius = nan}, "workspace_radius"},
        {{.workspace_radius = -1}, "workspace_radius"},
        {{.workspace_centre = {0, nan, 0}}, "workspace_centre"},
        {{.update_interval = -1}, "update_interval"},
        {{.update_interval = nan}, "update_interval"},
    };
    for (const auto& [request, says] : mistakes) {
        const Answer answer = client.claim(request);
        EXPECT_TRUE(contains(text(answer), says)) << text(answer) << "\nlacks " << says;
        EXPECT_TRUE(answer.fds.empty());
    }
    EXPECT_TRUE(client.claim({}).claimed);  // the connection stays open, and nothing was granted in part
}

TEST(Attach, TheFrameAndLimitsThatWereGrantedAreTold) {
    const Home home;
    const Knurld knurld(home);
    RawClient client(home);
    const Answer welcome = client.greet();
    const protocol::DeviceInfo info = DeviceView(welcome.fds.at(0).get()).info();
    Answer answer =
        client.claim({.workspace_radius = 2 * info.workspace_radius, .workspace_centre = {1, 2, 3}});
    ASSERT_TRUE(answer.claimed);
    EXPECT_NEAR(answer.claimed->frame.scale, 2, 1e-12);
    EXPECT_EQ(answer.claimed->frame.world_centre.z, 3);
    EXPECT_GT(answer.claimed->limits.max_stiffness, 0);
    const HeldClaim claim(std::move(answer));  // the segment is as large as both sides compute
    EXPECT_EQ(claim.segment.size(), protocol::claim_layout({}).total);
}

TEST(Attach, OneProcessLeavesOthersAsManyRowsAsItTakesAndTheDeviceToItsClaims) {
    const Home home;
    const Knurld knurld(home);
    std::vector<std::unique_ptr<RawClient>> clients;
    std::uint32_t observers = 0;
    std::string last;
    for (int i = 0; i < 20 && last.empty(); ++i) {
        clients.push_back(std::make_unique<RawClient>(home));
        ASSERT_TRUE(clients.back()->greet().welcome);
        for (int j = 0; j < 16 && last.empty(); ++j) {
            const Answer answer = clients.back()->claim({.observe = 1});
            answer.claimed ? void(++observers) : void(last = text(answer));
        }
    }
    EXPECT_EQ(observers, (protocol::max_clients - 16) / 2) << "16 rows are for claims";
    EXPECT_TRUE(
        contains(last, "holds 56 and leaves 56, and nobody may hold more than he leaves, of its 128 places"))
        << last;
    EXPECT_TRUE(clients.front()->claim({}).claimed || clients.back()->claim({}).claimed);
    clients.clear();
    RawClient next(home);
    const Answer welcome = next.greet();
    const DeviceView view(welcome.fds.at(0).get());
    EXPECT_TRUE(eventually([&] { return view.held_rows() == 0; }));
    EXPECT_TRUE(next.claim({}).claimed);
}

}  // namespace
}  // namespace knurl::test

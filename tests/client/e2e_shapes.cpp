// A mesh from an application's memory to the hand, and the refusals on the way.

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>

#include <knurl/link/local.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/shm/segment.hpp>

#include "sent_shapes.hpp"

namespace {

using namespace client_test;
using knurl::AssetMaterial;
using knurl::Claim;
using knurl::Client;
using knurl::Error;
using knurl::Feedback;
using knurl::HandFeedback;
using knurl::HandReport;
using knurl::SentShape;
using knurl::Vec3;

TEST_F(Sent, a_mesh_is_felt) {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(5, 0.1);
    const SentShape sent = hand->send(triangles_of(ball));
    EXPECT_EQ(sent.faces, ball.triangles.size());
    EXPECT_LE(static_cast<double>(sent.bytes), 96.0 * static_cast<double>(sent.faces) + 4096);
    EXPECT_NEAR(sent.high.z, 0.1, 1e-6);
    EXPECT_EQ(sent.notes.edges_open, 0u);

    const knurl::Shape params{.asset = sent.asset, .position = {at.x, at.y, at.z - 0.2}, .stiffness = 200};
    auto shape = hand->add(params);
    hand->arm();
    press(shape, params, 0.1, 0.001);
    const HandFeedback felt = until_touched(shape);
    EXPECT_LT(std::hypot(felt.force.x, felt.force.y), 0.1 * felt.force.z);
    EXPECT_EQ(felt.stiffness, 200);
}

TEST_F(Sent, begin_sending_lets_the_application_go_on) {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(6, 0.1);
    knurl::Sending sending = hand->begin_sending(triangles_of(ball));
    EXPECT_NE(answer_to([&] { hand->add(knurl::Shape{.asset = 1}); }).find("asset 1"), std::string::npos)
        << "it is not there yet";
    std::optional<SentShape> sent;
    int commits = 0;
    const bool done = eventually([&] {
        hand->commit();
        ++commits;
        sent = sending.done();
        return sent.has_value();
    });
    ASSERT_TRUE(done);
    EXPECT_GT(commits, 1);
    pollfd ready{.fd = sending.fd(), .events = POLLIN, .revents = 0};
    EXPECT_GE(poll(&ready, 1, 0), 0);
    EXPECT_EQ(sending.done()->asset, sent->asset) << "it says so again";
    hand->add(knurl::Shape{.asset = sent->asset});
}

TEST_F(Sent, what_is_no_mesh_is_refused_with_its_triangle_and_nothing_is_lost) {
    knurl::test::MadeMesh bad = knurl::test::icosphere(2, 0.1);
    bad.triangles[17][1] = 5000;
    const std::string why = answer_to([&] { hand->send(triangles_of(bad)); });
    EXPECT_NE(why.find("17"), std::string::npos) << why;
    EXPECT_NE(why.find("5000"), std::string::npos) << why;
    EXPECT_NE(answer_to([&] { hand->send(knurl::Triangles{}); }).find("no triangles"), std::string::npos);
    EXPECT_NE(answer_to([&] { hand->send(triangles_of(bad), {.scale = 0}); }).find("scale"),
              std::string::npos);
    EXPECT_NE(answer_to([&] { hand->send(triangles_of(bad), {.weld = -1}); }).find("weld"),
              std::string::npos);
    const knurl::test::MadeMesh good = knurl::test::icosphere(2, 0.1);
    EXPECT_NE(answer_to([&] {
                  hand->send(triangles_of(good), {.materials = {{.stiffness = 2}}});
              }).find("material 0"),
              std::string::npos);
    const SentShape sent = hand->send(triangles_of(good));
    EXPECT_EQ(sent.asset, 1u) << "the refused ones took no number";
}

/// The servo returns a number in one of its cycles: until then it is taken.
std::uint32_t number_when_it_is_free(knurl::Claim& hand, const knurl::test::MadeMesh& mesh) {
    std::optional<SentShape> sent;
    EXPECT_TRUE(eventually([&] {
        hand.commit();
        const std::string why = answer_to([&] { sent = hand.send(triangles_of(mesh)); });
        EXPECT_TRUE(sent || why.find("taken") != std::string::npos) << why;
        return sent.has_value();
    }));
    return sent ? sent->asset : 0;
}

TEST_F(Sent, numbers_are_given_back) {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(1, 0.1);
    const SentShape sent = hand->send(triangles_of(ball));
    auto shape = hand->add(knurl::Shape{.asset = sent.asset, .position = at, .stiffness = 100});
    EXPECT_NE(answer_to([&] { hand->forget(sent.asset); }).find("slot 0"), std::string::npos);
    shape.remove();
    hand->forget(sent.asset);
    EXPECT_NE(answer_to([&] { hand->forget(sent.asset); }).find("asset 1"), std::string::npos);
    EXPECT_NE(answer_to([&] { hand->add(knurl::Shape{.asset = sent.asset}); }).find("asset 1"),
              std::string::npos);
    EXPECT_EQ(number_when_it_is_free(*hand, ball), 1u);
}

TEST_F(Sent, one_that_is_called_off_when_it_is_ready_already_leaves_its_number_free) {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(1, 0.1);
    for (int i = 0; i < 5; ++i) {
        {
            const knurl::Sending sending = hand->begin_sending(triangles_of(ball));
            pollfd ready{.fd = sending.fd(), .events = POLLIN, .revents = 0};
            ASSERT_EQ(::poll(&ready, 1, 30'000), 1);
        }
        ASSERT_EQ(number_when_it_is_free(*hand, ball), 1u);
        hand->forget(1);
    }
}

TEST_F(Sent, one_that_was_ready_for_a_servo_that_has_gone_is_to_be_sent_again) {
    const knurl::test::MadeMesh ball = knurl::test::icosphere(2, 0.1);
    knurl::Sending sending = hand->begin_sending(triangles_of(ball));
    pollfd ready{.fd = sending.fd(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(::poll(&ready, 1, 30'000), 1);
    servo->end(SIGKILL);
    servo->start();
    ASSERT_TRUE(eventually([&] { return hand->reattachments() == 1 && hand->connected(); }));
    EXPECT_NE(answer_to([&] { sending.done(10s); }), "accepted");
    EXPECT_NE(answer_to([&] { hand->add(knurl::Shape{.asset = 1}); }).find("has sent none"),
              std::string::npos);
    EXPECT_EQ(hand->send(triangles_of(ball)).asset, 1u);
}

TEST_F(Sent, a_restarted_servo_gets_it_again) {
    const SentShape sent = hand->send(triangles_of(knurl::test::icosphere(4, 0.1)));
    const knurl::Shape params{.asset = sent.asset, .position = {at.x, at.y, at.z - 0.2}, .stiffness = 200};
    auto shape = hand->add(params);
    hand->commit();
    servo->end(SIGKILL);
    servo->start();
    ASSERT_TRUE(eventually([&] { return hand->reattachments() == 1 && hand->connected(); }));
    hand->arm();
    press(shape, params, 0.1, 0.001);
    EXPECT_GT(until_touched(shape).force.z, 0);
}

TEST_F(Sent, more_than_a_claim_may_hold_is_refused_with_what_it_would_take) {
    // A grid of three million triangles, of which only the counts matter.
    const knurl::test::MadeMesh large = knurl::test::grid(1300, 1200, 1e-4, 1e-4);
    const std::string why = answer_to([&] { hand->send(triangles_of(large)); });
    EXPECT_NE(why.find("bytes"), std::string::npos) << why;
    EXPECT_NE(why, "accepted");
    const SentShape sent = hand->send(triangles_of(knurl::test::icosphere(2, 0.1)));
    EXPECT_EQ(sent.asset, 1u);
}

// Messages that the library would never send.
struct ByHand : Sent {
    static std::vector<std::byte> source(const knurl::test::MadeMesh& shape) {
        knurl::protocol::AssetSource header;
        header.vertices = shape.vertices.size();
        header.triangles = shape.triangles.size();
        const auto layout = *knurl::protocol::layout_of(header);
        std::vector<std::byte> bytes(layout.total);
        std::memcpy(bytes.data(), &header, sizeof header);
        std::memcpy(bytes.data() + layout.vertices, shape.vertices.data(), 24 * shape.vertices.size());
        std::memcpy(bytes.data() + layout.triangles, shape.triangles.data(), 12 * shape.triangles.size());
        return bytes;
    }
    static knurl::shm::UniqueFd memory_of(std::span<const std::byte> bytes, bool sealed = true) {
        knurl::shm::UniqueFd fd(::memfd_create("test", MFD_CLOEXEC | MFD_ALLOW_SEALING));
        EXPECT_EQ(::write(fd.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
        if (sealed) ::fcntl(fd.get(), F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL);
        return fd;
    }
    /// A claim whose key the test knows.
    struct Held {
        std::unique_ptr<knurl::detail::Link> link = knurl::detail::connect_local("default", "by hand", 10s);
        knurl::detail::Attachment attachment;
        Held() {
            knurl::protocol::ClaimRequest request;
            request.shared = 1;
            attachment = link->attach(0, request);
        }
        auto offer(std::uint32_t number, const knurl::shm::UniqueFd& memory, std::uint64_t bytes) {
            return attachment.assets->offer(number, memory, bytes);
        }
        std::string refused(std::uint32_t number, const knurl::shm::UniqueFd& memory, std::uint64_t bytes) {
            return answer_to([&] { offer(number, memory, bytes)->answer(60s); });
        }
    };
    void SetUp() override {
        if (ServoProcess::through_bridge()) GTEST_SKIP() << "the servo's own door: one way is enough";
        Sent::SetUp();
        hand.reset();  // it does not share
    }
};

TEST_F(ByHand, memory_that_is_not_sealed_or_of_another_size_is_refused) {
    const auto bytes = source(knurl::test::icosphere(1, 0.1));
    ASSERT_TRUE(eventually([] {
        try {
            return Held().link != nullptr;
        } catch (const Error&) {
            return false;
        }
    }));
    Held held;
    EXPECT_NE(held.refused(1, memory_of(bytes, false), bytes.size()).find("F_SEAL_WRITE"), std::string::npos);
    EXPECT_NE(held.refused(1, memory_of(bytes), bytes.size() - 8).find("bytes instead of"),
              std::string::npos);
    EXPECT_NE(held.refused(1, memory_of({bytes.data(), 40}), 40).find("no mesh"), std::string::npos);
    EXPECT_NE(held.refused(1, memory_of({bytes.data(), bytes.size() - 4}), bytes.size() - 4).find("cut off"),
              std::string::npos);
    EXPECT_NE(held.refused(0, memory_of(bytes), bytes.size()).find("number 0"), std::string::npos);
    EXPECT_NE(held.refused(65, memory_of(bytes), bytes.size()).find("number 65"), std::string::npos);
    EXPECT_EQ(held.refused(1, memory_of(bytes), bytes.size()), "accepted");
    EXPECT_NE(held.refused(1, memory_of(bytes), bytes.size()).find("taken"), std::string::npos);
}

TEST_F(ByHand, a_second_one_under_the_number_of_one_that_is_being_built_is_refused) {
    const auto large = source(knurl::test::icosphere(8, 0.1)), small = source(knurl::test::icosphere(1, 0.1));
    std::optional<Held> held;
    ASSERT_TRUE(eventually([&] { return answer_to([&] { held.emplace(); }) == "accepted"; }));
    auto first = held->offer(3, memory_of(large), large.size());
    EXPECT_NE(held->refused(3, memory_of(small), small.size()).find("being built"), std::string::npos);
    // A hang-up cancels it, and the number is free.
    first.reset();
    EXPECT_TRUE(eventually([&] { return held->refused(3, memory_of(small), small.size()) == "accepted"; }));
}

TEST_F(ByHand, random_bytes_never_harm_the_servo) {
    std::optional<Held> held;
    ASSERT_TRUE(eventually([&] { return answer_to([&] { held.emplace(); }) == "accepted"; }));
    constexpr std::uint64_t seed = 4711;
    RecordProperty("seed", std::to_string(seed));
    knurl::test::Rng rng(seed);
    const auto good = source(knurl::test::icosphere(2, 0.1));
    std::uint32_t number = 1;
    for (int round = 0; round < 30; ++round) {
        auto bytes = good;
        for (std::size_t hits = 1 + knurl::test::below(rng, 40); hits > 0; --hits)
            bytes[knurl::test::below(rng,
                                     round % 2 == 0 ? bytes.size() : sizeof(knurl::protocol::AssetSource))] =
                static_cast<std::byte>(rng());
        const std::string why = held->refused(number, memory_of(bytes), bytes.size());
        EXPECT_EQ(why.find("died"), std::string::npos) << why << ", round " << round;
        if (why == "accepted") ++number;
    }
    EXPECT_EQ(::kill(servo->pid(), 0), 0);
    EXPECT_EQ(held->refused(number, memory_of(good), good.size()), "accepted");
}

}  // namespace

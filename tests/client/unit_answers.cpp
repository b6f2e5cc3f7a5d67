// The servo's answers, and what the application gets of them. The test plays the servo, in its own memory, so
// it can give answers that a real one gives only when the two disagree.

#include <cstdlib>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "../refusal.hpp"
#include "../temp_folder.hpp"

namespace {

using namespace knurl;
using namespace std::chrono_literals;
using protocol::CommandType;

template <class Message>
std::span<const std::byte> bytes_of(const Message& message) {
    return std::as_bytes(std::span(&message, 1));
}

/// Welcomes one client and grants it one claim. Its cycles are the test's calls.
class PlayedServo {
  public:
    PlayedServo() {
        ::setenv("KNURL_RUNTIME_DIR", folder_.path().c_str(), 1);
        protocol::DeviceInfo info;
        info.magic = protocol::segment_magic;
        info.layout_hash = protocol::wire_hash();
        std::string("right").copy(info.name, sizeof info.name - 1);
        std::memcpy(device_.data(), &info, sizeof info);
        shm::broadcast_init(device_.data() + protocol::device_layout().reports);
        device_.seal_against_new_writers();
        shm::spsc_init(claim_.data() + layout_.commands);
        shm::spsc_init(claim_.data() + layout_.replies);
        shm::triple_init(claim_.data() + layout_.batches);
        shm::triple_init(claim_.data() + layout_.feedback);
        listener_ = shm::listen_at(protocol::socket_path("default"), 0600, 4);
        broker_ = std::jthread([this] { serve(); });
    }
    ~PlayedServo() { broker_ = {}; }

    /// The next command's header; the ring is real.
    protocol::CommandHeader next_command() {
        while (commands_.available() == 0) std::this_thread::yield();
        std::array<std::byte, shm::cell_bytes> cell;
        commands_.peek(0, cell.data(), 1);
        protocol::CommandHeader header;
        std::memcpy(&header, cell.data(), sizeof header);
        commands_.pop(header.cells);
        return header;
    }
    void answer(const protocol::Reply& reply) { replies_.try_push(&reply, 1); }
    void feed_back(const protocol::FeedbackHeader& header) { feedback_.publish(&header, sizeof header); }
    void cycle() {
        report_.cycle++;
        reports_.publish(&report_);
    }
    std::optional<protocol::BatchHeader> take() {
        if (!batches_.take()) return std::nullopt;
        protocol::BatchHeader header;
        batches_.copy(&header, 0, sizeof header);
        return header;
    }

  private:
    void serve() {
        shm::UniqueFd peer;
        while (!peer) peer = shm::accept_from(listener_);
        std::array<std::byte, 4096> buffer;
        shm::receive_message(peer, buffer);
        protocol::Welcome welcome;
        welcome.devices = 1;
        shm::send_message(peer, bytes_of(welcome), std::array{device_.fd()});
        shm::receive_message(peer, buffer);
        const protocol::Claimed claimed{.capacity = capacity_, .frame = {}, .limits = {}};
        const shm::WakePair wake = shm::make_wake_pair();
        shm::send_message(peer, bytes_of(claimed), std::array{claim_.fd(), wake.client.get()});
        shm::receive_message(peer, buffer);  // Mapped
        shm::send_message(peer, bytes_of(protocol::Serving{}));
        while (!shm::receive_message(peer, buffer).closed) {
        }
    }

    protocol::ClaimCapacity capacity_;
    protocol::ClaimLayout layout_ = protocol::claim_layout(capacity_);
    test::TempFolder folder_;
    shm::Segment device_ = shm::Segment::create("played", protocol::device_layout().total);
    shm::Segment claim_ = shm::Segment::create("played", layout_.total);
    shm::SpscConsumer commands_{claim_.data() + layout_.commands, layout_.command_cells};
    shm::SpscProducer replies_{claim_.data() + layout_.replies, protocol::reply_cells};
    shm::TripleReader batches_{claim_.data() + layout_.batches, layout_.batch_slot_bytes};
    shm::TripleWriter feedback_{claim_.data() + layout_.feedback, layout_.feedback_slot_bytes};
    shm::BroadcastWriter reports_{device_.data() + protocol::device_layout().reports, protocol::report_slots,
                                  sizeof(Report)};
    Report report_;
    shm::UniqueFd listener_;
    std::jthread broker_;
};

class Answers : public ::testing::Test {
  protected:
    PlayedServo servo;
    Client client = Client::connect("knurl:default", {.reattach = false});
    Claim hand = client.claim();

    /// The text that `call`, which waits, throws when the servo refuses its command so.
    template <class Call>
    std::string refused(Call call, protocol::RefusalReason reason, double value) {
        std::jthread played([&] {
            const auto header = servo.next_command();
            servo.answer({.command = header.number,
                          .code = static_cast<std::uint32_t>(Verdict::Code::refused),
                          .value = value,
                          .reason = static_cast<std::uint32_t>(reason)});
            servo.cycle();
        });
        return test::refusal_of<Error>(call);
    }
};

TEST_F(Answers, arm_waits_for_its_own_and_says_why_not) {
    EXPECT_EQ(
        refused([&] { hand.arm(); }, protocol::RefusalReason::in_fault, fault::speed | fault::unplugged),
        "cannot arm device 'right': the device is in fault (the hand was too fast, the device was "
        "unplugged); "
        "mend the cause, then call reset_fault() or run: knurl reset");
    EXPECT_EQ(refused([&] { hand.arm(); }, protocol::RefusalReason::hand_too_fast, 0.5),
              "cannot arm device 'right': the hand moves at 0.5 m/s; hold it still and try again");
    EXPECT_EQ(refused([&] { hand.reset_fault(); }, protocol::RefusalReason::not_in_fault, 0),
              "cannot reset device 'right': the device is not in fault; call arm() instead");
    EXPECT_EQ(
        refused([&] { hand.together([&] { hand.arm(); }); }, protocol::RefusalReason::not_calibrated, 0),
        "cannot arm device 'right': the device is not calibrated; bring it to its home position first");
}

TEST_F(Answers, a_servo_that_does_not_is_given_a_second) {
    EXPECT_NE(test::refusal_of<Error>([&] { hand.arm(); }).find("has not answered for 1000 ms"),
              std::string::npos);
}

TEST_F(Answers, an_added_one_that_is_refused_is_heard_at_the_next_commit_and_its_handle_is_stale) {
    auto force = hand.add(ConstantForce{.force = {1, 0, 0}});
    const auto header = servo.next_command();
    EXPECT_EQ(header.type, CommandType::add);
    servo.answer({.command = header.number,
                  .code = static_cast<std::uint32_t>(Verdict::Code::too_many),
                  .field = Verdict::no_field,
                  .value = 7,
                  .kind = kind_of<ConstantForce>});
    EXPECT_NE(test::refusal_of<Error>([&] { hand.commit(); }).find("constant_force"), std::string::npos);
    EXPECT_TRUE(servo.take()) << "the batch was sent all the same";
    EXPECT_EQ(test::refusal_of<Error>([&] { hand.commit(); }), "accepted") << "once";
    EXPECT_NE(test::refusal_of<Error>([&] { force.set({}); }).find("was removed, or refused"),
              std::string::npos);
}

TEST_F(Answers, of_a_group_the_member_at_fault_is_named_not_the_others) {
    hand.together([&] {
        hand.add(ConstantForce{});
        hand.add(Spring{.stiffness = 1});
        hand.add(ConstantForce{});
    });
    const auto group = [](std::uint64_t number) {
        return protocol::Reply{.command = number,
                               .code = static_cast<std::uint32_t>(Verdict::Code::refused),
                               .reason = static_cast<std::uint32_t>(protocol::RefusalReason::group_refused)};
    };
    const auto first = servo.next_command(), second = servo.next_command(), third = servo.next_command();
    EXPECT_EQ(first.flags, 1u);
    EXPECT_EQ(second.flags, 1u);
    EXPECT_EQ(third.flags, 0u);
    servo.answer(group(first.number));
    servo.answer({.command = second.number,
                  .code = static_cast<std::uint32_t>(Verdict::Code::slot_in_use),
                  .field = Verdict::no_field,
                  .value = 1,
                  .kind = kind_of<Spring>});
    servo.answer(group(third.number));
    const std::string text = test::refusal_of<Error>([&] { hand.commit(); });
    EXPECT_NE(text.find("adding a spring"), std::string::npos) << text;
}

TEST_F(Answers, a_refused_batch_names_its_field_and_is_counted) {
    hand.add(Plane{.stiffness = 1});
    const std::uint64_t number = hand.commit();
    ASSERT_TRUE(servo.take());
    protocol::FeedbackHeader header;
    header.batches_refused = 1;
    header.refused_batch = number;
    header.refused_code = static_cast<std::uint32_t>(Verdict::Code::not_finite);
    header.refused_kind = kind_of<Plane>;
    header.refused_field = 1;
    header.refused_value = std::numeric_limits<double>::infinity();
    servo.feed_back(header);
    const std::string text = test::refusal_of<Error>([&] { hand.wait_applied(number, 10s); });
    EXPECT_NE(text.find("batch 1, slot 0"), std::string::npos) << text;
    EXPECT_NE(text.find("plane.offset"), std::string::npos) << text;
    EXPECT_EQ(hand.timing().refused, 1u);
    EXPECT_EQ(test::refusal_of<Error>([&] { hand.commit(); }), "accepted") << "told once";
}

TEST_F(Answers, a_contradiction_says_its_reason) {
    constexpr auto contradiction = static_cast<std::uint32_t>(Verdict::Code::contradiction);
    auto plane = hand.add(Plane{});
    servo.answer({.command = servo.next_command().number,
                  .code = contradiction,
                  .field = row_of<Plane>("friction.static"),
                  .value = 0.25,
                  .reason = 0,
                  .kind = kind_of<Plane>});
    std::string text = test::refusal_of<Error>([&] { hand.commit(); });
    EXPECT_NE(text.find("plane.friction.static = 0.25 is below friction.dynamic; give at least as much"),
              std::string::npos)
        << text;

    protocol::FeedbackHeader header;
    header.batches_refused = 1;
    header.refused_batch = 1;
    header.refused_code = contradiction;
    header.refused_kind = kind_of<Plane>;
    header.refused_field = row_of<Plane>("friction.static");
    header.refused_value = 0.5;
    header.refused_reason = 0;
    ASSERT_TRUE(servo.take());
    servo.feed_back(header);
    text = test::refusal_of<Error>([&] { hand.wait_applied(1, 10s); });
    EXPECT_NE(text.find("plane.friction.static = 0.5 is below friction.dynamic"), std::string::npos) << text;
}

TEST_F(Answers, a_contradiction_is_heard_whatever_its_index_also_the_one_that_means_a_refused_group) {
    hand.add(Plane{});
    servo.answer({.command = servo.next_command().number,
                  .code = static_cast<std::uint32_t>(Verdict::Code::contradiction),
                  .reason = static_cast<std::uint32_t>(protocol::RefusalReason::group_refused),
                  .kind = kind_of<Plane>});
    EXPECT_NE(test::refusal_of<Error>([&] { hand.commit(); }).find("contradicts"), std::string::npos);
}

TEST_F(Answers, a_batch_says_how_many_commands_came_before_it_and_which_report_it_stems_from) {
    servo.cycle();
    servo.cycle();
    auto force = hand.add(ConstantForce{});
    hand.add(ConstantForce{});
    hand.next_report(1s);
    const auto basis = hand.next_report(1s);
    force.set({.force = {1, 0, 0}});
    servo.cycle();
    hand.next_report(1s);  // newer than the report of the change
    hand.commit();
    const auto header = servo.take();
    ASSERT_TRUE(header);
    EXPECT_EQ(header->commands_before, 2u);
    ASSERT_TRUE(basis);
    EXPECT_EQ(header->report_cycle, basis->cycle);
    EXPECT_EQ(header->entries, 1u);
    EXPECT_EQ(header->sequence, 1u);
    hand.commit();
    EXPECT_EQ(servo.take()->report_cycle, 0u) << "an empty commit was computed from nothing";
}

TEST_F(Answers, the_age_of_updates_is_what_the_servo_measured) {
    protocol::FeedbackHeader header;
    for (const std::int64_t age : {9, 7, 8, 100, 8}) {  // ms; one late wake-up has no effect
        header.batch = hand.commit();
        header.batch_report_cycle = 1;
        header.batch_age_ns = age * 1'000'000;
        servo.feed_back(header);
        hand.timing();
    }
    EXPECT_EQ(hand.timing().age_at_use, 8ms);
}

}  // namespace

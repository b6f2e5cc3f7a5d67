// knurl_chaos_app MODE [ARGUMENTS]: the application that the chaos runner disturbs, and those that disturb
// others.
//
//   wall [ADDRESS]        renders a wall at 50 updates a second; SIGUSR1: arms (after a reset in case of a
//                         fault); SIGUSR2: forks a child that exits normally. Prints a line for each action.
//   exclusive             asks for an exclusive claim, and prints the answer
//   observer              reads every report until SIGTERM, then prints how many were read, missed, published
//   hostile SEED SOCKET   claims, then writes random bytes over its own segment until SIGTERM
//   absurd SEED SOCKET    sends batches that are not finite, until the servo names the wrong field

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

#include <knurl/client/client.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/reps/all.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>

#include "raw_claim.hpp"

namespace {

using namespace std::chrono_literals;
namespace protocol = knurl::protocol;

volatile std::sig_atomic_t arm_wanted = 1, fork_wanted = 0, leaving = 0;

constexpr int forks_child = -1;

void say(const char* what, long long number) {
    static int line = 0;
    std::printf("%s #%d %lld\n", what, ++line, number);
    std::fflush(stdout);
}

void arm(knurl::Claim& hand) {
    const auto report = hand.latest();
    if (report && report->state == knurl::DeviceState::fault) hand.reset_fault();
    hand.arm();
    say("armed", getpid());
}

int wall(const std::string& address) {
    constexpr auto interval = 20ms;
    auto client = knurl::Client::connect(address, {.wait = 20s});
    auto hand = client.claim("", {.shared = true, .update_interval = interval});
    auto plane = hand.add(knurl::Plane{.normal = {0, 0, 1}, .offset = 0.010, .stiffness = 800});
    knurl::Plane moved = plane.params();
    std::uint64_t reattachments = 0;
    auto next = std::chrono::steady_clock::now();
    for (long long i = 0; leaving == 0; ++i) {
        try {
            if (arm_wanted != 0) {
                arm_wanted = 0;
                arm(hand);
            }
            if (fork_wanted != 0) {
                fork_wanted = 0;
                const pid_t child = fork();
                if (child == 0) return forks_child;  // runs the destructors of a claim that is its parent's
                waitpid(child, nullptr, 0);
                say("forked", child);
            }
            moved.offset = i % 2 == 0 ? 0.010 : 0.0101;
            plane.set(moved);
            hand.commit();
            if (hand.reattachments() != reattachments) {
                reattachments = hand.reattachments();
                std::printf("reattached-to %d\n", client.servo_pid());
                std::fflush(stdout);
            }
        } catch (const knurl::Error& error) {
            if (error.kind != knurl::Error::Kind::disconnected) throw;
        }
        // The interval is timed by a clock, not by counting reports: a bad network drops many of them.
        next = std::max(next + interval, std::chrono::steady_clock::now());
        for (auto now = next - interval; leaving == 0 && now < next; now = std::chrono::steady_clock::now())
            hand.next_report(next - now);
    }
    return 0;
}

int exclusive() {
    auto client = knurl::Client::connect();
    try {
        auto hand = client.claim();
        say("granted", getpid());
    } catch (const knurl::Error& error) {
        std::printf("refused: %s\n", error.what());
        say("refused-by", error.holder);
    }
    return 0;
}

int observer() {
    auto client = knurl::Client::connect();
    auto reports = client.observe();
    const auto first = reports.next_report(5s);
    if (!first) return 1;
    say("reading", static_cast<long long>(first->cycle));
    std::uint64_t read = 1, last = first->cycle;
    while (leaving == 0) {
        if (const auto report = reports.next_report(100ms)) {
            ++read;
            last = report->cycle;
        }
    }
    say("read", static_cast<long long>(read));
    say("missed", static_cast<long long>(reports.missed()));
    say("published", static_cast<long long>(last - first->cycle + 1));
    return read + reports.missed() == last - first->cycle + 1 ? 0 : 1;
}

int hostile(unsigned seed, const std::string& socket_path) {
    const knurl::chaos::ServedClaim claim(socket_path);
    auto* words = reinterpret_cast<std::uint64_t*>(claim.memory);
    const protocol::ClaimLayout& layout = claim.layout;
    std::mt19937_64 random(seed);
    say("scribbling", getpid());
    while (leaving == 0) {
        // Mostly the control words (the first cache lines of each ring), otherwise anywhere.
        const std::size_t parts[] = {layout.waiter, layout.commands, layout.batches, layout.replies,
                                     layout.feedback};
        const std::size_t at =
            random() % 4 != 0 ? (parts[random() % 5] + random() % 512) / 8 : random() % (layout.total / 8);
        const std::uint64_t value = random() % 2 == 0 ? random() : random() % 64;
        std::atomic_ref<std::uint64_t>(words[at]).store(value, std::memory_order_relaxed);
    }
    return 0;
}

/// Adds two planes, arms, and changes both in one batch: one change is valid, the other has an absurd number.
int absurd(unsigned seed, const std::string& socket_path) {
    using knurl::Plane;
    const knurl::chaos::ServedClaim claim(socket_path);
    const protocol::ClaimLayout& layout = claim.layout;
    knurl::shm::SpscProducer commands(claim.memory + layout.commands, layout.command_cells);
    knurl::shm::TripleWriter batches(claim.memory + layout.batches, layout.batch_slot_bytes);
    knurl::shm::TripleReader feedback(claim.memory + layout.feedback, layout.feedback_slot_bytes);
    knurl::shm::SentCount sent_count(reinterpret_cast<knurl::shm::WaiterFlag*>(claim.memory + layout.waiter));

    Plane far{.offset = -1, .stiffness = 100};  // out of the hand's reach
    for (std::uint32_t slot = 0; slot < 2; ++slot) {
        struct {
            protocol::CommandHeader header;
            protocol::AddBody body;
            Plane plane;
            std::byte rest[64] = {};
        } add;
        add.header = {
            .cells = 0, .type = protocol::CommandType::add, .number = slot + 1, .bytes = sizeof far};
        add.header.cells = static_cast<std::uint32_t>(
            (sizeof add.header + sizeof add.body + sizeof far + knurl::shm::cell_bytes - 1) /
            knurl::shm::cell_bytes);
        add.body = {.id = {slot, 1}, .kind = knurl::kind_of<Plane>, .options = {}};
        add.plane = far;
        if (!commands.try_push(&add, add.header.cells)) return 1;
    }
    std::array<std::byte, knurl::shm::cell_bytes> arm = {};
    const protocol::CommandHeader header{.cells = 1, .type = protocol::CommandType::arm, .number = 3};
    std::memcpy(arm.data(), &header, sizeof header);
    if (!commands.try_push(arm.data(), 1)) return 1;
    sent_count.add();
    const double numbers[] = {std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity(),
                              -std::numeric_limits<double>::infinity(), -1e308};
    std::mt19937_64 random(seed);
    std::uint64_t sent = 0;
    while (leaving == 0) {
        struct {
            protocol::BatchHeader header;
            struct {
                protocol::EntryHeader header;
                Plane plane;
            } entry[2];
        } batch;
        batch.header = {.sequence = ++sent, .commands_before = 3, .entries = 2, .bytes = sizeof batch.entry};
        for (std::uint32_t slot = 0; slot < 2; ++slot) {
            batch.entry[slot].header = {
                .id = {slot, 1}, .kind = knurl::kind_of<Plane>, .bytes = sizeof far, .version = sent};
            batch.entry[slot].plane = far;
        }
        // The hand would feel the first entry if the servo applied the batch in part.
        batch.entry[0].plane.offset = 0.05;
        batch.entry[1].plane.damping = numbers[random() % 4];
        batches.publish(&batch, sizeof batch, 3);
        sent_count.add();
        if (feedback.take()) {
            protocol::FeedbackHeader told;
            feedback.copy(&told, 0, sizeof told);
            if (told.batches_refused > 0 && told.refused_slot == 1) {
                say("told-of-field", told.refused_field);
                return 0;
            }
        }
    }
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    const std::string mode = argc > 1 ? argv[1] : "";
    std::signal(SIGUSR1, [](int) { arm_wanted = 1; });
    std::signal(SIGUSR2, [](int) { fork_wanted = 1; });
    std::signal(SIGTERM, [](int) { leaving = 1; });
    try {
        if (mode == "wall") {
            const int code = wall(argc > 2 ? argv[2] : "knurl:default");
            if (code == forks_child)
                ::_exit(0);  // a sanitizer's search for leaks would need the parent's threads
            return code;
        }
        if (mode == "exclusive") return exclusive();
        if (mode == "observer") return observer();
        if (mode == "hostile" && argc > 3)
            return hostile(static_cast<unsigned>(std::stoul(argv[2])), argv[3]);
        if (mode == "absurd" && argc > 3) return absurd(static_cast<unsigned>(std::stoul(argv[2])), argv[3]);
        std::fprintf(stderr, "knurl_chaos_app: wall, exclusive, observer, hostile or absurd SEED SOCKET\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "knurl_chaos_app: %s\n", error.what());
    }
    return 1;
}

// knurl_chaos_attacker MODE SEED SOCKET: clients, valid and invalid ones, that exhaust the servo's resources
// until SIGTERM. Each prints a line when it has begun.
//
//   holes       removes pages of its segment, before and after it is served
//   lingering   sends descriptors whose last close takes an hour, and disconnects
//   waiting     marks itself as asleep all the time, and never reads the socket that the wake-ups fill
//   springs     holds 16 claims, each with 1024 springs at the hand
//   adding      holds 14 claims, in each of which it adds and removes 256 representations without end
//   churn       connects, claims, adds, sometimes sends a mesh, disconnects, without end

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <knurl/client/client.hpp>
#include <knurl/protocol/asset.hpp>
#include <knurl/reps/shape.hpp>
#include <knurl/reps/spring.hpp>
#include <knurl/shm/waiter.hpp>

#include "../lingering.hpp"
#include "raw_claim.hpp"

namespace {

using namespace std::chrono_literals;
using knurl::chaos::RawClaim;
namespace protocol = knurl::protocol;

volatile std::sig_atomic_t leaving = 0;
bool begun = false;

void say_once() {
    if (begun) return;
    begun = true;
    std::puts("attacking");
    std::fflush(stdout);
}

/// Removes a page by every system call that can.
void take_pages(RawClaim& claim, std::size_t at) {
    constexpr std::size_t page = 4096;
    constexpr int pageout = 21;
    fallocate(claim.file.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(at), page);
    for (const int advice : {MADV_REMOVE, MADV_DONTNEED, pageout}) madvise(claim.memory + at, page, advice);
    posix_fadvise(claim.file.get(), static_cast<off_t>(at), page, POSIX_FADV_DONTNEED);
}

void holes(std::mt19937& random, const std::string& socket) {
    RawClaim claim(socket);
    const auto some_page = [&] { return random() % (claim.layout.total / 4096) * 4096; };
    if (random() % 2 == 0) {
        take_pages(claim, some_page());
        claim.begin();  // refused
        return;
    }
    if (!claim.begin()) return;
    for (int i = 0; i < 200 && leaving == 0; ++i) take_pages(claim, some_page());
    munmap(claim.memory, claim.layout.total);
}

void lingering(std::mt19937& random, const std::string& socket) {
    std::vector<std::unique_ptr<knurl::test::Lingering>> made;
    RawClaim claim(socket);
    if (random() % 2 == 0) claim.begin();
    for (unsigned i = 0; i < 1 + random() % 4; ++i) {
        made.push_back(std::make_unique<knurl::test::Lingering>());
        const int fd = made.back()->fd();
        protocol::AssetOffer offer;
        offer.key = random() % 2 == 0 ? claim.granted.key : random();
        offer.number = 1;
        offer.bytes = 4096;
        if (!knurl::shm::send_message(claim.socket, std::as_bytes(std::span(&offer, 1)), {&fd, 1})) break;
        made.back()->let_go_aside();
    }
    // The socket closes with messages, and so with descriptors, unread.
}

void waiting(const std::string& socket) {
    knurl::chaos::ServedClaim claim(socket);
    auto* flag = reinterpret_cast<knurl::shm::WaiterFlag*>(claim.memory + claim.layout.waiter);
    const std::atomic_ref<std::uint64_t> waits(flag->waiting);
    say_once();
    while (leaving == 0) waits.store(static_cast<std::uint64_t>(knurl::shm::Waits::on_socket));
}

void springs(const knurl::Vec3& anchor) {
    auto client = knurl::Client::connect();
    std::vector<knurl::Claim> claims;
    for (int i = 0; i < 16; ++i)
        claims.push_back(client.claim("", {.shared = true, .representations = 1024}));
    while (leaving == 0) {
        for (knurl::Claim& claim : claims) {
            try {
                claim.add(knurl::Spring{.anchor = anchor, .stiffness = 1e-6});
            } catch (const knurl::Error&) {  // all slots are taken, or the cycle has no time left
            }
            claim.commit();
        }
        say_once();
    }
}

void adding(const knurl::Vec3& anchor) {
    auto client = knurl::Client::connect();
    std::vector<knurl::Claim> claims;
    for (int i = 0; i < 14; ++i) claims.push_back(client.claim("", {.shared = true, .representations = 256}));
    std::vector<std::vector<knurl::Handle<knurl::Spring>>> held(claims.size());
    while (leaving == 0) {
        for (std::size_t i = 0; i < claims.size(); ++i) {
            try {
                while (held[i].size() < 256)
                    held[i].push_back(claims[i].add(knurl::Spring{.anchor = anchor, .stiffness = 1e-6}));
            } catch (const knurl::Error&) {  // the channel is full
            }
            try {
                while (!held[i].empty()) {
                    held[i].back().remove();
                    held[i].pop_back();
                }
            } catch (const knurl::Error&) {  // the channel is full, or the spring was refused and never added
                if (!held[i].empty()) held[i].pop_back();
            }
            claims[i].commit();
        }
        say_once();
    }
}

knurl::Triangles grid_mesh(std::vector<knurl::Point3>& vertices, std::vector<knurl::Triangle>& triangles,
                           std::uint32_t n) {
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
            vertices.push_back({0.1 * i / n, 0.1 * j / n, -0.2 + 1e-3 * ((i * 7 + j * 3) % 5)});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            triangles.push_back({a, b, a + 1});
            triangles.push_back({b, b + 1, a + 1});
        }
    return {.vertices = vertices, .triangles = triangles};
}

void churn(std::mt19937& random) {
    auto client = knurl::Client::connect("knurl:default", {.wait = 1s});
    auto hand = client.claim("", {.shared = true, .representations = 256});
    for (unsigned i = 0; i < random() % 200; ++i) hand.add(knurl::Plane{.offset = -1, .stiffness = 100});
    hand.commit();
    if (random() % 8 == 0) {
        std::vector<knurl::Point3> vertices;
        std::vector<knurl::Triangle> triangles;
        auto sending = hand.begin_sending(grid_mesh(vertices, triangles, 150));
        hand.next_report(100ms);
    }
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGTERM, [](int) { leaving = 1; });
    if (argc != 4) {
        std::fputs("knurl_chaos_attacker: MODE SEED SOCKET\n", stderr);
        return 1;
    }
    const std::string mode = argv[1], socket = argv[3];
    std::mt19937 random(static_cast<unsigned>(std::stoul(argv[2])));
    while (leaving == 0) {
        try {
            if (mode == "holes")
                holes(random, socket);
            else if (mode == "lingering")
                lingering(random, socket);
            else if (mode == "waiting")
                waiting(socket);
            else if (mode == "springs")
                springs({0, 0, 0});
            else if (mode == "adding")
                adding({0, 0, 0});
            else if (mode == "churn")
                churn(random);
            else
                return 1;
        } catch (const std::exception&) {  // refused or disconnected, as an attacker may be
        }
        say_once();
    }
    return 0;
}

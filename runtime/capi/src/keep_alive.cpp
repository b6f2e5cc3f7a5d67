// One thread renews the claims that asked for it. It begins with the first of them and ends with the process.

#include <condition_variable>
#include <thread>

#include <knurl/link/clock.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/link/thread.hpp>

#include "objects.hpp"

namespace knurl::capi {

namespace {

// A fifth of the shortest silence of a claim (250 ms), so that one renewal may come late.
constexpr std::chrono::milliseconds every{50};

struct Renewer {
    std::mutex mutex;
    std::condition_variable wanted;
    std::vector<std::weak_ptr<HandObject>> hands;
};

/// False: the hand wants no renewal any more.
bool renew(HandObject& hand) {
    const std::int64_t grace = hand.grace_ns;
    if (grace < 0 || hand.closed) return false;
    const bool progresses = grace == 0 || detail::monotonic_ns() - hand.progress_ns < grace;
    // What fails here fails in the application's own calls, too, and is told there.
    if (progresses) call(nullptr, [&]() -> int { return hand.claim().keep_alive(), KNURL_OK; });
    return true;
}

void run(void* argument) {
    Renewer& renewer = *static_cast<Renewer*>(argument);
    std::vector<std::shared_ptr<HandObject>> now;
    for (;;) {
        {
            std::unique_lock lock(renewer.mutex);
            renewer.wanted.wait(lock, [&] { return !renewer.hands.empty(); });
            std::erase_if(renewer.hands, [&](const std::weak_ptr<HandObject>& each) {
                std::shared_ptr<HandObject> hand = each.lock();
                if (hand == nullptr || hand->grace_ns < 0 || hand->closed) return true;
                now.push_back(std::move(hand));
                return false;
            });
        }
        for (const std::shared_ptr<HandObject>& hand : now) renew(*hand);
        now.clear();
        std::this_thread::sleep_for(every);
    }
}

/// This process's; a fork's child has not its parent's thread.
Renewer& renewer() {
    static std::mutex making;
    static Renewer* current = nullptr;
    static std::uint64_t made_in = 0;
    const std::lock_guard lock(making);
    if (current == nullptr || made_in != detail::fork_generation()) {
        auto* fresh = new Renewer;  // never freed: its thread ends with the process
        detail::start_thread("knurl-alive", run, fresh);
        current = fresh;
        made_in = detail::fork_generation();
    }
    return *current;
}

}  // namespace

void keep_alive_from_now_on(const std::shared_ptr<HandObject>& hand) {
    Renewer& all = renewer();
    const std::lock_guard lock(all.mutex);
    for (const std::weak_ptr<HandObject>& each : all.hands)
        if (each.lock() == hand) return;
    all.hands.push_back(hand);
    all.wanted.notify_one();
}

}  // namespace knurl::capi

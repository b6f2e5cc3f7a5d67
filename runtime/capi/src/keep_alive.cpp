// One thread renews the claims that asked for it. It begins with the first of them and ends with the process.

#include <condition_variable>
#include <thread>

#include <knurl/link/clock.hpp>
#include <knurl/link/thread.hpp>

#include "objects.hpp"
#include "per_process.hpp"

namespace knurl::capi {

namespace {

// A fifth of the shortest silence of a claim (250 ms), so that one renewal may come late.
constexpr std::chrono::milliseconds every{50};

struct Renewer {
    std::mutex mutex;
    bool runs = false;
    std::condition_variable wanted;
    std::vector<std::weak_ptr<HandObject>> hands;
};

void renew(HandObject& hand) {
    const std::int64_t grace = hand.grace_ns;
    const bool progresses = grace == 0 || (grace > 0 && detail::monotonic_ns() - hand.progress_ns < grace);
    // What fails here fails in the application's own calls, too, and is told there.
    if (progresses && !hand.closed)
        call(nullptr, [&]() -> int { return hand.claim().keep_alive(), KNURL_OK; });
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

}  // namespace

void keep_alive_from_now_on(const std::shared_ptr<HandObject>& hand) {
    Renewer& all = of_this_process<Renewer>();
    const std::lock_guard lock(all.mutex);
    if (!all.runs) detail::start_thread("knurl-alive", run, &all);
    all.runs = true;
    for (const std::weak_ptr<HandObject>& each : all.hands)
        if (each.lock() == hand) return;
    all.hands.push_back(hand);
    all.wanted.notify_one();
}

}  // namespace knurl::capi

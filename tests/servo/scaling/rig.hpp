#pragma once
// A servo with its rings in shared memory, like knurld's; its cycles follow each other without a pause.

#include <memory>
#include <vector>

#include <knurl/servo/offline.hpp>
#include <knurl/shm/counters.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/waiter.hpp>

#include "../table_arm.hpp"

namespace knurl::servo::scaling {

class Rig {
  public:
    explicit Rig(double rate = 1000)
        : rate_(rate),
          memory_(shm::Segment::create("knurl-bench", protocol::device_layout().total)),
          servo_(arm_, clock_, memory_.data(), options(rate)) {}

    /// With room for so many representations; after one further cycle, which is done here, active with gain
    /// 1.
    OfflineClaim& claim(std::uint32_t representations) {
        ClaimTerms terms = next_terms();
        terms.capacity = {.representations = representations,
                          .batch_bytes = protocol::batch_bytes_for(representations)};
        segments_.push_back(
            shm::Segment::create("knurl-claim", protocol::claim_layout(terms.capacity).total));
        claims_.push_back(std::make_unique<OfflineClaim>(terms, segments_.back().data(), newest_row()));
        servo_.adopt(&claims_.back()->servo_side());
        step();
        return *claims_.back();
    }
    /// A reader of reports that is in the servo's table.
    void observer() {
        ClaimTerms terms = next_terms();
        terms.capacity = {.representations = 0, .batch_bytes = 0};
        terms.observer = true;
        segments_.push_back(
            shm::Segment::create("knurl-claim", protocol::claim_layout(terms.capacity).total));
        observers_.push_back(std::make_unique<Claim>(terms, segments_.back().data(), newest_row()));
        servo_.adopt(observers_.back().get());
        step();
    }

    /// What the loop does between two sleeps.
    void step() {
        now_ += static_cast<Nanoseconds>(1e9 / rate_);
        servo_.step(now_, now_);
        waker_.wake(servo_.wake_targets());
    }
    /// After 0.5 s changes are in force, and empty claims are quiet; after 4 s a claim without commits counts
    /// as silent.
    void settle(double seconds) {
        for (int i = 0; i < static_cast<int>(rate_ * seconds); ++i) step();
    }

    const std::vector<std::unique_ptr<OfflineClaim>>& claims() const { return claims_; }
    const shm::Segment& memory() const { return memory_; }
    const Report& last() const { return servo_.last(); }
    void record(InputLog* input_log) { servo_.record(input_log); }
    bool touching() const { return (servo_.last().flags & report_flags::touching) != 0; }
    std::uint64_t batches_taken() const {
        const shm::CountersReader counters(memory_.data() + protocol::device_layout().counters,
                                           protocol::count_names);
        return counters.read(static_cast<std::size_t>(protocol::Count::batches_taken));
    }

  private:
    static ServoOptions options(double rate) {
        ServoOptions o;
        o.rate = rate;
        o.start_active = true;
        return o;
    }
    ClaimTerms next_terms() const {
        ClaimTerms terms;
        terms.limits = limits_for(arm_.link(), rate_, terms.frame);
        terms.shared = true;
        return terms;
    }
    protocol::ClientRow* newest_row() {
        return reinterpret_cast<protocol::ClientRow*>(memory_.data() + protocol::device_layout().clients) +
               (segments_.size() - 1);
    }

    double rate_;
    Nanoseconds now_ = 0;
    TableArm arm_;
    MonotonicClock clock_;
    shm::Segment memory_;
    shm::Waker waker_;  // nobody waits: it checks, and has no thread
    Servo servo_;
    std::vector<shm::Segment> segments_;
    std::vector<std::unique_ptr<OfflineClaim>> claims_;
    std::vector<std::unique_ptr<Claim>> observers_;
};

}  // namespace knurl::servo::scaling

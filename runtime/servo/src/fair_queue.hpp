#pragma once
// A queue with several owners, which take turns: nobody waits for all jobs of another. A new owner, or one
// that was served and has more jobs, goes to the end of the line:
//
//   asked: A1 A2 A3 B1 C1 B2      served: A1 B1 C1 A2 B2 A3

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace knurl::servo {

template <class Job>
class FairQueue {
  public:
    void push(std::uint64_t owner, Job job) {
        const auto mine =
            std::find_if(line_.begin(), line_.end(), [owner](const Owner& o) { return o.name == owner; });
        Owner& here = mine != line_.end() ? *mine : line_.emplace_back(Owner{.name = owner, .jobs = {}});
        here.jobs.push_back(std::move(job));
    }
    std::optional<Job> pop() {
        if (line_.empty()) return std::nullopt;
        Owner first = std::move(line_.front());
        line_.pop_front();
        Job job = std::move(first.jobs.front());
        first.jobs.pop_front();
        if (!first.jobs.empty()) line_.push_back(std::move(first));
        return job;
    }
    template <class Match>
    void erase_if(Match match) {
        for (Owner& owner : line_) std::erase_if(owner.jobs, match);
        std::erase_if(line_, [](const Owner& owner) { return owner.jobs.empty(); });
    }
    bool empty() const noexcept { return line_.empty(); }

  private:
    struct Owner {
        std::uint64_t name;
        std::deque<Job> jobs;  // never empty
    };
    std::deque<Owner> line_;
};

}  // namespace knurl::servo

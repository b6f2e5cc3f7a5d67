#include "latency_load.hpp"

#include <cstring>
#include <functional>
#include <stdexcept>

#include <knurl/measure/measure.hpp>
#include <knurl/measure/sleeper.hpp>

namespace knurl::cli {

namespace {

void spin() {
    constexpr int a_round = 1 << 20;
    for (volatile int i = 0; i < a_round;) i = i + 1;
}

class Mover {
  public:
    void operator()() {
        std::memcpy(there_.data(), here_.data(), here_.size());
        there_.swap(here_);
    }

  private:
    static constexpr std::size_t bytes = 32 << 20;
    std::vector<char> here_ = std::vector<char>(bytes, 1), there_ = std::vector<char>(bytes);
};

}  // namespace

Load::Load(const std::string& kind) {
    if (kind == "none") return;
    if (kind != "spin" && kind != "memory") throw std::invalid_argument("no such load: " + kind);
    for (const unsigned cpu : measure::allowed_cpus())
        threads_.emplace_back([this, cpu, memory = kind == "memory"] {
            measure::settle_on(cpu, 0);
            const std::function<void()> once = memory ? std::function<void()>(Mover()) : spin;
            for (; !done_; ++rounds_) once();
        });
}

Load::~Load() {
    done_ = true;
    for (std::thread& thread : threads_) thread.join();
}

}  // namespace knurl::cli

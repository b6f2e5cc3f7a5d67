#pragma once
// Relacy runs a small program under the C++11 memory model, in thousands of random interleavings, on
// simulated memory. The rings are templates over their memory, so the tested code is the code that ships.
// Each model has wrong twins: the same code with one order weakened or one step left out. Each of them must
// fail, or the model proves nothing.

#include <cstdint>
#include <cstring>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <knurl/shm/broadcast_ring.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>
#include <knurl/shm/waiter.hpp>
// Last: it replaces new, free, assert and more by macros, which nothing here wants.
#include <relacy/relacy.hpp>
#undef new
#undef delete
#undef malloc
#undef calloc
#undef realloc
#undef free
#undef assert
#undef errno
#undef memory_order_relaxed
#undef memory_order_consume
#undef memory_order_acquire
#undef memory_order_release
#undef memory_order_acq_rel
#undef memory_order_seq_cst

namespace knurl::shm::model {

using Word = rl::atomic<std::uint64_t>;

inline rl::debug_info here() {
    return rl::debug_info("", "", 0);
}

inline rl::memory_order simulated(std::memory_order order) {
    switch (order) {
        case std::memory_order::relaxed:
            return rl::mo_relaxed;
        case std::memory_order::consume:
            return rl::mo_consume;
        case std::memory_order::acquire:
            return rl::mo_acquire;
        case std::memory_order::release:
            return rl::mo_release;
        case std::memory_order::acq_rel:
            return rl::mo_acq_rel;
        case std::memory_order::seq_cst:
            return rl::mo_seq_cst;
    }
    return rl::mo_seq_cst;
}

/// Where a reader may run into the writer by design (reports), the payload is atomic words.
struct AtomicPayload {
    using Payload = Word;
    static void put(Payload& to, std::uint64_t value, std::memory_order order) {
        to.store(value, simulated(order), here());
    }
    static std::uint64_t get(const Payload& from, std::memory_order order) {
        return from.load(simulated(order), here());
    }
};

/// Where the two sides must never meet in a slot, the payload is plain data: any meeting is a race that
/// Relacy reports.
struct PlainPayload {
    using Payload = rl::var<std::uint64_t>;
    static void put(Payload& to, std::uint64_t value, std::memory_order) { to(here()) = value; }
    static std::uint64_t get(const Payload& from, std::memory_order) { return from(here()); }
};

template <class Kind>
struct SimulatedMemory {
    using Word = model::Word;
    using Payload = typename Kind::Payload;

    static std::uint64_t load(const Word& word, std::memory_order order) {
        return word.load(simulated(order), here());
    }
    static void store(Word& word, std::uint64_t value, std::memory_order order) {
        word.store(value, simulated(order), here());
    }
    static std::uint64_t exchange(Word& word, std::uint64_t value, std::memory_order order) {
        return word.exchange(value, simulated(order), here());
    }
    static bool compare_exchange(Word& word, std::uint64_t& expected, std::uint64_t value,
                                 std::memory_order order) {
        return word.compare_exchange_strong(expected, value, simulated(order), here(), rl::mo_relaxed,
                                            here());
    }
    static void fence(std::memory_order order) {
        if (order != std::memory_order::relaxed) rl::atomic_thread_fence(simulated(order), here());
    }
    static void prefetch(const Payload*, std::size_t) {}
    static void store_payload(Payload* to, const void* from, std::size_t words, std::memory_order order) {
        for (std::size_t i = 0; i < words; ++i) {
            std::uint64_t value;
            std::memcpy(&value, static_cast<const std::byte*>(from) + i * sizeof value, sizeof value);
            Kind::put(to[i], value, order);
        }
    }
    static void load_payload(void* to, const Payload* from, std::size_t words, std::memory_order order) {
        for (std::size_t i = 0; i < words; ++i) {
            const std::uint64_t value = Kind::get(from[i], order);
            std::memcpy(static_cast<std::byte*>(to) + i * sizeof value, &value, sizeof value);
        }
    }
};

/// A claim of a model about the interleaving that is running.
inline void require(bool holds) {
    RL_ASSERT(holds);
}

/// Keeps the beginning of what is printed. Allocates nothing meanwhile: while a model runs, Relacy owns
/// operator new.
class Excerpt : public std::streambuf {
  public:
    Excerpt() : text_(20000) { setp(text_.data(), text_.data() + text_.size()); }
    std::string str() const { return {pbase(), pptr()}; }

  protected:
    int_type overflow(int_type c) override { return traits_type::not_eof(c); }  // the rest is dropped

  private:
    std::vector<char> text_;
};

/// Runs the model; the interleavings are numbered and the same each time. Empty, or the history that went
/// wrong.
template <class Model>
std::string counterexample(unsigned interleavings) {
    Excerpt excerpt;
    std::ostream output(&excerpt);
    rl::test_params params;
    params.iteration_count = interleavings;
    params.output_stream = &output;
    params.progress_stream = &output;
    params.progress_output_period = 1000;
    params.execution_depth_limit = 100000;
    if (rl::simulate<Model>(params)) return {};
    return "interleaving " + std::to_string(params.stop_iteration) + ": " +
           rl::test_result_str(params.test_result) + "\n" + excerpt.str();
}

inline constexpr unsigned interleavings = 300000;

template <class Model>
void expect_holds() {
    EXPECT_EQ(counterexample<Model>(interleavings), "");
}
template <class Twin>
void expect_found_wrong() {
    EXPECT_NE(counterexample<Twin>(interleavings), "") << "the model cannot see this mistake";
}

}  // namespace knurl::shm::model

#include <cstring>
#include <new>
#include <stdexcept>

#include <sys/mman.h>

#include "transport.hpp"

namespace knurl::shm::peers {

struct Inbox::Address {
    std::atomic<bool> there = false;  // release after the text, acquire before it is read
    char text[240] = {};
};

Inbox::Inbox(std::size_t most) : most_(most) {
    const std::size_t bytes = sizeof(Address) + (most + 1) * sizeof(std::atomic<Nanoseconds>);
    memory_ =
        ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
    if (memory_ == MAP_FAILED) throw std::runtime_error("no memory to share with a receiver");
    address_ = new (memory_) Address;
    auto* const after = static_cast<std::byte*>(memory_) + sizeof(Address);
    took_ = reinterpret_cast<std::atomic<Nanoseconds>*>(after);
    for (std::size_t i = 0; i <= most; ++i) new (&took_[i]) std::atomic<Nanoseconds>(0);
}

Inbox::~Inbox() {
    ::munmap(memory_, sizeof(Address) + (most_ + 1) * sizeof(std::atomic<Nanoseconds>));
}

void Inbox::announce(const std::string& address) {
    if (address.size() >= sizeof address_->text) throw std::runtime_error(address + " is too long");
    std::memcpy(address_->text, address.c_str(), address.size() + 1);
    address_->there.store(true, std::memory_order::release);
}

std::string Inbox::announced() const {
    constexpr Nanoseconds patience = 10'000'000'000, pause = 1'000'000;
    for (const Nanoseconds begin = now_ns(); !address_->there.load(std::memory_order::acquire);) {
        if (now_ns() - begin > patience) throw std::runtime_error("its receiver does not start");
        measure::sleep_until(now_ns() + pause);
    }
    return address_->text;
}

}  // namespace knurl::shm::peers

#include "handles.hpp"

#include <algorithm>

#include <knurl/link/fork_guard.hpp>

#include "per_process.hpp"

namespace knurl::capi {

namespace {

constexpr int type_bits = 4, place_bits = 24, use_bits = 28;

struct Parts {
    std::uint64_t fork, uses, place, type;
};

std::uint64_t low(std::uint64_t value, int bits) {
    return value & ((std::uint64_t{1} << bits) - 1);
}

Parts parts_of(const void* handle) {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    return {.fork = number >> (type_bits + place_bits + use_bits),
            .uses = low(number >> (type_bits + place_bits), use_bits),
            .place = low(number >> type_bits, place_bits),
            .type = low(number, type_bits)};
}

const char* name_of(std::uint64_t type) {
    switch (static_cast<Type>(type)) {
        case Type::client:
            return "a client";
        case Type::hand:
            return "a hand";
        case Type::sending:
            return "a sending";
        case Type::offline:
            return "an offline servo";
    }
    return "nothing";
}

std::uint64_t fork_byte() {
    return low(detail::fork_generation(), 8);
}

[[noreturn]] void refuse(const void* handle) {
    if (handle == nullptr)
        throw Failed(KNURL_BAD_HANDLE, "the handle is NULL: it was closed, or no call has filled it in");
    const Parts parts = parts_of(handle);
    const std::string named = name_of(parts.type);
    if (named == "nothing" || parts.place == 0)
        throw Failed(KNURL_BAD_HANDLE,
                     "this pointer is no handle of Knurl; give one that a call has filled in");
    if (parts.fork != fork_byte())
        throw Failed(KNURL_AFTER_FORK, named + " of a process before its fork; connect in the child anew");
    throw Failed(KNURL_BAD_HANDLE, named + " that was closed");
}

}  // namespace

void* Handles::add(std::shared_ptr<Object> object) {
    const std::lock_guard lock(mutex_);
    // Else it would outlive the parent that another thread has closed since.
    if (object->parent != nullptr && at(object->parent) == nullptr) refuse(object->parent);
    if (free_.empty()) {
        if (places_.size() + 1 >= std::size_t{1} << place_bits) throw std::bad_alloc();
        free_.reserve(places_.size() + 1);  // so that take() never allocates
        places_.emplace_back();
        free_.push_back(static_cast<std::uint32_t>(places_.size() - 1));
    }
    const std::uint32_t place = free_.back();
    free_.pop_back();
    places_[place].object = std::move(object);
    ++places_[place].uses;
    return handle_of(place);
}

void* Handles::handle_of(std::uint32_t place) const {
    const Place& at = places_[place];
    const std::uint64_t above = fork_byte() << use_bits | low(at.uses, use_bits);
    return reinterpret_cast<void*>((above << place_bits | (place + std::uint64_t{1})) << type_bits |
                                   static_cast<std::uint64_t>(at.object->type));
}

std::shared_ptr<Object> Handles::at(const void* handle) {
    const Parts parts = parts_of(handle);
    if (parts.place == 0 || parts.place > places_.size() || parts.fork != fork_byte()) return nullptr;
    const Place& place = places_[parts.place - 1];
    if (place.object == nullptr || low(place.uses, use_bits) != parts.uses) return nullptr;
    return static_cast<std::uint64_t>(place.object->type) == parts.type ? place.object : nullptr;
}

std::shared_ptr<Object> Handles::find(const void* handle) {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<Object> found = at(handle);
    if (found == nullptr) refuse(handle);
    return found;
}

std::shared_ptr<Object> Handles::find(const void* handle, Type type) {
    std::shared_ptr<Object> found = find(handle);
    if (found->type != type)
        throw Failed(KNURL_BAD_HANDLE, std::string("this is ") +
                                           name_of(static_cast<std::uint64_t>(found->type)) + "; give " +
                                           name_of(static_cast<std::uint64_t>(type)));
    return found;
}

std::vector<std::shared_ptr<Object>> Handles::take(const void* handle) {
    std::vector<std::shared_ptr<Object>> taken;
    const std::lock_guard lock(mutex_);
    if (at(handle) == nullptr) refuse(handle);
    std::vector<std::uint32_t> leaving{static_cast<std::uint32_t>(parts_of(handle).place - 1)};
    // Children, and theirs: a place may have been used before, so a child may stand before its parent.
    for (std::size_t next = 0; next < leaving.size(); ++next) {
        const void* const parent = handle_of(leaving[next]);
        for (std::uint32_t i = 0; i < places_.size(); ++i)
            if (places_[i].object != nullptr && places_[i].object->parent == parent) leaving.push_back(i);
    }
    for (const std::uint32_t place : leaving) {
        taken.push_back(std::move(places_[place].object));
        taken.back()->closed = true;
        free_.push_back(place);
    }
    return taken;
}

Handles& handles() {
    return of_this_process<Handles>();
}

}  // namespace knurl::capi

#pragma once
// Handles: numbers in the guise of pointers, looked up in each call, so that a stale one is refused and never
// followed.
//
//   bits 63..56  fork generation (its low byte): a child's table is another one
//   bits 55..28  how often the place was used
//   bits 27..4   place + 1
//   bits  3..0   type; odd, so that no allocator gives such an address
//
// A call holds the object while it runs. knurl_close takes it out of the table, and wakes calls that wait.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <knurl/client/client.hpp>

#include "call.hpp"

namespace knurl::capi {

enum class Type : std::uint8_t { client = 1, hand = 3, sending = 5, offline = 7 };

struct Object {
    explicit Object(Type t) : type(t) {}
    virtual ~Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    /// Calls that wait return; called once, without the table's lock.
    virtual void close() noexcept {}

    const Type type;
    const void* parent = nullptr;  // closed with it
    std::atomic<bool> closed{false};
};

class Handles {
  public:
    /// Gives it a handle. Throws Failed where its parent was closed meanwhile, std::bad_alloc.
    void* add(std::shared_ptr<Object> object);
    /// Throws Failed: no such handle, or of another type.
    std::shared_ptr<Object> find(const void* handle, Type type);
    std::shared_ptr<Object> find(const void* handle);
    /// Takes it out, and all whose parent it is. Throws Failed.
    std::vector<std::shared_ptr<Object>> take(const void* handle);

  private:
    struct Place {
        std::uint64_t uses = 0;
        std::shared_ptr<Object> object;
    };
    std::shared_ptr<Object> at(const void* handle);  // the lock held
    void* handle_of(std::uint32_t place) const;      // the lock held

    std::mutex mutex_;
    std::vector<Place> places_;
    std::vector<std::uint32_t> free_;
};

/// This process's: the child of a fork begins with an empty one.
Handles& handles();

/// The object behind a handle. Throws Failed.
template <class T>
std::shared_ptr<T> object(const void* handle) {
    return std::static_pointer_cast<T>(handles().find(handle, T::its_type));
}

/// Runs `body` with the object behind `handle`. What fails since another thread has closed it says so.
template <class T, class Body>
int with(const void* handle, Body&& body) noexcept {
    return call(handle, [&]() -> int {
        const std::shared_ptr<T> found = object<T>(handle);
        try {
            return body(*found);
        } catch (const Error& error) {
            if (!found->closed) throw;
            throw Failed(KNURL_BAD_HANDLE,
                         std::string("closed by another thread meanwhile: ") + error.what());
        }
    });
}

}  // namespace knurl::capi

#pragma once
// What every function of the C interface does: an exception becomes a code and one line, of the calling
// thread.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <knurl.h>

#include <knurl/link/error.hpp>
#include <knurl/reps/bounds.hpp>
#include <knurl/reps/scene.hpp>

#include "layout.hpp"

namespace knurl::capi {

/// What a function returns, with its line.
struct Failed : std::runtime_error {
    Failed(int with, const std::string& text) : std::runtime_error(text), code(with) {}
    int code;
};

/// Keeps the line for knurl_error(handle). Returns `code`.
int failed(int code, const void* handle, const char* text, std::int32_t holder = 0) noexcept;
int code_of(Error::Kind kind) noexcept;
/// The line of the last call of this thread that failed.
const char* last_line() noexcept;
/// The line of the last call of this thread that failed with that handle.
const char* line_of(const void* handle) noexcept;
/// The process that held the device, after device_held; 0: not known.
std::int32_t last_holder() noexcept;
/// The library's.
inline constexpr const char* version = KNURL_VERSION;

/// Runs `body`, which returns a code. What it throws is the line of `handle`.
template <class Body>
int call(const void* handle, Body&& body) noexcept {
    try {
        return std::forward<Body>(body)();
    } catch (const Error& error) {
        return failed(code_of(error.kind), handle, error.what(), error.holder);
    } catch (const Failed& error) {
        return failed(error.code, handle, error.what());
    } catch (const std::bad_alloc&) {
        return failed(KNURL_NO_MEMORY, handle, "no memory");
    } catch (const std::exception& error) {
        return failed(KNURL_UNKNOWN, handle, error.what());
    } catch (...) {
        return failed(KNURL_UNKNOWN, handle, "an exception of a foreign type");
    }
}

/// Throws Failed.
void require_pointer(const void* pointer, const char* what);
/// A size that a struct of this library may have. Throws Failed.
void require_size(std::uint64_t size, std::size_t least, const char* what);
/// Checks the size that a struct of the caller's begins with: at least `least`; what is beyond `known` is 0.
/// Throws Failed.
void require_size(const void* given, std::size_t least, std::size_t known, const char* what);

/// A struct of the caller's as this library knows it. `defaults` stand for members that the caller's has not.
template <class T>
T read_struct(const T* given, const T& defaults, const char* what) {
    if (given == nullptr) return defaults;
    require_size(given, sizeof(T), sizeof(T), what);
    T result = defaults;
    std::memcpy(static_cast<void*>(&result), given, std::min<std::size_t>(given->size, sizeof(T)));
    return result;
}

/// Throws Failed unless there is room for the answer.
template <class T>
void require_room(const T* out, const char* what) {
    require_pointer(out, what);
    require_size(out, sizeof(T), ~std::size_t{0}, what);
}
/// The answer, as much of it as the caller knows.
template <class T>
void write_struct(T* out, T value) {
    value.size = out->size;
    std::memcpy(static_cast<void*>(out), &value, std::min<std::size_t>(out->size, sizeof(T)));
}

knurl_add_options default_add_options();
/// Throws Failed.
AddOptions add_options_of(const knurl_add_options* options);

/// The layout of the kind; throws Failed if there is none.
const Layout& layout_of(std::uint32_t kind);
/// Parameters of the caller, of any kind.
class Parameters {
  public:
    Parameters(std::uint32_t kind, const void* given);
    std::span<const std::byte> bytes() const { return {at_, size_}; }

  private:
    alignas(8) std::byte at_[max_parameter_bytes];
    std::size_t size_;
};

}  // namespace knurl::capi

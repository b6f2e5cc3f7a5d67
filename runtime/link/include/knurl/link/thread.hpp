#pragma once

/// @file
/// A thread of the library's own in somebody else's process.

#include <pthread.h>

namespace knurl::detail {

/// Runs `body(argument)`. The application's signals are the application's threads' business, so this one
/// takes none; its stack is small, since an application may lock all its memory. `name`: 15 letters at most.
/// Throws Error::refused.
pthread_t start_thread(const char* name, void (*body)(void*), void* argument);

}  // namespace knurl::detail

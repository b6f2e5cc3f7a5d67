#include <csignal>
#include <memory>

#include <knurl/link/error.hpp>
#include <knurl/link/text.hpp>
#include <knurl/link/thread.hpp>

namespace knurl::detail {

namespace {

constexpr std::size_t stack_bytes = 256 * 1024;

struct Work {
    void (*body)(void*);
    void* argument;
};

void* work(void* stated) {
    const Work given = *std::unique_ptr<Work>(static_cast<Work*>(stated));
    given.body(given.argument);
    return nullptr;
}

}  // namespace

pthread_t start_thread(const char* name, void (*body)(void*), void* argument) {
    auto given = std::make_unique<Work>(Work{body, argument});
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, stack_bytes);
    // A thread inherits the mask, so no signal can ever reach it.
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    pthread_t thread{};
    const int error = ::pthread_create(&thread, &attributes, work, given.get());
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    ::pthread_attr_destroy(&attributes);
    if (error != 0)
        throw Error(Error::Kind::refused,
                    detail::format("no thread \"{}\"; see the limit of processes (ulimit -u)", name));
    given.release();  // the thread owns it
    ::pthread_setname_np(thread, name);
    return thread;
}

}  // namespace knurl::detail

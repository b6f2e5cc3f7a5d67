// umockdev's preload: how a test starts under it, and what it needs to survive a fork.

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <dlfcn.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "bus.hpp"

namespace knurl::drivers::usb_emulator {

namespace {

constexpr const char* preload = "libumockdev-preload.so.0";

void with_preload_locks(int (*what)(pthread_mutex_t*)) {
    for (const char* name : {"ioctl_lock", "trap_path_lock"})
        if (void* const lock = dlsym(RTLD_DEFAULT, name)) what(static_cast<pthread_mutex_t*>(lock));
}

}  // namespace

void start_under_umockdev(int, char** argv) {
    prctl(PR_SET_TIMERSLACK, 1UL);  // the preload yields with usleep(0): 50 us each with the ordinary slack
    const char* loaded = std::getenv("LD_PRELOAD");
    if (loaded != nullptr && std::strstr(loaded, preload) != nullptr) {
        // The preload takes these locks around every open(), also of threads without USB. A fork meanwhile
        // would leave them locked in the child for ever, and its first open() would block. Registered before
        // any other handler, so that it runs first in the child.
        pthread_atfork([] { with_preload_locks(pthread_mutex_lock); },
                       [] { with_preload_locks(pthread_mutex_unlock); },
                       [] { with_preload_locks(pthread_mutex_unlock); });
        return;
    }
    const std::string both =
        loaded != nullptr && *loaded != 0 ? std::string(loaded) + ":" + preload : preload;
    setenv("LD_PRELOAD", both.c_str(), 1);
    // The sanitizer wants to be first; it also works behind the preload.
    const char* asan = std::getenv("ASAN_OPTIONS");
    setenv("ASAN_OPTIONS",
           ((asan != nullptr ? std::string(asan) + ":" : "") + "verify_asan_link_order=0").c_str(), 1);
    execv("/proc/self/exe", argv);
    std::perror("cannot start again under umockdev");
    std::exit(1);
}

}  // namespace knurl::drivers::usb_emulator

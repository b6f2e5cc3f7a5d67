// Preloaded before umockdev's library, for a guardian that was passed the node of a device that was plugged
// in again. A kernel knows the open file behind a descriptor from a socket. umockdev's preload knows only
// what its own process has opened, and lets the call through to the pipe that represents the node. Here such
// a call opens the node that the descriptor names, under the mock, and is repeated there.
//
// The mock then sees another opener, so the servo's claim must have ended with the servo; its requests in
// flight end with it too (a kernel would keep both for the guardian's copy).

#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <unistd.h>

extern "C" int ioctl(int fd, unsigned long request, ...) noexcept {
    va_list arguments;
    va_start(arguments, request);
    void* const argument = va_arg(arguments, void*);
    va_end(arguments);
    static const auto next = reinterpret_cast<int (*)(int, unsigned long, void*)>(dlsym(RTLD_NEXT, "ioctl"));
    const int result = next(fd, request, argument);
    if (request != USBDEVFS_BULK || result >= 0 || errno != ENOTTY) return result;

    char link[64], path[PATH_MAX] = {};
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const char* root = std::getenv("UMOCKDEV_DIR");
    if (root == nullptr || readlink(link, path, sizeof path - 1) < 0 ||
        std::strncmp(path, root, std::strlen(root)) != 0)
        return result;
    const int node = open(path + std::strlen(root), O_RDWR | O_CLOEXEC);
    if (node < 0) return result;
    constexpr timespec pause{.tv_sec = 0, .tv_nsec = 100'000};
    constexpr int tries = 1000;
    int again = -1;
    for (int i = 0; i < tries && again < 0; ++i) {
        again = next(node, request, argument);
        if (again >= 0 || errno != EBUSY) break;
        nanosleep(&pause, nullptr);  // until the mock has noticed the servo's end
    }
    const int error = errno;
    close(node);
    errno = error;
    return again;
}

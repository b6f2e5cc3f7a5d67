// Any bytes as a keys file: valid keys, or one line that says what is wrong.

#include <stdexcept>
#include <string>

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "streams.hpp"

using namespace knurl;
using namespace knurl::bridge;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const knurl::shm::UniqueFd fd(::memfd_create("keys", MFD_CLOEXEC));
    ::fchmod(fd.get(), 0600);
    fuzz::require(::write(fd.get(), data, size) == static_cast<ssize_t>(size));
    try {
        for (const Key& key : read_keys("/proc/self/fd/" + std::to_string(fd.get())))
            fuzz::require(!key.name.empty() && key.name.size() <= max_key_name && role_name(key.role) != "?");
    } catch (const std::runtime_error& error) {
        const std::string text = error.what();
        fuzz::require(!text.empty());
    }
    return 0;
}

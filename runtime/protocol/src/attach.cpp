#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>

#include <unistd.h>

#include <knurl/protocol/asset.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/device_segment.hpp>

namespace knurl::protocol {

namespace {

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) noexcept {
    // FNV-1a over the eight bytes of the value.
    for (int i = 0; i < 8; ++i) {
        hash = (hash ^ ((value >> (8 * i)) & 0xff)) * 0x100000001b3;
    }
    return hash;
}

const char* environment(const char* name) {
    const char* value = std::getenv(name);
    return value != nullptr && *value != '\0' ? value : nullptr;
}

}  // namespace

std::uint64_t wire_hash() noexcept {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (std::uint64_t value :
         {std::uint64_t{protocol_version}, std::uint64_t{sizeof(Hello)}, std::uint64_t{sizeof(Welcome)},
          std::uint64_t{sizeof(Refused)}, std::uint64_t{sizeof(ClaimRequest)}, std::uint64_t{sizeof(Claimed)},
          std::uint64_t{sizeof(Mapped)}, std::uint64_t{sizeof(Serving)}, std::uint64_t{sizeof(RecordRequest)},
          std::uint64_t{sizeof(Recording)}, std::uint64_t{sizeof(WatchRequest)},
          std::uint64_t{sizeof(Watching)}, std::uint64_t{sizeof(ShowAsset)},
          std::uint64_t{sizeof(ShownAsset)}, std::uint64_t{sizeof(AssetSource)},
          std::uint64_t{sizeof(AssetOffer)}, std::uint64_t{sizeof(AssetReady)},
          std::uint64_t{sizeof(AssetForget)}, std::uint64_t{sizeof(RecordedAsset)},
          std::uint64_t{sizeof(CommandHeader)}, std::uint64_t{sizeof(AddBody)},
          std::uint64_t{sizeof(PlaceProbeBody)}, std::uint64_t{sizeof(Reply)},
          std::uint64_t{sizeof(BatchHeader)}, std::uint64_t{sizeof(EntryHeader)},
          std::uint64_t{sizeof(FeedbackHeader)}, std::uint64_t{sizeof(FeedbackEntry)},
          std::uint64_t{sizeof(Report)}, std::uint64_t{sizeof(DeviceInfo)}, std::uint64_t{sizeof(ClientRow)},
          std::uint64_t{offsetof(ClientRow, present)}, std::uint64_t{sizeof(shm::WaiterFlag)},
          std::uint64_t{offsetof(shm::WaiterFlag, sent)},
          // `total` alone may hide a move behind padding, so offsets count too.
          static_cast<std::uint64_t>(Count::size_), std::uint64_t{device_layout().clients},
          std::uint64_t{device_layout().reports}, std::uint64_t{device_layout().total},
          std::uint64_t{claim_layout({}).total}, layout_hash()}) {
        hash = mix(hash, value);
    }
    return hash;
}

namespace {
constexpr const char* system_directory = "/run/knurl";
}

std::string runtime_directory() {
    if (const char* stated = environment("KNURL_RUNTIME_DIR")) {
        return stated;
    }
    if (geteuid() == 0) {
        return system_directory;
    }
    if (const char* session = environment("XDG_RUNTIME_DIR")) {
        return std::string(session) + "/knurl";
    }
    throw std::runtime_error(
        "no directory for the servo's socket: XDG_RUNTIME_DIR is not set; set KNURL_RUNTIME_DIR to a "
        "directory of yours");
}

std::string socket_path(const std::string& servo_name) {
    return runtime_directory() + "/" + servo_name + ".sock";
}

std::vector<std::string> servo_directories() {
    if (environment("KNURL_RUNTIME_DIR") != nullptr || geteuid() == 0) return {runtime_directory()};
    std::vector<std::string> found;
    if (environment("XDG_RUNTIME_DIR") != nullptr) found.push_back(runtime_directory());
    found.emplace_back(system_directory);
    return found;
}

std::string servo_socket(const std::string& servo_name) {
    const std::vector<std::string> directories = servo_directories();
    for (const std::string& directory : directories) {
        const std::string path = directory + "/" + servo_name + ".sock";
        // A path without permission must be reported, not skipped.
        if (access(path.c_str(), F_OK) == 0 || errno == EACCES) return path;
    }
    return directories.front() + "/" + servo_name + ".sock";
}

std::string state_directory() {
    if (const char* stated = environment("KNURL_STATE_DIR")) {
        return stated;
    }
    if (geteuid() == 0) {
        return "/var/lib/knurl";
    }
    if (const char* session = environment("XDG_STATE_HOME")) {
        return std::string(session) + "/knurl";
    }
    if (const char* home = environment("HOME")) {
        return std::string(home) + "/.local/state/knurl";
    }
    throw std::runtime_error("no directory for saved state: set KNURL_STATE_DIR to a directory of yours");
}

}  // namespace knurl::protocol

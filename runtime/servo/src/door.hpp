#pragma once
// The name under which a servo is found.

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <grp.h>
#include <unistd.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/servo/broker.hpp>
#include <knurl/servo/closer.hpp>
#include <knurl/servo/config.hpp>
#include <knurl/shm/fd.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::servo {

/// The listening socket and its name in the file system, which lives as long as this object.
class Door {
  public:
    Door(const std::string& servo_name, const std::string& group, Closer& closer)
        : path_(protocol::socket_path(servo_name)), closer_(closer) {
        const std::filesystem::path directory = std::filesystem::path(path_).parent_path();
        std::error_code failed;
        if (std::filesystem::create_directories(directory, failed)) {
            using std::filesystem::perms;  // the mode of the socket itself says who may connect
            std::filesystem::permissions(directory,
                                         perms::owner_all | perms::group_read | perms::group_exec |
                                             perms::others_read | perms::others_exec,
                                         failed);
        }
        if (failed) {
            throw std::runtime_error(
                fmt::format("{}: cannot make this directory for the socket ({}); set "
                            "KNURL_RUNTIME_DIR to one of yours",
                            directory.string(), failed.message()));
        }
        socket_ = shm::listen_at(path_, 0660, broker_bounds::listen_backlog);
        if (group.empty()) return;
        const ::group* found = getgrnam(group.c_str());
        if (found == nullptr || chown(path_.c_str(), static_cast<uid_t>(-1), found->gr_gid) != 0) {
            const std::string why = found == nullptr
                                        ? "no such group; make it: sudo groupadd " + group
                                        : std::string(std::strerror(errno)) + "; be a member of it";
            unlink(path_.c_str());
            throw ConfigError(fmt::format("socket_group = \"{}\": {}", group, why));
        }
    }
    // The socket listens until its name is removed. A successor that starts in between finds a live socket.
    // Else it would take the socket for a dead one, and this unlink would remove the successor's.
    ~Door() {
        unlink(path_.c_str());
        closer_.close(std::move(socket_));  // callers that were not answered may have sent descriptors
    }
    Door(const Door&) = delete;
    Door& operator=(const Door&) = delete;

    const std::string& path() const { return path_; }
    shm::UniqueFd& socket() { return socket_; }

  private:
    std::string path_;
    Closer& closer_;
    shm::UniqueFd socket_;
};

}  // namespace knurl::servo

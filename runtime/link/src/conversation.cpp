#include "conversation.hpp"

#include <cerrno>
#include <optional>

#include <grp.h>
#include <poll.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <knurl/link/text.hpp>
#include <knurl/protocol/servo_address.hpp>

namespace knurl::detail {

namespace {

/// The socket exists but this process may not open it: whose it is, and what to do.
std::optional<std::string> forbidden(const std::string& path) {
    if (::access(path.c_str(), R_OK | W_OK) == 0 || errno != EACCES) return std::nullopt;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        return detail::format(
            "not allowed to look into the folder of {}; run as its owner, or set KNURL_RUNTIME_DIR to "
            "the folder of your own servo",
            path);
    const passwd* owner = ::getpwuid(status.st_uid);
    const group* owners = ::getgrgid(status.st_gid);
    const std::string group_name = owners != nullptr ? owners->gr_name : std::to_string(status.st_gid);
    return detail::format(
        "not allowed to open {} (owner {}, group {}, mode {:o}); join the group (`sudo usermod -aG {} "
        "$USER`, then log in again) or start a servo of your own",
        path, owner != nullptr ? owner->pw_name : std::to_string(status.st_uid), group_name,
        status.st_mode & 0777u, group_name);
}

[[noreturn]] void no_answer(const std::string& servo, std::chrono::milliseconds waited) {
    throw Error(Error::Kind::no_servo,
                detail::format(
                    "servo '{}' does not answer (waited {} ms): is it stopped? `knurl ls` shows its process",
                    servo, waited.count()));
}

shm::UniqueFd connected(const std::string& servo, std::chrono::milliseconds answer_time) {
    const auto [name, path] = protocol::servo_address(servo);
    if (const auto reason = forbidden(path)) throw Error(Error::Kind::permission, *reason);
    shm::UniqueFd socket;
    try {
        socket = shm::connect_to(path, answer_time);
    } catch (const shm::SystemError& error) {
        if (error.error == EAGAIN) no_answer(servo, answer_time);  // its queue of callers is full
        // An error that a starting servo would not cure is reported at once.
        if (error.error != ENOENT && error.error != ECONNREFUSED)
            throw Error(Error::Kind::exhausted, error.what());
        throw Error(Error::Kind::no_servo,
                    detail::format("no servo '{}' listens at {}; start one with `knurld --name {} --device "
                                   "sim:premium15`, or see with `knurl ls` which ones run",
                                   name, path, name));
    }
    return socket;
}

}  // namespace

Conversation::Conversation(std::string servo, std::chrono::milliseconds answer_time)
    : servo_(std::move(servo)),
      answer_time_(answer_time),
      socket_(connected(servo_, answer_time_)),
      lost_in_child_(socket_.get()) {}

std::pair<protocol::Welcome, std::vector<shm::UniqueFd>> Conversation::greet(const std::string& client_name) {
    protocol::Hello hello;
    hello.layout = protocol::wire_hash();
    protocol::put_text(hello.client, client_name);
    // A full servo answers before the greeting and hangs up: its answer counts, not the failed send.
    shm::send_message(socket_, std::as_bytes(std::span(&hello, 1)));
    auto answer = receive<protocol::Welcome>(protocol::MessageType::welcome, Error::Kind::incompatible);
    if (answer.first.devices > protocol::max_devices || answer.second.size() != answer.first.devices)
        nonsense();
    return answer;
}

void Conversation::wait() {
    pollfd ready{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    int answers = 0;
    do {
        answers = ::poll(&ready, 1, static_cast<int>(answer_time_.count()));
    } while (answers < 0 && errno == EINTR);
    if (answers <= 0) {
        // A late answer must never count as the next request's, so this connection ends.
        ::shutdown(socket_.get(), SHUT_RDWR);
        no_answer(servo_, answer_time_);
    }
}

void Conversation::gone() const {
    throw Error(Error::Kind::disconnected,
                detail::format("servo '{}' has gone while it was asked; start it again", servo_));
}

void Conversation::no_descriptors() const {
    throw Error(
        Error::Kind::exhausted,
        detail::format("servo '{}' answers, but this process has no descriptor left for the memory that "
                       "it sends; raise the limit (ulimit -n)",
                       servo_));
}

void Conversation::nonsense() const {
    throw Error(Error::Kind::incompatible,
                detail::format(
                    "what answers as servo '{}' is not of this version (protocol {}, layout {:016x}); build "
                    "the application and the servo from the same version",
                    servo_, protocol::protocol_version, protocol::wire_hash()));
}

}  // namespace knurl::detail

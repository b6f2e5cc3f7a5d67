#include <array>
#include <cerrno>
#include <span>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <knurl/dds/registry.hpp>
#include <knurl/protocol/name.hpp>
#include <knurl/protocol/registry.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::dds {

namespace {

constexpr std::chrono::milliseconds patience{
    250};  // with a caller that neither asks nor reads; all others wait
constexpr mode_t for_owner_and_group = 0660;
constexpr int backlog = 32;

bool wait_for(int fd, short event) {
    pollfd asked{.fd = fd, .events = event, .revents = 0};
    return ::poll(&asked, 1, static_cast<int>(patience.count())) > 0;
}

bool tell(int connection, const std::string& text) {
    return wait_for(connection, POLLOUT) && shm::send_message(connection, std::as_bytes(std::span(text)));
}

}  // namespace

RegistryDoor::RegistryDoor(const Registry& registry, const std::string& path, std::uint32_t domain,
                           const std::string& name)
    : registry_(registry),
      path_(path),
      hello_(fmt::format("knurl-registry 1 {} {}", domain, name)),
      listener_(shm::listen_at(path, for_owner_and_group, backlog)),
      stop_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      thread_([this] { serve(); }) {}

RegistryDoor::~RegistryDoor() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_.get(), &one, sizeof one);
    thread_.join();
    ::unlink(path_.c_str());
}

void RegistryDoor::serve() {
    for (;;) {
        std::array<pollfd, 2> events{{{.fd = stop_.get(), .events = POLLIN, .revents = 0},
                                      {.fd = listener_.get(), .events = POLLIN, .revents = 0}}};
        if (::poll(events.data(), events.size(), -1) < 0 && errno != EINTR) return;
        if (events[0].revents != 0) return;
        try {
            if (const shm::UniqueFd connection = shm::accept_from(listener_)) answer(connection.get());
        } catch (const std::exception&) {  // no descriptor is left: the caller sees a hang-up
        }
    }
}

void RegistryDoor::answer(int connection) const {
    constexpr std::string_view resolve = "resolve ";
    if (!tell(connection, hello_) || !wait_for(connection, POLLIN)) return;
    std::array<std::byte, 512> bytes{};
    const shm::Received got = shm::receive_plain_message(connection, bytes);
    if (got.closed || got.nothing || got.truncated || got.carries_descriptors) return;
    const std::string request(reinterpret_cast<const char*>(bytes.data()), got.bytes);
    if (request.starts_with(resolve)) {
        tell(connection, registry_.resolve(request.substr(resolve.size())));
    } else if (request == "list") {
        for (const ServoEntry& servo : registry_.servos())
            if (!tell(connection, json_of(servo))) return;
        tell(connection, ".");
    } else {
        tell(connection, "? a registry is asked 'resolve NAME' or 'list'");
    }
}

}  // namespace knurl::dds

#pragma once
// A claim without the client library, which would refuse everything that the attackers do.

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::chaos {

struct RawClaim {
    explicit RawClaim(const std::string& socket_path) : socket(shm::connect_to(socket_path)) {
        protocol::Hello hello;
        hello.layout = protocol::wire_hash();
        std::strcpy(hello.client, "hostile");
        ask(hello);
        shm::receive_message(socket, buffer);
        protocol::ClaimRequest request;
        request.shared = 1;
        ask(request);
        auto answer = shm::receive_message(socket, buffer);
        if (answer.bytes != sizeof(protocol::Claimed) || answer.fds.empty())
            throw std::runtime_error("the claim is refused");
        std::memcpy(static_cast<void*>(&granted), buffer.data(), sizeof granted);
        layout = protocol::claim_layout(request.capacity);
        file = std::move(answer.fds.front());
        void* mapped = mmap(nullptr, layout.total, PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
        if (mapped == MAP_FAILED) throw std::runtime_error("the claim's segment cannot be mapped");
        memory = static_cast<std::byte*>(mapped);
    }
    /// Seals the memory, without which the servo serves no claim, and asks to be served. False: refused.
    bool begin() {
        if (fcntl(file.get(), F_ADD_SEALS, F_SEAL_FUTURE_WRITE) != 0)
            throw std::runtime_error("the claim's segment cannot be sealed");
        protocol::Mapped says_so;
        says_so.key = granted.key;
        ask(says_so);
        return shm::receive_message(socket, buffer).bytes == sizeof(protocol::Serving);
    }
    template <class Message>
    void ask(const Message& message, std::span<const int> fds = {}) {
        if (!shm::send_message(socket, std::as_bytes(std::span(&message, 1)), fds))
            throw std::runtime_error("the servo hung up");
    }

    std::array<std::byte, 4096> buffer;
    shm::UniqueFd socket, file;
    protocol::Claimed granted;
    protocol::ClaimLayout layout;
    std::byte* memory = nullptr;
};

struct ServedClaim : RawClaim {
    explicit ServedClaim(const std::string& socket_path) : RawClaim(socket_path) {
        if (!begin()) throw std::runtime_error("the claim is not served");
    }
};

}  // namespace knurl::chaos

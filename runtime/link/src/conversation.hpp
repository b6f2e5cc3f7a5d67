#pragma once
// One connection to the servo's Unix socket: requests and their answers.

#include <array>
#include <chrono>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <knurl/link/error.hpp>
#include <knurl/link/fork_guard.hpp>
#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/text.hpp>
#include <knurl/shm/socket.hpp>

namespace knurl::detail {

class Conversation {
  public:
    /// One attempt: throws Error::no_servo if nobody listens (yet), Error::permission.
    Conversation(std::string servo, std::chrono::milliseconds answer_time);

    int socket() const noexcept { return socket_.get(); }
    const std::string& servo() const noexcept { return servo_; }
    std::chrono::milliseconds answer_time() const noexcept { return answer_time_; }

    /// Returns a report segment for each device. Throws Error.
    std::pair<protocol::Welcome, std::vector<shm::UniqueFd>> greet(const std::string& client_name);

    template <class Message>
    void send(const Message& message, std::span<const int> fds = {}) {
        if (!shm::send_message(socket_, std::as_bytes(std::span(&message, 1)), fds)) gone();
    }
    /// Waits at most the answer time; throws Error, of kind `refusal` if the servo refused.
    template <class Message>
    std::pair<Message, std::vector<shm::UniqueFd>> receive(protocol::MessageType expected,
                                                           Error::Kind refusal) {
        wait();
        return take<Message>(expected, refusal);
    }
    /// Takes an answer that has already arrived.
    template <class Message>
    std::pair<Message, std::vector<shm::UniqueFd>> take(protocol::MessageType expected, Error::Kind refusal) {
        alignas(8) std::array<std::byte, 4096> buffer{};
        static_assert(sizeof(Message) <= buffer.size());
        shm::Received received = shm::receive_message(socket_, buffer, shm::Block::no);
        if (received.closed || received.nothing) gone();
        if (received.descriptors_lost) no_descriptors();
        protocol::MessageHeader header;
        if (received.bytes < sizeof header) nonsense();
        std::memcpy(&header, buffer.data(), sizeof header);
        if (header.magic != protocol::attach_magic) nonsense();
        if (header.type == protocol::MessageType::refused && received.bytes >= sizeof(protocol::Refused)) {
            protocol::Refused refused;
            std::memcpy(&refused, buffer.data(), sizeof refused);
            throw Error(refused.holder_pid != 0 ? Error::Kind::device_held
                        : refused.full != 0     ? Error::Kind::refused
                                                : refusal,
                        protocol::text_of(refused.text), static_cast<pid_t>(refused.holder_pid));
        }
        if (header.type != expected || received.bytes != sizeof(Message)) nonsense();
        Message message;
        std::memcpy(&message, buffer.data(), sizeof message);
        return {message, std::move(received.fds)};
    }
    [[noreturn]] void gone() const;
    [[noreturn]] void nonsense() const;
    [[noreturn]] void no_descriptors() const;

  private:
    void wait();

    std::string servo_;
    std::chrono::milliseconds answer_time_;
    shm::UniqueFd socket_;
    LostInChild lost_in_child_;
};

}  // namespace knurl::detail

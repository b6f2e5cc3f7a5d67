#include "build_queue.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <knurl/protocol/text.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "asset_answer.hpp"
#include "child_process.hpp"

namespace knurl::servo {

namespace {

std::string refused(int error) {
    return fmt::format("asset: cannot start its builder ({}); see the limits of processes and memory",
                       std::strerror(error));
}

}  // namespace

BuildQueue::~BuildQueue() {
    // Nothing waits for the process: it may be closing a descriptor of a client.
    end();
}

void BuildQueue::start(Job job) {
    reap();
    const std::uint64_t owner = job.owner;
    queue_.push(owner, std::move(job));
    next();
}

void BuildQueue::next() {
    while (!running_ && !queue_.empty()) {
        const Job job = *queue_.pop();
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
            failed_.push_back({.ticket = job.ticket,
                               .asset = {},
                               .memory = {},
                               .ready = {},
                               .digest = {},
                               .source = {},
                               .refusal = refused(errno)});
            continue;
        }
        shm::UniqueFd ours(ends[0]), theirs(ends[1]);
        pid_t pid = 0;
        const int error =
            start_child(program_, {build_asset_option, std::to_string(job.bytes), std::to_string(job.budget)},
                        {job.connection.get(), theirs.get()}, SCHED_IDLE, pid);
        if (error != 0) {
            failed_.push_back({.ticket = job.ticket,
                               .asset = {},
                               .memory = {},
                               .ready = {},
                               .digest = {},
                               .source = {},
                               .refusal = refused(error)});
            continue;
        }
        ++builds_;
        running_ = Running{.ticket = job.ticket, .number = job.number, .pid = pid, .socket = std::move(ours)};
    }
}

void BuildQueue::end_process() noexcept {
    if (!running_) return;
    ::kill(running_->pid, SIGKILL);
    ending_.push_back(running_->pid);
    running_.reset();
    reap();
}

void BuildQueue::reap() noexcept {
    std::erase_if(ending_, [&](pid_t pid) { return ::waitpid(pid, nullptr, WNOHANG) != 0; });
}

void BuildQueue::cancel(std::uint64_t ticket) noexcept {
    queue_.erase_if([&](const Job& job) { return job.ticket == ticket; });
    if (!running_ || running_->ticket != ticket) return;
    end_process();
    next();
}

void BuildQueue::end() noexcept {
    queue_.erase_if([](const Job&) { return true; });
    end_process();
}

std::optional<BuildQueue::Result> BuildQueue::collect() {
    if (!failed_.empty()) {
        Result result = std::move(failed_.front());
        failed_.pop_front();
        return result;
    }
    if (!running_) return std::nullopt;
    AssetAnswer answer;
    shm::Received received =
        shm::receive_message(running_->socket, std::as_writable_bytes(std::span(&answer, 1)), shm::Block::no);
    if (received.nothing) return std::nullopt;
    Result result{.ticket = running_->ticket,
                  .asset = {},
                  .memory = {},
                  .ready = {},
                  .digest = {},
                  .source = {},
                  .refusal = {}};
    const std::uint32_t number = running_->number;
    end_process();  // its answer is complete
    next();
    if (received.closed || received.bytes != sizeof answer) {
        result.refusal =
            "asset: its builder died; this is a fault of Knurl's: please report it, with the shape";
    } else if (answer.refused != 0) {
        result.refusal = protocol::text_of(answer.text);
    } else {
        try {
            if (received.fds.size() != 2) throw std::runtime_error("its builder sent no memory");
            const auto memory = std::make_shared<shm::Segment>(
                shm::Segment::open_sealed(received.fds.front().get(), answer.block_bytes));
            const std::span<const std::byte> block(memory->data(), memory->size());
            auto asset = asset_of(block, memory);
            asset->materials.assign(answer.materials.begin(),
                                    answer.materials.begin() + answer.material_count);
            result.asset = std::move(asset);
            result.memory = memory;
            result.ready = answer.ready;
            result.ready.number = number;
            result.digest = answer.digest;
            result.source = std::move(received.fds.back());
        } catch (const std::exception& error) {
            result.refusal =
                fmt::format("asset: no memory for it ({}); see the limits of memory", error.what());
        }
    }
    return result;
}

}  // namespace knurl::servo

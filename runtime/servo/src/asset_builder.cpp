// The builder's own process (build_queue.hpp).

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <sys/prctl.h>
#include <unistd.h>

#include <knurl/protocol/text.hpp>
#include <knurl/servo/asset_build.hpp>
#include <knurl/servo/asset_digest.hpp>
#include <knurl/shm/segment.hpp>
#include <knurl/shm/socket.hpp>

#include "asset_answer.hpp"
#include "attach_messages.hpp"
#include "build_queue.hpp"
#include "child_process.hpp"

namespace knurl::servo {

namespace {

shm::UniqueFd build(int source_fd, std::uint64_t bytes, std::uint64_t budget, AssetAnswer& answer) {
    const shm::Segment source = shm::Segment::open_sealed(source_fd, bytes);
    const BuiltAsset built = build_asset({source.data(), source.size()}, budget);
    const Asset& asset = *built.asset;
    answer.ready = built.ready;
    answer.material_count = static_cast<std::uint32_t>(asset.materials.size());
    std::copy(asset.materials.begin(), asset.materials.end(), answer.materials.begin());
    answer.block_bytes = asset.block_bytes();
    answer.digest = digest_of({source.data(), source.size()});
    shm::Segment block = shm::Segment::create("knurl-asset", answer.block_bytes);
    asset.write({block.data(), block.size()});
    return shm::Segment::seal(std::move(block));
}

}  // namespace

int build_asset_main(int argc, const char* const* argv) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    leave_protection();
    AssetAnswer answer;
    // Whatever it is, it is closed behind the answer: that may take any time.
    shm::Received offer;
    shm::UniqueFd block;
    const auto fail = [&](const char* why) {
        answer.refused = 1;
        protocol::put_text(answer.text, why);
    };
    try {
        if (argc != 4)
            throw std::runtime_error("asset: its builder is called as knurld calls it, by nobody else");
        Buffer unused;
        offer = shm::receive_every_descriptor(STDIN_FILENO, unused);
        if (offer.fds.size() != 1)
            throw std::runtime_error(
                "asset: an offer brings one descriptor, of the memory that holds the shape");
        block = build(offer.fds.front().get(), std::strtoull(argv[2], nullptr, 10),
                      std::strtoull(argv[3], nullptr, 10), answer);
    } catch (const std::bad_alloc&) {
        fail("asset: the machine has no memory to build it; send a smaller shape");
    } catch (const std::exception& error) {
        fail(error.what());
    }
    const std::array both{block.get(), block ? offer.fds.front().get() : -1};
    const std::span<const int> fds = block ? std::span<const int>(both) : std::span<const int>();
    return shm::send_message(STDOUT_FILENO, std::as_bytes(std::span(&answer, 1)), fds) ? 0 : 1;
}

}  // namespace knurl::servo

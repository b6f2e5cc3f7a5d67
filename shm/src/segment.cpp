#include <array>
#include <string>
#include <utility>

#include <boost/interprocess/mapped_region.hpp>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <knurl/shm/segment.hpp>

#include "system_error.hpp"

namespace knurl::shm {

namespace ipc = boost::interprocess;

namespace {

constexpr int size_seals = F_SEAL_SHRINK | F_SEAL_GROW;
// The smallest sizes of all processors. Where they are larger, some work is done in vain.
constexpr std::size_t page_bytes = 4096, huge_page_bytes = std::size_t{2} << 20;

/// The interface that mapped_region requires.
struct Mappable {
    int fd;
    ipc::mapping_handle_t get_mapping_handle() const {
        return ipc::ipcdetail::mapping_handle_from_file_handle(fd);
    }
};

}  // namespace

struct Segment::Mapping {
    ipc::mapped_region region;
};

Segment::Segment() noexcept = default;
Segment::Segment(Segment&& other) noexcept
    : fd_(std::move(other.fd_)),
      held_pages_(std::move(other.held_pages_)),
      mapping_(std::move(other.mapping_)),
      data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)) {}
Segment& Segment::operator=(Segment&& other) noexcept {
    fd_ = std::move(other.fd_);
    held_pages_ = std::move(other.held_pages_);
    mapping_ = std::move(other.mapping_);
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    return *this;
}
Segment::~Segment() = default;

Segment::Segment(UniqueFd fd, std::size_t bytes, Access access, std::string_view what) : fd_(std::move(fd)) {
    const ipc::mode_t mode = access == Access::read_write     ? ipc::read_write
                             : access == Access::private_copy ? ipc::copy_on_write
                                                              : ipc::read_only;
    try {
        // MAP_POPULATE: the first touch of a page costs microseconds, for which no cycle has time.
        mapping_ = std::make_unique<Mapping>(
            Mapping{ipc::mapped_region(Mappable{fd_.get()}, mode, 0, bytes, nullptr, MAP_POPULATE)});
    } catch (const ipc::interprocess_exception& error) {
        throw std::runtime_error("segment " + std::string(what) + ": cannot map " + std::to_string(bytes) +
                                 " bytes: " + error.what() +
                                 (access == Access::read_write
                                      ? "; a sealed segment can only be mapped read-only"
                                      : "; see the limits of memory and address space"));
    }
    data_ = static_cast<std::byte*>(mapping_->region.get_address());
    size_ = bytes;
}

Segment Segment::create(std::string_view name, std::size_t bytes) {
    const std::string who(name);
    if (bytes == 0) throw std::runtime_error("segment " + who + ": 0 bytes; ask for at least one");
    UniqueFd fd(::memfd_create(who.c_str(), MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (!fd) throw_errno("segment " + who + ": cannot create", "see the limits of this process");
    if (::ftruncate(fd.get(), static_cast<off_t>(bytes)) != 0)
        throw_errno("segment " + who + ": cannot make it " + std::to_string(bytes) + " bytes",
                    "see the limits of memory");
    if (::fcntl(fd.get(), F_ADD_SEALS, size_seals) != 0)
        throw_errno("segment " + who + ": cannot seal its size", "a kernel of 3.17 or later is needed");
    return Segment(std::move(fd), bytes, Access::read_write, name);
}

namespace {

/// Duplicates the descriptor of a memfd after checking its exact size and its seals.
UniqueFd received(int fd, std::size_t expected_bytes, int needed, const char* seals_by_name) {
    const std::string who = "received segment (descriptor " + std::to_string(fd) + ")";
    // First: only memory has seals. Who offers another file may make every other call wait, also the close of
    // a duplicate.
    const int seals = ::fcntl(fd, F_GET_SEALS);
    if (seals < 0 || (seals & needed) != needed)
        throw std::runtime_error(who + ": it is not sealed; hand over a memfd with " + seals_by_name);
    UniqueFd own(::fcntl(fd, F_DUPFD_CLOEXEC, 0));
    if (!own) throw_errno(who + ": cannot duplicate", "hand over an open descriptor");
    struct stat status {};
    if (::fstat(own.get(), &status) != 0) throw_errno(who + ": no status", "hand over a memfd");
    if (expected_bytes == 0 || status.st_size < 0 ||
        static_cast<std::uint64_t>(status.st_size) != static_cast<std::uint64_t>(expected_bytes))
        throw std::runtime_error(who + ": has " + std::to_string(status.st_size) + " bytes instead of " +
                                 std::to_string(expected_bytes) + "; both sides must be built alike");
    return own;
}

}  // namespace

Segment Segment::open(int fd, std::size_t expected_bytes, Access access) {
    return Segment(received(fd, expected_bytes, size_seals, "F_SEAL_SHRINK and F_SEAL_GROW"), expected_bytes,
                   access, "received");
}

Segment Segment::open_sealed(int fd, std::size_t expected_bytes) {
    return Segment(received(fd, expected_bytes, size_seals | F_SEAL_WRITE | F_SEAL_SEAL,
                            "F_SEAL_WRITE, F_SEAL_SHRINK, F_SEAL_GROW and F_SEAL_SEAL"),
                   expected_bytes, Access::private_copy, "received");
}

UniqueFd Segment::seal(Segment written) {
    UniqueFd fd = std::move(written.fd_);
    written = Segment();  // a file that is mapped for writing cannot be sealed against writes
    if (::fcntl(fd.get(), F_ADD_SEALS, size_seals | F_SEAL_WRITE | F_SEAL_SEAL) != 0)
        throw_errno("segment: cannot seal against writing", "unmap it everywhere first");
    return fd;
}

void Segment::seal_against_new_writers() {
    if (::fcntl(fd_.get(), F_ADD_SEALS, F_SEAL_FUTURE_WRITE) != 0)
        throw_errno("segment: cannot seal against new writers", "a kernel of 5.1 or later is needed");
}

bool Segment::sealed_against_new_writers() const noexcept {
    constexpr int needed = size_seals | F_SEAL_FUTURE_WRITE;
    const int seals = ::fcntl(fd_.get(), F_GET_SEALS);
    return seals >= 0 && (seals & needed) == needed;
}

namespace {

/// The kernel gathers pages only if nobody but the page cache and the mappings refers to any of them. A page
/// in a pipe is referred to by the pipe.
UniqueFd pipe_with(const std::byte* memory, std::size_t bytes) {
    constexpr const char* remedy = "see the limits of open files and of pipes (fs.pipe-user-pages-soft)";
    const std::size_t pages = (bytes + huge_page_bytes - 1) / huge_page_bytes;
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw_errno("segment: cannot make a pipe to hold its pages", remedy);
    UniqueFd out(ends[0]);
    const UniqueFd in(ends[1]);
    // One place of a pipe is a page of this machine.
    const std::size_t pipe_bytes = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    if (::fcntl(in.get(), F_SETPIPE_SZ, static_cast<int>(pipe_bytes)) < 0)
        throw_errno("segment: cannot make the pipe that holds its pages large enough", remedy);
    for (std::size_t at = 0; at < bytes; at += huge_page_bytes) {
        const iovec one{.iov_base = const_cast<std::byte*>(memory + at), .iov_len = 1};
        if (::vmsplice(in.get(), &one, 1, SPLICE_F_NONBLOCK) != 1)
            throw_errno("segment: cannot hold its pages", remedy);
    }
    return out;
}

/// Page faults of this thread while it reads a byte of each page. A sanitizer's own memory must not count, so
/// the reads are not instrumented.
__attribute__((noinline, no_sanitize("address", "thread"))) long faults_of_reading(
    const volatile std::byte* memory, std::size_t bytes) noexcept {
    rusage before{}, after{};
    ::getrusage(RUSAGE_THREAD, &before);
    for (std::size_t at = 0; at < bytes; at += page_bytes) static_cast<void>(memory[at]);
    ::getrusage(RUSAGE_THREAD, &after);
    return after.ru_minflt + after.ru_majflt - before.ru_minflt - before.ru_majflt;
}

}  // namespace

void Segment::hold_pages() {
    // The limit may be too low for it; lock_memory of the process says so.
    static_cast<void>(::mlock(data_, size_));
    held_pages_ = pipe_with(data_, size_);
}

bool Segment::has_every_page() const noexcept {
    // The first call brings the code itself into memory.
    const std::byte here{};
    faults_of_reading(&here, 1);
    return faults_of_reading(data_, size_) == 0;
}

}  // namespace knurl::shm

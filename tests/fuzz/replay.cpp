// Runs a fuzz target without libFuzzer, built like the rest: first on the kept inputs, then on alterations
// of them that a seed selects.
//   knurl_replay_X LONGEST ALTERATIONS LAST [FOLDER...]
// LAST is a file: it has the current input, so the one that breaks the target stays there.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
/// Defined only by some targets.
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr unsigned seed = 1;

/// std::mt19937 modulo n. Unlike the library's distributions it gives the same numbers on every machine.
class Dice {
  public:
    std::size_t below(std::size_t n) { return engine_() % n; }

  private:
    std::mt19937 engine_{seed};
};

/// Makes one to eight changes of the kinds that a fuzzer makes, including a piece of another input.
Bytes altered(Bytes bytes, const Bytes& other, std::size_t longest, Dice& dice) {
    for (std::size_t changes = 1 + dice.below(8); changes > 0; --changes) {
        const std::size_t at = dice.below(bytes.size() + 1);
        const auto here = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        switch (dice.below(5)) {
            case 0:
                if (here != bytes.end()) *here ^= static_cast<std::uint8_t>(1u << dice.below(8));
                break;
            case 1:
                if (here != bytes.end()) *here = static_cast<std::uint8_t>(dice.below(256));
                break;
            case 2: {
                const std::size_t run = std::min(dice.below(9), bytes.size() - at);
                bytes.erase(here, here + static_cast<std::ptrdiff_t>(run));
                break;
            }
            case 3: {
                Bytes run(1 + dice.below(8));
                for (auto& byte : run) byte = static_cast<std::uint8_t>(dice.below(256));
                bytes.insert(here, run.begin(), run.end());
                break;
            }
            default:
                if (!other.empty()) {
                    const std::size_t from = dice.below(other.size());
                    const auto begin = other.begin() + static_cast<std::ptrdiff_t>(from);
                    bytes.insert(here, begin,
                                 begin + static_cast<std::ptrdiff_t>(1 + dice.below(other.size() - from)));
                }
        }
    }
    if (bytes.size() > longest) bytes.resize(longest);
    return bytes;
}

/// `last` is open for writing, since opening it for each input takes longer than most targets.
void run(const Bytes& bytes, int last) {
    if (::pwrite(last, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()) ||
        ::ftruncate(last, static_cast<off_t>(bytes.size())) != 0)
        std::perror("replay: the input cannot be kept");
    // A copy of the exact size, so that AddressSanitizer detects reads past its end.
    const std::vector<std::uint8_t> exact(bytes.begin(), bytes.end());
    LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

}  // namespace

int main(int argc, char** argv) {
    if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
    if (argc < 4) {
        std::fprintf(stderr, "usage: %s LONGEST ALTERATIONS LAST [FOLDER...]\n", argv[0]);
        return 2;
    }
    const std::size_t longest = std::stoul(argv[1]), alterations = std::stoul(argv[2]);
    const int last = ::open(argv[3], O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (last < 0) {
        std::perror(argv[3]);
        return 2;
    }
    std::vector<std::filesystem::path> files;
    for (int i = 4; i < argc; ++i)
        for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
    std::sort(files.begin(), files.end());

    std::vector<Bytes> kept;
    for (const auto& path : files) {
        std::ifstream file(path, std::ios::binary);
        kept.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
    Dice dice;
    if (kept.empty()) {
        // Random bytes, for a target that has a meaning for any bytes.
        for (std::size_t i = 0; i < 64; ++i) {
            kept.emplace_back(dice.below(longest));
            for (auto& byte : kept.back()) byte = static_cast<std::uint8_t>(dice.below(256));
        }
    }
    for (const Bytes& bytes : kept) run(bytes, last);
    for (std::size_t i = 0; i < alterations; ++i)
        run(altered(kept[dice.below(kept.size())], kept[dice.below(kept.size())], longest, dice), last);
    std::filesystem::remove(argv[3]);
    std::printf("%zu kept inputs and %zu alterations of them by seed %u\n", kept.size(), alterations, seed);
    return 0;
}

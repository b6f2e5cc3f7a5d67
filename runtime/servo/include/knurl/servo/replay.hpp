#pragma once

/// @file
/// Feeds an input log through the very same Servo::step again: same build, same device, same bits.

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <knurl/protocol/asset.hpp>
#include <knurl/servo/input_log.hpp>
#include <knurl/servo/offline.hpp>

namespace knurl::servo {

/// A record that no servo of this build wrote: one line, which and why.
class InputLogError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A servo that is fed from an input log.
class Replay {
  public:
    /// Returns the source of the asset of that digest, aligned to 8. Throws InputLogError: it is not to be
    /// had.
    using Sources = std::function<std::span<const std::byte>(const protocol::AssetDigest&)>;

    /// `like`: a device of the recorded one's figures; it is neither read nor written. `sources`: none, if no
    /// asset is to be expected.
    Replay(const drivers::Device& like, const ServoOptions& options, Sources sources = {});
    ~Replay();

    /// Takes one record, in the input log's order. Returns the report if that completed a cycle. Null: it did
    /// not, or the state of the servo is not known (before a keyframe). Throws InputLogError.
    const Report* feed(const InputRecord& record);
    /// Records are missing here: nothing can be replayed up to the next keyframe.
    void gap() noexcept;
    /// True: there was a keyframe, and no gap since.
    bool exact() const noexcept { return exact_; }

  private:
    struct Played;  // device and clock
    struct Held;    // a claim and its application's end

    const Report* step(const CycleInput& cycle);
    void load(const InputRecord& record);
    Held* held(const InputRecord& record);
    void free_released();
    void give(const InputRecord& record);
    void shed(const InputRecord& record);

    std::unique_ptr<Played> played_;
    ServoOptions options_;
    OfflineMemory segment_;
    Sources sources_;
    std::unique_ptr<Servo> servo_;
    std::map<std::uint64_t, std::unique_ptr<Held>> claims_;  // by number
    bool exact_ = false;
};

}  // namespace knurl::servo

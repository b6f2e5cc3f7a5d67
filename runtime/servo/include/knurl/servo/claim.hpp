#pragma once

/// @file
/// One client's hold on a device, as the servo sees it: its channels, its scene, its gain, its silence.

#include <cstdint>
#include <memory>

#include <knurl/protocol/attach.hpp>
#include <knurl/protocol/claim_segment.hpp>
#include <knurl/protocol/device_segment.hpp>
#include <knurl/reps/scene.hpp>
#include <knurl/shm/spsc_ring.hpp>
#include <knurl/shm/triple_buffer.hpp>

namespace knurl::servo {

/// What the broker settles when it grants a claim.
struct ClaimTerms {
    /// Size of the claim.
    protocol::ClaimCapacity capacity;
    /// World frame of the claim.
    protocol::Frame frame;
    /// The device's limits in world units.
    Limits limits;
    /// How often the application means to commit (s); 0: measured.
    double update_interval = 0;
    /// Time on top of the silence that is allowed (s).
    double delay_allowance = 0;
    /// True: it holds nothing.
    bool observer = false;
    /// True: the observer may reset a fault, and command nothing else.
    bool resets = false;
    /// True: others may hold the device as well.
    bool shared = false;
    /// Not 0: the servo's thread may wake the client itself; 0: the waker does.
    std::int32_t woken_by_servo = 0;
};

/// A claim or observer of a device. The broker makes it (allocates, prefaults); from then on the servo's
/// thread alone uses it, and gives it back through its outbox to be freed.
class Claim {
  public:
    /// `memory`: the claim's segment, laid out by protocol::claim_layout. Its rings are made empty here, so
    /// this comes before the segment is handed to the client. `row` of the device's table may be null.
    Claim(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    struct Impl;
    /// The servo's side, in claim.cpp: drained and evaluated by Servo.
    std::unique_ptr<Impl> impl;
};

}  // namespace knurl::servo

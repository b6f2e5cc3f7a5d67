#pragma once
// One client's hold on a device, as the servo sees it: its channels, its scene, its gain, its silence.

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
    protocol::ClaimCapacity capacity;
    protocol::Frame frame;
    Limits limits;               // world units
    double update_interval = 0;  // s; 0: measured
    double delay_allowance = 0;  // s, on top of the silence that is allowed
    bool observer = false;
    bool resets = false;  // the observer may reset a fault, and command nothing else
    bool shared = false;
    int event_fd = -1;  // what the client sleeps on; outlives the claim. -1: the waker wakes it
};

/// Made by the broker (allocates, prefaults), used by the servo's thread alone from then on, given back
/// through the servo's outbox to be freed. `memory` is the claim's segment, laid out by
/// protocol::claim_layout; its rings are made empty here, so this comes before the segment is handed to the
/// client. `row` may be null: nobody looks.
class Claim {
  public:
    Claim(const ClaimTerms& terms, std::byte* memory, protocol::ClientRow* row);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

    struct Impl;
    std::unique_ptr<Impl> impl;  // the servo's side, in claim.cpp: drained and evaluated by Servo
};

}  // namespace knurl::servo

// Reading reports.

#include <cstddef>

#include "objects.hpp"

using namespace knurl;
using namespace knurl::capi;

namespace {

// The members between the two sizes are those of Report, in the same places: they are copied as they are.
constexpr std::size_t shift = offsetof(knurl_report, cycle);
static_assert(offsetof(knurl_report, missed) == shift + sizeof(Report));
static_assert(offsetof(knurl_report, joints) == shift + offsetof(Report, joints));
static_assert(offsetof(knurl_report, position) == shift + offsetof(Report, position));
static_assert(offsetof(knurl_report, orientation) == shift + offsetof(Report, orientation));
static_assert(offsetof(knurl_report, sent_force) == shift + offsetof(Report, sent_force));
static_assert(offsetof(knurl_report, contact_point) == shift + offsetof(Report, contact_point));
static_assert(offsetof(knurl_report, state) == shift + offsetof(Report, state));
static_assert(offsetof(knurl_report, late_count) == shift + offsetof(Report, late_count));
static_assert(offsetof(knurl_report, touches) == shift + offsetof(Report, touches));
// And with the two that follow, those of HandReport.
static_assert(offsetof(knurl_report, unread) == offsetof(knurl_report, missed) + sizeof(std::uint64_t));
static_assert(sizeof(HandReport) == sizeof(Report) + 2 * sizeof(std::uint64_t) &&
              shift % alignof(HandReport) == 0);

void copy(const HandReport& from, knurl_report& to) {
    std::memcpy(reinterpret_cast<std::byte*>(&to) + shift, static_cast<const Report*>(&from), sizeof(Report));
    to.missed = from.missed;
    to.unread = from.unread;
}

int answer(const std::optional<HandReport>& report, knurl_report* out) {
    if (!report) return KNURL_NOTHING;
    knurl_report copied{};
    copy(*report, copied);
    write_struct(out, copied);
    return KNURL_OK;
}

}  // namespace

extern "C" {

int knurl_newest(knurl_hand* hand, int64_t timeout_ns, knurl_frame* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_frame");
        const std::optional<HandFrame> frame = it.reader().newest(time_of(timeout_ns));
        if (!frame) return KNURL_NOTHING;
        knurl_frame copied{};
        copied.pressed = frame->pressed;
        copied.released = frame->released;
        copied.touched = frame->touched ? 1 : 0;
        copied.touches = frame->touches;
        copied.skipped = frame->skipped;
        copied.report.size =
            std::min<std::uint64_t>(sizeof copied.report, out->size - offsetof(knurl_frame, report));
        copy(*frame, copied.report);
        write_struct(out, copied);
        return KNURL_OK;
    });
}

int knurl_latest(knurl_hand* hand, knurl_report* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_report");
        return answer(it.reader().latest(), out);
    });
}

int knurl_next_report(knurl_hand* hand, int64_t timeout_ns, knurl_report* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_report");
        return answer(it.reader().next_report(time_of(timeout_ns)), out);
    });
}

int knurl_reports(knurl_hand* hand, knurl_report* out, size_t capacity, size_t* count) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(count, "knurl_reports: count");
        *count = 0;
        if (capacity == 0) return KNURL_OK;
        require_room(out, "knurl_report");
        const std::uint64_t stride = out->size;
        auto* to = reinterpret_cast<std::byte*>(out);
        // In parts, since each size is written next to a report that is in the cache still.
        constexpr std::size_t part = 64;
        while (*count < capacity) {
            const std::size_t wanted = std::min(capacity - *count, part);
            const std::size_t got = it.reader().drain_rows(to + shift, stride, wanted);
            *count += got;
            for (std::size_t i = 0; i < got; ++i, to += stride)
                reinterpret_cast<knurl_report*>(to)->size = stride;
            if (got < wanted) break;
        }
        return *count > 0 ? KNURL_OK : KNURL_NOTHING;
    });
}

int knurl_fd(knurl_hand* hand, int* fd) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(fd, "knurl_fd: fd");
        *fd = it.reader().fd();
        return KNURL_OK;
    });
}

int knurl_missed(const knurl_hand* hand, uint64_t* missed) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(missed, "knurl_missed: missed");
        *missed = it.reader().missed();
        return KNURL_OK;
    });
}

int knurl_reattachments(const knurl_hand* hand, uint64_t* count) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(count, "knurl_reattachments: count");
        *count = it.reader().reattachments();
        return KNURL_OK;
    });
}

int knurl_age(const knurl_hand* hand, int64_t read_ns, int64_t* age_ns, int64_t* uncertainty_ns) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_pointer(age_ns, "knurl_age: age_ns");
        Report report;
        report.read_ns = read_ns;
        const Age age = it.reader().age(report);
        *age_ns = age.age.count();
        if (uncertainty_ns != nullptr) *uncertainty_ns = age.uncertainty.count();
        return KNURL_OK;
    });
}

int knurl_network_of(const knurl_hand* hand, knurl_network* out) {
    return with<HandObject>(hand, [&](HandObject& it) -> int {
        require_room(out, "knurl_network");
        const Network from = it.reader().network();
        write_struct(out, knurl_network{.size = 0,
                                        .lost = from.lost,
                                        .late = from.late,
                                        .duplicated = from.duplicated,
                                        .resent = from.resent,
                                        .round_trip_ns = from.round_trip.count(),
                                        .clock_offset_ns = from.clock_offset.count(),
                                        .clock_uncertainty_ns = from.clock_uncertainty.count(),
                                        .drift = from.drift,
                                        .drift_uncertainty = from.drift_uncertainty,
                                        .encrypted = from.encrypted ? 1u : 0u,
                                        .reserved = 0});
        return KNURL_OK;
    });
}
}

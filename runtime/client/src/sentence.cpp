#include "sentence.hpp"

#include <array>

#include <knurl/link/text.hpp>
#include <knurl/protocol/report.hpp>
#include <knurl/reps/describe.hpp>

namespace knurl::detail {

namespace {

struct Named {
    std::uint32_t bit;
    std::string_view name;
};
constexpr std::array fault_bits{
    Named{fault::not_finite, "a force was not finite"},
    Named{fault::slew, "the force changed too fast"},
    Named{fault::speed, "the hand was too fast"},
    Named{fault::power, "too much power into the hand"},
    Named{fault::unplugged, "the device was unplugged"},
    Named{fault::bad_samples, "bad samples from the device"},
    Named{fault::encoder_jump, "an impossible jump of position"},
    Named{fault::clock_jump, "the clock jumped"},
    Named{fault::kinematics, "no pose for the joints"},
    Named{fault::guardian, "the servo stood still and the guardian zeroed the device"},
    Named{fault::overload, "the servo's cycles took longer than its period"},
    Named{fault::unguarded, "the servo's guardian process stood still"},
};

std::string reason(const protocol::Reply& reply) {
    switch (static_cast<protocol::RefusalReason>(reply.reason)) {
        case protocol::RefusalReason::not_calibrated:
            return "the device is not calibrated; bring it to its home position first";
        case protocol::RefusalReason::in_fault:
            return detail::format(
                "the device is in fault ({}); mend the cause, then call reset_fault() "
                "or run: knurl reset",
                fault_names(static_cast<std::uint32_t>(reply.value)));
        case protocol::RefusalReason::hand_too_fast:
            return detail::format("the hand moves at {:.3g} m/s; hold it still and try again", reply.value);
        case protocol::RefusalReason::not_in_fault:
            return "the device is not in fault; call arm() instead";
        case protocol::RefusalReason::group_refused:
            return "another command of the same group was refused; nothing of the group was done";
        case protocol::RefusalReason::disconnected:
            return "the device is not connected; plug it in";
        case protocol::RefusalReason::malformed:
            return "the servo could not read it; build the application and the servo from the same version";
        case protocol::RefusalReason::forbidden:
            return "this key's role is render: it joins a device that somebody else has switched on; to "
                   "switch it "
                   "on or to reset it use a key of role control (knurl-bridge keygen --role control)";
        case protocol::RefusalReason::cause_persists:
            return detail::format("what led to the fault goes on ({}); mend that first",
                                  fault_names(static_cast<std::uint32_t>(reply.value)));
        case protocol::RefusalReason::cycle_full:
            if (reply.against == 0)
                return "the servo has shed this claim, since its cycles took too long; remove at least "
                       "half of the claim's representations, then call arm()";
            return detail::format(
                "the servo's cycle takes {:.0f} % of its period, and takes new work up to {:.0f} %; remove "
                "representations, here or in another application (knurl top shows how many each application "
                "has)",
                100 * reply.value, 100 * reply.against);
        case protocol::RefusalReason::none:
            break;
    }
    return "the device's state forbids it";
}

}  // namespace

std::string fault_names(std::uint32_t faults) {
    std::string text;
    for (const Named& bit : fault_bits) {
        if ((faults & bit.bit) == 0) continue;
        if (!text.empty()) text += ", ";
        text += bit.name;
    }
    return text.empty() ? "no cause given" : text;
}

std::string refused_command(const protocol::Reply& reply, const std::string& what) {
    const Verdict verdict = protocol::verdict_of(reply);
    if (verdict.code == Verdict::Code::refused) return what + ": " + reason(reply);
    return describe(verdict, reply.kind, what);
}

std::string refused_batch(const protocol::FeedbackHeader& header) {
    return describe(protocol::verdict_of(header), header.refused_kind,
                    detail::format("batch {}, slot {}: the servo refused all of it", header.refused_batch,
                                   header.refused_slot));
}

}  // namespace knurl::detail

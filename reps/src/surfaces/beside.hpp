#pragma once
// How a surface that can be entered and left is evaluated beside others (proxy_path.hpp). The stages are the
// same for all such surfaces. `Surface` has a function for each stage, with what the surface does there.

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/proxy_path.hpp>

namespace knurl {

/// False: the surface need not answer. `cold` asks for small code, since the code is locked into memory, once
/// for each kind.
template <class Surface>
[[gnu::cold, gnu::noinline]] bool take_stage(Surface& surface, ProxyPath::Stage stage, double dt) noexcept {
    using Stage = ProxyPath::Stage;
    switch (stage) {
        case Stage::look:
            surface.look();
            return false;
        case Stage::near:
            surface.near();
            return false;
        case Stage::overlap:
            surface.overlap();
            return false;
        case Stage::rewind:
            surface.rewind();
            break;
        case Stage::enter:
            surface.enter();
            break;
        case Stage::leave:
            surface.leave();
            break;
        case Stage::brush:
            surface.brush();
            break;
        case Stage::free:
        case Stage::answer:
            surface.come_back(dt);
            break;
    }
    return true;
}

template <class Surface>
Contact contact_beside(Surface surface, ProxyPath::Stage stage, double dt) noexcept {
    return take_stage(surface, stage, dt) ? surface.answer() : Contact{};
}

}  // namespace knurl

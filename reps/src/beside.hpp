#pragma once
// How a surface that can be entered and left is asked beside others (proxy_path.hpp). The stages are the same for all
// such surfaces. What each stage does is the surface's own: `Surface` has a function for each.

#include <knurl/reps/concepts.hpp>
#include <knurl/reps/proxy_path.hpp>

namespace knurl {

// `cold` asks for small code: it is locked into memory, once for each kind.
template <class Surface>
[[gnu::cold, gnu::noinline]] Contact contact_beside(Surface surface, ProxyPath::Stage stage,
                                                    double dt) noexcept {
    using Stage = ProxyPath::Stage;
    switch (stage) {
        case Stage::look:
            surface.look();
            return {};
        case Stage::near:
            surface.near();
            return {};
        case Stage::overlap:
            surface.overlap();
            return {};
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
    return surface.answer();
}

}  // namespace knurl

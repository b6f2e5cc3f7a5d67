#include <algorithm>
#include <array>
#include <limits>

#include <knurl/reps/presets.hpp>

namespace knurl {
namespace {

constexpr double hardest = std::numeric_limits<double>::infinity();

constexpr std::array<std::string_view, 7> names = {"concrete", "sand", "rubber",   "skin",
                                                   "cloth",    "ice",  "sandpaper"};

// In the order of the names. Handbooks give the coefficients of friction, static / sliding: wood on concrete
// 0.62, rubber on dry concrete 1.0 / 0.6-0.85, steel or a shoe on ice 0.1 / 0.02-0.05. A snag holds with
// k_stick d_snap. k_stick (times 1 N) must fit into the device's stiffness, so none is above 2000.
constexpr std::array<Material, 7> materials = {
    // Concrete: as hard as the device can render, and coarse. Grains of 1-3 mm catch strongly (0.75, slightly
    // above wood on concrete) and at irregular distances. Each lets go to clearly less, so it is a separate
    // knock.
    Material{
        .stiffness = hardest,
        .damping = 1,
        .snag = {.k_kinetic = 0.45, .k_stick = 1500, .d_snap = 0.5e-3, .d_mean = 2e-3, .d_spread = 2e-3}},
    // Sand: soft and well damped. It holds up to its angle of repose, tan 33 degrees = 0.65. The grains,
    // 0.3-1.3 mm, roll and give way one after another: a crunch rather than knocks.
    Material{
        .stiffness = 400,
        .damping = 6,
        .friction = {.viscous = 1},
        .snag = {.k_kinetic = 0.42, .k_stick = 1300, .d_snap = 0.5e-3, .d_mean = 0.8e-3, .d_spread = 1e-3}},
    // Rubber: soft and sticky. 1.1 / 0.8 are rubber's coefficients on most dry things. The anchor hangs on
    // rubber's own stiffness (600 N/m). So the tip is pulled back over almost 2 mm before it slips, and
    // springs back as far when it turns.
    Material{.stiffness = 600, .damping = 3, .friction = {.static_ = 1.1, .dynamic = 0.8}},
    // Skin: softer still. 0.3-0.9 is measured for dry skin, by place and person (the palm about 0.6). Skin
    // clings without slipping suddenly, so static and sliding friction are close. Its drag grows slightly
    // with speed.
    Material{.stiffness = 300, .damping = 2, .friction = {.static_ = 0.6, .dynamic = 0.55, .viscous = 0.6}},
    // Cloth: light friction (0.2-0.4 for cotton on a smooth thing) over a soft ground. Its weave, a regular
    // grid of 1 mm threads, gives a fine ripple of about a sixth of the pressing force.
    Material{.stiffness = 500,
             .damping = 2,
             .friction = {.static_ = 0.35, .dynamic = 0.28},
             .texture = {.amplitude = 50e-6, .wavelength = 1e-3, .pattern = TexturePattern::grid}},
    // Ice: as hard as the device can render, almost without friction; a trace of static friction, as of a
    // shoe on ice.
    Material{.stiffness = hardest, .friction = {.static_ = 0.05, .dynamic = 0.03}},
    // Sandpaper: as hard as the device can render. Each grain of coarse grit (0.3-0.5 mm apart) holds firmly:
    // at 5 cm/s that is 125 snags a second, a buzz whose pitch follows the hand's speed.
    Material{
        .stiffness = hardest,
        .damping = 1,
        .snag = {.k_kinetic = 0.6, .k_stick = 2000, .d_snap = 0.45e-3, .d_mean = 0.4e-3, .d_spread = 0.2e-3}},
};

}  // namespace

std::span<const std::string_view> preset_names() noexcept {
    return names;
}

const Material* preset(std::string_view name) noexcept {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? nullptr : &materials[static_cast<std::size_t>(found - names.begin())];
}

}  // namespace knurl

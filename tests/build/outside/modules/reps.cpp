#include <knurl/reps/all.hpp>
#include <knurl/reps/scene.hpp>

int main() {
    knurl::Scene scene({.representations = 1, .probes = 1}, {});
    return scene.add({.slot = 0, .generation = 1}, knurl::Plane{.stiffness = 800 /* N/m */}) ? 0 : 1;
}

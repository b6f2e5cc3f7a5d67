// knurld with one more driver, "shared-sim:FILE": a simulated device in another process, which outlives
// knurld.

#include <knurl/servo/daemon.hpp>

int main(int argc, char** argv) {
    return knurl::servo::knurld_main(argc, argv);
}

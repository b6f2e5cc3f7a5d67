// knurld with one more driver, "shared-sim:FILE": a device that outlives it.

#include <knurl/servo/daemon.hpp>

int main(int argc, char** argv) {
    return knurl::servo::knurld_main(argc, argv);
}

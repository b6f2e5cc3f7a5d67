// The servo: owns the devices, runs their loops, lets clients in. See knurld --help.

#include <knurl/servo/daemon.hpp>

int main(int argc, char** argv) {
    return knurl::servo::knurld_main(argc, argv);
}

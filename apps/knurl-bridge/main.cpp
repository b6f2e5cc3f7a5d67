// The bridge: lets applications on other hosts use a servo of this one. See knurl-bridge --help.

#include <knurl/bridge/bridge.hpp>

int main(int argc, char** argv) {
    return knurl::bridge::bridge_main(argc, argv);
}

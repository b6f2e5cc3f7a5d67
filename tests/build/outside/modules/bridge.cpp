#include <string>

#include <knurl/bridge/bridge.hpp>

int main() {
    std::string program = "knurl-bridge", option = "--version";
    char* argv[] = {program.data(), option.data(), nullptr};
    return knurl::bridge::bridge_main(2, argv);
}

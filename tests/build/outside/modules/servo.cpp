#include <string>

#include <knurl/servo/daemon.hpp>

int main() {
    std::string program = "knurld", option = "--version";
    char* argv[] = {program.data(), option.data(), nullptr};
    return knurl::servo::knurld_main(2, argv);
}

#include <knurl/drivers/registry.hpp>

int main() {
    return knurl::drivers::open_device("sim:premium15") ? 0 : 1;
}

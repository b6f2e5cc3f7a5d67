#include <knurl/client/client.hpp>

int main() {
    return knurl::Error::Kind::no_servo == knurl::Error::Kind{};
}

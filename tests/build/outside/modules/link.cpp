#include <cstdio>

#include <knurl/link/error.hpp>
#include <knurl/link/local.hpp>

int main() try {
    knurl::detail::connect_local("nobody-listens-here", "outside", std::chrono::milliseconds(0));
    return 1;
} catch (const knurl::Error& error) {
    return error.kind == knurl::Error::Kind::no_servo ? 0 : 1;
}

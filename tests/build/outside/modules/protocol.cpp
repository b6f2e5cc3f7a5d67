#include <knurl/protocol/attach.hpp>

int main() {
    return knurl::protocol::wire_hash() != 0 ? 0 : 1;
}

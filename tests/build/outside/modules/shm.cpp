#include <knurl/shm/segment.hpp>

int main() {
    knurl::shm::Segment segment = knurl::shm::Segment::create("outside", 4096);
    return segment.data() != nullptr ? 0 : 1;
}

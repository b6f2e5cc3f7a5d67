#include <knurl/scenefile/scene_file.hpp>

int main() {
    return knurl::scenefile::parse_scene("[[plane]]\nstiffness = 800\n", "here").items == 1 ? 0 : 1;
}

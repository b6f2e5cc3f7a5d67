// What all tests read, compiled once: see tests/CMakeLists.txt.
int main() {}

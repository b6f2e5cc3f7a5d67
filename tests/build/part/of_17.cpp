#if __cplusplus >= 202002L
#error C++20 is Knurl's: nobody asked for it here
#endif
int of_17();
int of_17() {
    return 17;
}

// What a C compiler makes of the structs of knurl_kinds.h: kinds_table.py.
#ifndef KNURL_TESTS_KINDS_TABLE_H
#define KNURL_TESTS_KINDS_TABLE_H

#include <knurl.h>
#include <knurl_offline.h>

#ifdef __cplusplus
extern "C" {
#endif

struct member {
    const char* name;
    size_t offset;
    size_t size;
};

struct kind_row {
    const char* name;
    uint32_t kind;
    size_t size;
    const struct member* members;  // without `size`
    size_t member_count;
    int (*use)(knurl_hand* hand, knurl_id* id);  // each wrapper once
};
extern const struct kind_row kind_rows[];
extern const size_t kind_row_count;

struct choice_row {
    const char* kind;
    const char* member;
    const char* value;  // upper case
    uint32_t number;
};
extern const struct choice_row choice_rows[];
extern const size_t choice_row_count;

/// A floor by hand, in C alone: the force (N) of a spring of 800 N/m at 1 mm; below 0: a call failed.
double force_in_c(void);
/// Whether this process may call an address of a servo; a knurl_code.
int connect_in_c(const char* address);

#ifdef __cplusplus
}
#endif
#endif

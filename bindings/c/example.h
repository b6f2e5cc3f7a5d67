// What the examples share: how they end, and for how long they run.
#ifndef KNURL_EXAMPLE_H
#define KNURL_EXAMPLE_H

#include <knurl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// Ends the program with the library's line, unless the call did what it should.
static void check(int code) {
    if (code >= 0) return;
    fprintf(stderr, "%s\n", knurl_error(NULL));
    exit(1);
}

/// The argument of --seconds.
static double seconds_of(int argc, char** argv, double usual) {
    if (argc == 3 && strcmp(argv[1], "--seconds") == 0) return atof(argv[2]);
    if (argc == 1) return usual;
    fprintf(stderr, "usage: %s [--seconds N]\n", argv[0]);
    exit(2);
}

#endif

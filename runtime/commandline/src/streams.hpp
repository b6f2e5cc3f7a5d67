#pragma once
// The three standard streams of a program, whatever they are: see guarded() in program.hpp.

namespace knurl::commandline {

/// Before anything opens a file.
void secure_streams();

/// An errno, if what was printed could not be written; 0: all of it was. `no_reason`: nobody knows any more.
int output_problem();
inline constexpr int no_reason = -1;

/// Does not return if the parent wants this program to die of SIGPIPE.
void die_of_broken_pipe();

}  // namespace knurl::commandline

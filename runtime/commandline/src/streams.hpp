#pragma once
// Makes the three standard streams safe, in whatever state they are: see guarded() in program.hpp.

namespace knurl::commandline {

/// Call before any file is opened.
void secure_streams();

/// The errno of output that could not be written; 0: all was written. `no_reason`: the error is no longer
/// known.
int output_problem();
inline constexpr int no_reason = -1;

/// Does not return if the parent lets SIGPIPE end this program.
void die_of_broken_pipe();

}  // namespace knurl::commandline

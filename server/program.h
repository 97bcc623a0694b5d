// ringdownd: reads the command line and the settings file into DaemonOptions, then plays until a signal comes, or
// renders a file. Failures are written to standard error, one sentence each; the exit code follows from the error's
// kind. [main]
#pragma once

namespace ringdown::server {

// Runs the daemon and returns its exit code.
int run_program(int argc, char** argv);

}  // namespace ringdown::server

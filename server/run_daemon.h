// What ringdownd does once its options are known: plays until a signal, or renders a file. [main]
#pragma once

#include "protocol/exit_codes.h"
#include "server/options.h"

namespace ringdown::server {

// Runs until SIGINT, SIGTERM, /quit or the end of `seconds`. Failures are written to standard error, one sentence each.
// Blocks both signals for the whole process.
protocol::ExitCode run_daemon(const DaemonOptions& options);

}  // namespace ringdown::server

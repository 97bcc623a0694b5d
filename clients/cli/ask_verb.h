// What the verbs that talk to a daemon share: --to, --timeout, and saying what the daemon answered.
#pragma once

#include "clients/cli/verb.h"
#include "protocol/defaults.h"
#include "protocol/wire/message.h"

#include <string>

namespace ringdown::cli {

struct DaemonOptions {
  std::string url = "osc.udp://127.0.0.1:" + std::to_string(protocol::kDefaultPort);
  double timeout_s = 2;
};

// Adds the options to a verb; `options` must outlive the parsing.
void add_daemon_options(CLI::App& verb, DaemonOptions& options);

// Sends the message and prints what is answered: nothing for a silent success, else one line per argument.
ExitCode ask_and_print(const DaemonOptions& options, const wire::Message& message);

}  // namespace ringdown::cli

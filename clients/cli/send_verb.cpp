#include "clients/cli/ask_verb.h"
#include "protocol/schema.h"

#include <CLI/CLI.hpp>

#include <memory>

namespace ringdown::cli {
namespace {

struct SendOptions {
  DaemonOptions daemon;
  std::string address;
  std::vector<std::string> words;
};

ExitCode send(const SendOptions& options) {
  const auto message = protocol::compose(options.address, options.words);
  if (!message) return complain(message.error().message, ExitCode::usage);
  return ask_and_print(options.daemon, *message);
}

}  // namespace

void add_send_verb(CLI::App& app, ExitCode& outcome) {
  auto options = std::make_shared<SendOptions>();
  CLI::App* verb = app.add_subcommand("send", "Sends any message of the protocol and prints the daemon's answer.");
  verb->add_option("address", options->address, "Such as /status or /object/bell/gain; `ringdown protocol` lists all.")
      ->required();
  verb->add_option("arguments", options->words, "What the address takes, such as 0.5");
  add_daemon_options(*verb, options->daemon);
  verb->callback([options, &outcome] { outcome = send(*options); });
}

}  // namespace ringdown::cli

// ringdownd: command line to DaemonOptions.
#include "server/daemon.h"
#include "server/options.h"

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

int main(int argc, char** argv) {
  using ringdown::protocol::ExitCode;
  spdlog::set_default_logger(spdlog::stderr_color_mt("ringdownd"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");

  ringdown::server::DaemonOptions options;
  CLI::App app("Rings solid objects: a JACK client, struck by OSC messages (docs/protocol.md).", "ringdownd");
  app.set_version_flag("--version", RINGDOWN_VERSION);
  app.footer(std::string(ringdown::protocol::kExitCodeHelp));
  ringdown::server::add_options(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for = error.get_exit_code() == 0;  // --help, --version
    return app.exit(error) == 0 && asked_for ? 0 : static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(ringdown::server::run_daemon(options));
}

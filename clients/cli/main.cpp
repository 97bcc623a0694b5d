// The `ringdown` program: one command with verbs.
#include "clients/cli/verb.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>

namespace ringdown::cli {

ExitCode complain(std::string_view sentence, ExitCode code) {
  std::fprintf(stderr, "ringdown: %.*s\n", static_cast<int>(sentence.size()), sentence.data());
  return code;
}

}  // namespace ringdown::cli

int main(int argc, char** argv) {
  using namespace ringdown::cli;
  CLI::App app("Solid objects as playable, physically exact sound.", "ringdown");
  app.set_version_flag("--version", std::string("ringdown ") + RINGDOWN_VERSION);
  app.require_subcommand(1);
  app.footer(std::string(ringdown::protocol::kExitCodeHelp));

  ExitCode outcome = ExitCode::ok;
  add_bake_verb(app, outcome);
  add_info_verb(app, outcome);
  add_render_verb(app, outcome);
  add_strike_verb(app, outcome);
  add_send_verb(app, outcome);
  add_protocol_verb(app, outcome);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(outcome);
}

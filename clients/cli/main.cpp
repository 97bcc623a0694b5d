// The `ringdown` program: one command with verbs.
#include "clients/cli/verb.h"
#include "manual/option.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <string>

namespace ringdown::cli {

ExitCode complain(std::string_view sentence, ExitCode code) {
  std::fprintf(stderr, "ringdown: %.*s\n", static_cast<int>(sentence.size()), sentence.data());
  return code;
}

}  // namespace ringdown::cli

namespace {

// What the man page says beside the options.
const std::vector<ringdown::manual::Section> kSections = {
    {"ENVIRONMENT",
     {{"RINGDOWN_PRESETS", "Folder of the presets, where it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown info bell.glb", "The modes of a bank."},
      {"ringdown strike bell --at 0.1,0,0.05 --impulse -0.2,0,0", "A blow of 0.2 N s, played by the daemon."},
      {"ringdown render --scene demo.toml -o demo.wav", "A scene as a sound file; no daemon is needed."}}},
    {"SEE ALSO",
     {{"ringdownd(1), ringdown-bake(1), ringdown-fit(1)",
       "The daemon, and what `ringdown bake` and `ringdown fit` run."}}},
};

}  // namespace

int main(int argc, char** argv) {
  using namespace ringdown::cli;
  CLI::App app("Solid objects as playable, physically exact sound.", "ringdown");
  app.set_version_flag("--version", std::string("ringdown ") + RINGDOWN_VERSION);
  app.require_subcommand(1);
  app.footer(ringdown::protocol::exit_code_help());

  ExitCode outcome = ExitCode::ok;
  add_program_verb(app, outcome, "bake", "Turns a mesh and a material into a bank.");
  add_program_verb(app, outcome, "check", "Says what is wrong with a mesh, and how it would be meshed.");
  add_program_verb(app, outcome, "fit", "Finds the modes of a struck object in a recording, as a bank.");
  add_program_verb(app, outcome, "tune", "Finds parameters of a geometry at which modes hit their notes.");
  add_info_verb(app, outcome);
  add_materials_verb(app, outcome);
  add_scale_verb(app, outcome);
  add_render_verb(app, outcome);
  add_strike_verb(app, outcome);
  add_send_verb(app, outcome);
  add_protocol_verb(app, outcome);
  ringdown::manual::add_manual_option(app, kSections);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(outcome);
}

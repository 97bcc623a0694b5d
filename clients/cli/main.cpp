// The `ringdown` program: one command with verbs.
#include "clients/cli/verb.h"
#include "engine/base/formatted.h"
#include "packaging/manual/command_line.h"
#include "protocol/help.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <unistd.h>

namespace {

using namespace ringdown;
using namespace ringdown::cli;

// Replaces this process by the program `name`, which lies beside this one. Returns only when that fails.
ExitCode become(const std::string& name, std::vector<std::string> arguments) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / name).string();
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  return complain({ErrorKind::refused, formatted("cannot run {}: {}; it is a separate program: ./run build {} builds "
                                                 "it, and there are packages (docs/use/start.md)",
                                                 program, std::strerror(errno), name.substr(name.find('-') + 1))});
}

// A verb that is a program of its own, ringdown-NAME, because it links what this program should not.
void add_program_verb(manual::App& app, ExitCode& outcome, const std::string& name, const std::string& sentence) {
  app.add_passing_verb(
      name, sentence + " See ringdown " + name + " --help.",
      [name, &outcome](std::vector<std::string> words) { outcome = become("ringdown-" + name, words); });
}

void add_protocol_verb(manual::App& app, ExitCode& outcome) {
  auto as_markdown = std::make_shared<bool>(false);
  manual::App* verb = app.add_subcommand("protocol", "Lists every OSC address with its arguments.");
  verb->add_flag("--markdown", *as_markdown, "Prints the whole manual, as in docs/reference/protocol.md.");
  verb->callback([as_markdown, &outcome] {
    const std::string text = *as_markdown ? protocol::markdown() : protocol::overview();
    const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    if (!written) outcome = complain({ErrorKind::input_output, "cannot write to the standard output"});
  });
}

// The text of the man page in addition to the options.
const std::vector<manual::Section> kSections = {
    {"ENVIRONMENT", {{"RINGDOWN_PRESETS", "Folder of the presets, if it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown info bell.glb", "Prints the modes of a bank."},
      {"ringdown strike bell --at 0.1,0,0.05 --impulse -0.2,0,0", "Lets the daemon play a blow of 0.2 N s."},
      {"ringdown render --scene demo.toml -o demo.wav", "Renders a scene to a sound file, without a daemon."}}},
    {"SEE ALSO",
     {{"ringdownd(1), ringdown-bake(1), ringdown-fill(1), ringdown-fit(1), ringdown-compare(1), ringdown-frf(1), "
       "ringdown-picture(1)",
       "The daemon, and the programs that `ringdown bake`, `fill`, `fit`, `compare`, `frf` and `picture` start."}}},
};

}  // namespace

int main(int argc, char** argv) {
  manual::App app("Solid objects as playable, physically exact sound.", "ringdown");
  app.require_subcommand(1);
  ExitCode outcome = ExitCode::ok;
  add_program_verb(app, outcome, "bake", "Turns a mesh and a material into a bank.");
  add_program_verb(app, outcome, "check", "Lists the faults of a mesh, and says how it would be meshed.");
  add_program_verb(app, outcome, "compare", "Compares recordings of an object with its baked bank.");
  add_program_verb(app, outcome, "fill", "Fills the body of a finished bank with a liquid.");
  add_program_verb(app, outcome, "fit", "Finds the modes of a struck object in a recording, as a bank.");
  add_program_verb(app, outcome, "frf", "Computes frequency responses of a bank.");
  add_program_verb(app, outcome, "picture", "Draws a bank, as a picture or as a page.");
  add_program_verb(app, outcome, "tune", "Finds parameters of a geometry at which modes hit their notes.");
  add_info_verb(app, outcome);
  add_materials_verb(app, outcome);
  add_scale_verb(app, outcome);
  add_render_verb(app, outcome);
  add_foley_verb(app, outcome);
  add_export_verb(app, outcome);
  add_scene_verb(app, outcome);
  add_strike_verb(app, outcome);
  add_send_verb(app, outcome);
  add_protocol_verb(app, outcome);
  return protocol::exit_status([&] { return manual::parse(app, argc, argv, kSections).value_or(outcome); });
}

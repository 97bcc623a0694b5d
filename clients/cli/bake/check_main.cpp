// ringdown-check: what is wrong with a mesh, what would be repaired, and how it would be meshed. `ringdown check ...`
// runs this program.
//
// Exit codes (protocol/exit_codes.h): ok when the file can be baked, repaired or not; bad_input when it cannot; usage;
// failure when the repaired surface cannot be written; cancelled.
#include "clients/cli/bake/cancellable.h"
#include "clients/cli/bake/check_mesh.h"
#include "clients/cli/bake/length_unit.h"
#include "engine/base/preset_folder.h"
#include "manual/option.h"

#include <CLI/CLI.hpp>

#include <cstdio>

namespace {

using namespace ringdown;
using protocol::ExitCode;

const std::vector<manual::Section> kSections = {
    {"ENVIRONMENT",
     {{"RINGDOWN_PRESETS", "Folder of the presets, where it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-check mesh cup.stl --unit mm", "Faults, repairs, and the mesh it would get."},
      {"ringdown-check mesh scan.ply -o repaired.ply", "The repaired surface as a file."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1)", "The other programs."}}},
};

ExitCode complain(const std::string& message, ExitCode code) {
  std::fprintf(stderr, "ringdown-check: %s\n", message.c_str());
  return code;
}

ExitCode run(int argc, char** argv) {
  CLI::App app("Looks at a file before it is baked.", "ringdown-check");
  app.set_version_flag("--version", "ringdown-check " RINGDOWN_VERSION);
  app.require_subcommand(1);
  app.footer(protocol::exit_code_help());
  cli::CheckRequest request;
  std::optional<std::string> unit;
  CLI::App* mesh =
      app.add_subcommand("mesh", "Faults of a surface, of tetrahedra or of a geometry, and what they lead to.");
  mesh->add_option("file", request.file, "a surface (.stl .obj .ply .glb), a geometry or a mesh")
      ->type_name("FILE")
      ->required();
  mesh->add_option("--unit", unit, cli::kUnitHelp)->type_name("LENGTH")->check(cli::check_unit);
  mesh->add_option("-m,--material", request.material, "the material that the mesh is chosen for (default steel)");
  mesh->add_option("--materials", request.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  mesh->add_option("-o,--output", request.output, "where to write the repaired surface (.ply), in metres")
      ->type_name("FILE");
  manual::add_manual_option(app, kSections);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return static_cast<ExitCode>(app.exit(help_or_version));
  } catch (const CLI::ParseError& error) {
    return complain(std::string(error.what()) + "; ringdown-check mesh --help lists the options", ExitCode::usage);
  }
  if (unit) request.unit_m = cli::parse_unit(*unit);
  if (request.materials.empty()) {
    const Result<std::filesystem::path> presets = preset_folder();
    if (!presets) return complain(presets.error().message, ExitCode::failure);
    request.materials = *presets / "materials";
  }
  return cli::run_cancellable([&](const std::stop_token&) {
    const cli::CheckOutcome outcome = cli::check_mesh(request);
    return outcome.error.empty() ? outcome.exit_code : complain(outcome.error, outcome.exit_code);
  });
}

}  // namespace

int main(int argc, char** argv) { return static_cast<int>(run(argc, argv)); }

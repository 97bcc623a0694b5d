// ringdown-bake: turns shapes and materials into banks. `ringdown bake ...` runs this program.
//
// Exit codes (protocol/exit_codes.h): ok; usage; bad_input when an object cannot be baked; failure when a bank cannot
// be written; cancelled. One sentence on stderr says why. In a folder, an object that
// fails does not stop the others.
#include "clients/cli/bake/bake_report.h"
#include "clients/cli/bake/folder_command.h"
#include "clients/cli/long_work.h"
#include "clients/cli/bake/options.h"
#include "clients/cli/bake/scene_bake.h"
#include "engine/bake/bake_object.h"
#include "engine/bake/input_hash.h"
#include "engine/bake/makeup_file.h"
#include "engine/base/content_cache.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/base/range.h"
#include "engine/modal/bank_file.h"
#include "packaging/manual/command_line.h"

#include <cstdio>
#include <new>
#include <unistd.h>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

using manual::complain_of_usage;
using protocol::complain;
using protocol::ExitCode;

// The arguments of the command line. An option that is not given leaves the object file's value, or the default.
struct Arguments {
  fs::path input, output, materials;
  std::optional<std::string> material, name, element, error, shape_error, solver, unit;
  std::optional<double> mesh_size_m, scale;
  std::optional<std::size_t> points;
  std::optional<int> keep, nonlinear, coupled;
  std::optional<double> floor_db;
  std::optional<int> processes;
  std::vector<double> band_hz, air;
  std::vector<std::string> supports;  // each a [[support]] in one line
  std::map<std::string, double> parameters, figures;
  std::vector<std::string> shaping;  // the given options that can change a bank
  cli::FolderBake folder;
  bool update = false, progress_lines = false;
  bool progress = false, quiet = false, no_cache = false, preview = false, verify = false, compress = false;
  bool cavities = false, force_coarse = false, radiation = false;
};

// NAME=NUMBER as given.
struct Settings {
  std::vector<std::string> parameters, figures;
};

void add_options(manual::App& app, Arguments& arguments, Settings& settings) {
  app.add_option("input", arguments.input,
                 "an object (.toml), a surface (" + example_endings({FileKind::surface, FileKind::gltf}) +
                     "), a geometry (" + example_endings({FileKind::program, FileKind::geometry}) + "), a mesh (" +
                     example_endings({FileKind::gmsh_mesh}) +
                     " ...), a folder of them, or a scene (.glb .gltf) whose bodies have acoustic materials")
      ->type_name("FILE");
  app.add_option("-o,--output", arguments.output,
                 "the bank to write (.glb); of a folder, where to (default: beside); of a scene, another file "
                 "(default: itself)")
      ->type_name("FILE");
  app.add_option("-m,--material", arguments.material,
                 "name of a material; an object file has one already, and keeps it when a folder is baked");
  app.add_option("--materials", arguments.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  app.add_option("--name", arguments.name, "name kept in the bank (default: the input's)");
  app.add_option("-e,--element", arguments.element,
                 "tet20 (default), tet10, tet35; tet4 and tet4-lumped are far too stiff in bending")
      ->type_name("tet20|tet10|tet35|tet4|tet4-lumped");
  app.add_option("--mesh-size", arguments.mesh_size_m,
                 "longest edge in metres, when a surface or a geometry is meshed (default: by the band)")
      ->check(manual::above_zero());
  app.add_option("--set", settings.parameters, "a parameter of a .geo file, in its unit")->type_name("NAME=NUMBER");
  app.add_option("--unit", arguments.unit, cli::kUnitHelp)->type_name("LENGTH")->check(cli::check_unit);
  app.add_flag("--cavities", arguments.cavities,
               "shells inside others are cavities, however they are wound (default: those wound the other way)");
  app.add_flag("--force-coarse", arguments.force_coarse,
               "bake even what has walls too thin to be meshed, with holes in them and a wrong sound");
  app.add_option("--scale", arguments.scale, "how many times as large as its geometry; the mesh stays the same")
      ->check(manual::between(bake::kScale.low, bake::kScale.high));
  app.add_option("--set-material", settings.figures, "a figure of the material, e.g. poisson_ratio=0.31")
      ->type_name("NAME=NUMBER");
  app.add_option("--support", arguments.supports,
                 "a [[support]] beside those of the object file, in one line; lengths in metres before --scale")
      ->type_name("TEXT")
      ->allow_extra_args(false);
  const auto check_shape_error = [](const std::string& text) {
    const Result<void> good = parse_fraction(text).and_then([](double e) { return check_range(e, bake::kShapeError); });
    return good ? std::string() : good.error().message;
  };
  app.add_option("--shape-error", arguments.shape_error,
                 "error of the median mode's amplitude where a strike falls between sample points (default 3%)")
      ->type_name("PERCENT")
      ->check(check_shape_error);
  app.add_option("--points", arguments.points,
                 "so many sample points on the surface (default: as many as --shape-error takes)")
      ->check(manual::between(4, 1 << 20));
  app.add_option("--band", arguments.band_hz, "LOW HIGH in Hz (default 20 20000)")
      ->expected(2)
      ->check(manual::any_number());
  app.add_option("--keep", arguments.keep,
                 "how many modes, the most important ones, but all those of --nonlinear (default: all in the band)")
      ->check(manual::between(1, 16384));
  app.add_option("--floor", arguments.floor_db,
                 "drop modes that no blow makes audible, this many dB below the loudest or masked (default: none)")
      ->check(manual::between(1.0, 200.0));
  app.add_option(
         "--nonlinear", arguments.nonlinear,
         "how many of the lowest modes bend each other's pitch when struck hard; for thin bodies (default: none)")
      ->check(manual::between(0, bake::kMaxNonlinearModes));
  app.add_option("--coupled", arguments.coupled,
                 "how many of these, the lowest, exchange energy while they are loud: a gong's build-up, up to half a "
                 "core for each object (default: none)")
      ->check(manual::between(0, static_cast<int>(modal::kMaxCoupled)));
  app.add_flag("--radiation", arguments.radiation,
               "compute what each mode radiates, and what the air takes of it: minutes");
  app.add_option(
         "--air", arguments.air,
         "what the modes radiate into: DENSITY in kg/m3 and SPEED of sound in m/s (default 1.2041 343.2, dry air "
         "at 20 degrees); implies --radiation")
      ->expected(2)
      ->check(manual::above_zero());
  const auto check_error = [](const std::string& text) {
    const Result<void> good = parse_fraction(text).and_then([](double e) { return check_range(e, bake::kError); });
    return good ? std::string() : good.error().message;
  };
  manual::Option* error =
      app.add_option("--error", arguments.error,
                     "refine until the estimated error of every frequency is below this: 0.1%, or 0.001")
          ->type_name("PERCENT")
          ->check(check_error);
  app.add_flag("--preview", arguments.preview, "coarse and quick: order 2, an error that it says")->excludes(error);
  app.add_flag("--no-cache", arguments.no_cache,
               "neither use nor keep earlier results (in $RINGDOWN_CACHE, or ringdown in the user's cache folder)");
  app.add_option("--solver", arguments.solver,
                 "auto (default), block, spectra, dense, or slepc: over MPI, for meshes that outgrow one machine")
      ->type_name("auto|block|spectra|dense|slepc");
  app.add_option("--processes", arguments.processes, "of --solver slepc (default 2)")->check(manual::between(1, 4096));
  app.add_flag("--verify", arguments.verify,
               "have a second solver find the modes near two frequencies of the band, and fail when the two disagree");
  app.add_flag("--compress", arguments.compress,
               "make the bank a third as large, with shapes rounded by up to 0.5 %; its readers must know glTF's "
               "EXT_meshopt_compression, as Ringdown does");
  cli::add_folder_options(app, arguments.folder, arguments.update, arguments.progress_lines);
  app.add_flag("--progress", arguments.progress, "show progress even when stderr is not a terminal");
  app.add_flag("-q,--quiet", arguments.quiet, "print nothing but errors");
}

Result<bake::ObjectRecipe> recipe_for(const fs::path& input, const Arguments& arguments) {
  bake::ObjectRecipe recipe;
  if (is_of_kind(input, FileKind::table)) {
    Result<bake::ObjectRecipe> object = bake::read_object(input);
    if (!object) return object;
    recipe = std::move(*object);
  } else {
    if (!arguments.material)
      return fail(ErrorKind::bad_input, "name a material for " + input.string() + " with --material");
    recipe.name = input.stem().string();
    recipe.geometry = input;
  }
  if (arguments.material) recipe.material = *arguments.material;
  recipe.other_material = arguments.material.has_value();
  if (arguments.name) recipe.name = *arguments.name;
  if (arguments.element) {
    const Result<fem::Element> element = fem::parse_element(*arguments.element);
    if (!element) return fail(element.error());
    recipe.options.element = *element;
    recipe.meshing.order = fem::order_of(*element);
  }
  if (arguments.solver) {
    const Result<solve::Method> solver = solve::parse_method(*arguments.solver);
    if (!solver) return fail(solver.error());
    recipe.options.solver = *solver;
  }
  if (arguments.verify) recipe.options.verify = true;
  if (arguments.processes) recipe.options.processes = *arguments.processes;
  if (arguments.mesh_size_m) recipe.meshing.mesh_size_m = *arguments.mesh_size_m;
  if (arguments.unit) recipe.meshing.unit_m = cli::parse_unit(*arguments.unit);
  if (arguments.cavities) recipe.meshing.cavities = true;
  if (arguments.force_coarse) recipe.meshing.force_coarse = true;
  const bool is_other_body = arguments.material || !arguments.figures.empty() || !arguments.parameters.empty() ||
                             !arguments.supports.empty() || arguments.unit;
  if (is_other_body) recipe.pitch_hz.reset();  // the object file states that of its own body
  if (arguments.scale) {
    if (recipe.pitch_hz) *recipe.pitch_hz *= recipe.scale / *arguments.scale;
    recipe.scale = *arguments.scale;
  }
  recipe.figures = arguments.figures;
  for (const std::string& text : arguments.supports) {
    const Result<bake::Support> support = bake::parse_support(text);
    if (!support) return fail(support.error());
    recipe.options.makeup.supports.push_back(*support);
  }
  if (arguments.points) recipe.options.points = *arguments.points;
  if (arguments.shape_error) recipe.options.shape_error = parse_fraction(*arguments.shape_error).value();
  if (arguments.keep) recipe.options.keep_modes = *arguments.keep;
  if (arguments.nonlinear) recipe.options.nonlinear = *arguments.nonlinear;
  if (arguments.coupled) recipe.options.coupled = *arguments.coupled;
  if (recipe.options.coupled > recipe.options.nonlinear)
    return fail(ErrorKind::bad_input, "--coupled modes are among the --nonlinear ones: at most as many");
  if (arguments.floor_db) recipe.options.floor_db = *arguments.floor_db;
  if (arguments.error) recipe.error = parse_fraction(*arguments.error).value();
  recipe.preview = arguments.preview;
  if (recipe.preview) recipe.error = 0;
  if (!arguments.no_cache) recipe.options.cache = cache_folder().value_or("");
  if (arguments.band_hz.size() == 2) {
    recipe.options.band_low_hz = arguments.band_hz[0];
    recipe.options.band_high_hz = arguments.band_hz[1];
  }
  if (arguments.radiation && !recipe.options.air) recipe.options.air = modal::Air{};
  if (arguments.air.size() == 2) {
    const double density = arguments.air[0], speed = arguments.air[1];
    if (!bake::kAirDensity_kg_m3.holds(density) || !bake::kSoundSpeed_m_s.holds(speed))
      return fail(ErrorKind::bad_input, "--air takes a density of 0.001 to 1000 kg/m3 and a speed of 10 to 10000 m/s");
    recipe.options.air = modal::Air{.density_kg_m3 = density, .sound_speed_m_s = speed};
  }
  for (const auto& [name, value] : arguments.parameters) recipe.meshing.parameters[name] = value;
  return recipe;
}

cli::ProgressLine::Style progress_style(const Arguments& arguments) {
  using Style = cli::ProgressLine::Style;
  if (arguments.progress_lines) return Style::lines;
  return !arguments.quiet && (arguments.progress || ::isatty(STDERR_FILENO)) ? Style::bar : Style::none;
}

ExitCode bake_one(const fs::path& input, const fs::path& output, const Arguments& arguments,
                  const std::stop_token& stop) {
  const Result<bake::ObjectRecipe> recipe = recipe_for(input, arguments);
  if (!recipe) return complain(recipe.error());
  const std::string hash = bake::input_hash({.object = input,
                                             .geometry = recipe->geometry,
                                             .material = arguments.materials / (recipe->material + ".toml"),
                                             .options = arguments.shaping,
                                             .part_materials = bake::part_materials(*recipe, arguments.materials),
                                             .part_surfaces = bake::part_surfaces(*recipe)})
                               .value_or("");
  if (arguments.update && !hash.empty() && modal::read_input_hash(output) == hash) {
    if (!arguments.quiet) std::printf("%s: unchanged\n", recipe->name.c_str());
    return ExitCode::ok;
  }
  cli::ProgressLine line(recipe->name, progress_style(arguments));
  const Result<bake::BakedObject> object =
      bake::bake_object(*recipe, arguments.materials, [&](std::string_view stage, double fraction) {
        line.show(stage, fraction);
        return !stop.stop_requested();
      });
  line.clear();
  if (!object) return cli::complain_unwritten(object.error(), output);
  const auto compression = arguments.compress ? modal::Compression::meshopt : modal::Compression::none;
  if (auto written = modal::write_bank(object->baked.bank, output, hash, compression); !written)
    return complain(written.error());
  if (!arguments.quiet) cli::print_report(*recipe, *object, output);
  return ExitCode::ok;
}

ExitCode bake_scene(const Arguments& arguments, const std::stop_token& stop) {
  const cli::SceneBake request{.input = arguments.input,
                               .output = arguments.output.empty() ? arguments.input : arguments.output,
                               .materials = arguments.materials,
                               .recipe_for =
                                   [&arguments](const fs::path& geometry) {
                                     Arguments of_body = arguments;
                                     of_body.material = "of the scene";
                                     return recipe_for(geometry, of_body);
                                   },
                               .style = progress_style(arguments),
                               .quiet = arguments.quiet};
  return cli::bake_scene(request, stop);
}

ExitCode bake_folder(const manual::App& app, const Arguments& arguments) {
  cli::FolderBake request = arguments.folder;
  request.output = arguments.output;
  request.materials = arguments.materials;
  request.material = arguments.material;
  request.quiet = arguments.quiet;
  request.progress = arguments.progress;
  return cli::run_folder_bake(app, std::move(request));
}

// The text of the man page beside the options.
const std::vector<manual::Section> kSections = {
    {"FILES", {{"$XDG_CACHE_HOME/ringdown", "What earlier bakes found, so that no mesh is solved twice."}}},
    {"ENVIRONMENT",
     {{"RINGDOWN_CACHE", "Another folder for that."},
      {"RINGDOWN_THREADS", "How many threads it may use (default: as many as there are processors)."},
      {"RINGDOWN_MESH_SECONDS", "Processor time for reading or meshing a file (default 600)."},
      {"RINGDOWN_MESH_MIB", "Memory for that (default: half of the computer's, at most 16384)."},
      {"RINGDOWN_PRESETS", "Folder of the presets, where it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-bake bell.toml -o bell.glb", "An object file names its shape and its material."},
      {"ringdown-bake objects -o banks --jobs 4", "What has changed of a folder, four at a time."},
      {"ringdown-bake room.glb", "Each body of a scene that has an acoustic material and no model gets its own."},
      {"ringdown-bake cup.stl --unit mm --material steel -o cup.glb", "A surface of your own, in millimetres."}}},
    {"SEE ALSO", {{"ringdown(1), ringdownd(1)", "The other programs."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Bakes an object's shape and material into a bank of its modes.", "ringdown-bake");
  Arguments arguments;
  Settings settings;
  add_options(app, arguments, settings);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  if (arguments.input.empty()) return complain_of_usage(app, "give an input, or a folder of them");
  if (auto chosen = cli::choose_folder(app, arguments.input, arguments.folder); !chosen) {
    const bool is_usage = chosen.error().kind == ErrorKind::usage;
    return is_usage ? complain_of_usage(app, chosen.error().message) : complain(chosen.error());
  }
  const bool in_scene = arguments.folder.folder.empty() && !arguments.material && cli::has_surfaces(arguments.input);
  for (const char* name : cli::kNotForScenes) {
    if (in_scene && app.count(name) > 0)
      return complain_of_usage(app, std::string(name) + " is not for scenes, and " + arguments.input.string() +
                                        " is one; with --material it is a surface");
  }
  if (arguments.output.empty() && arguments.folder.folder.empty() && !in_scene) {
    return complain_of_usage(app, "say with --output where to write");
  }
  auto read = cli::read_settings("--set", settings.parameters, arguments.parameters);
  if (read) read = cli::read_settings("--set-material", settings.figures, arguments.figures);
  if (!read) return complain_of_usage(app, read.error().message);
  const Result<fs::path> materials = material_folder(arguments.materials);
  if (!materials) return complain(materials.error());
  arguments.materials = *materials;
  if (!arguments.progress_lines) cli::warn_of_open_sandbox();  // a folder's parent has said it
  if (!arguments.folder.folder.empty()) return bake_folder(app, arguments);
  arguments.shaping = cli::shaping_options(app);
  keep_stdout_for(arguments.output);
  return cli::run_cancellable([&](const std::stop_token& stop) {
    try {
      if (in_scene) return bake_scene(arguments, stop);
      return bake_one(arguments.input, arguments.output, arguments, stop);
    } catch (const std::bad_alloc&) {
      return complain({ErrorKind::no_memory, "there is not enough memory to bake " + arguments.input.string() +
                                                 "; a larger --mesh-size or a lower --element needs less"});
    }
  });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}

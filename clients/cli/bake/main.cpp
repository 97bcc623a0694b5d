// ringdown-bake: shapes and materials to banks. `ringdown bake ...` runs this program.
//
// Exit codes (protocol/exit_codes.h): ok; usage; bad_input when an object cannot be baked; failure when a bank cannot
// be written; cancelled. One sentence on stderr says why. Of a folder the others are baked all the same.
#include "clients/cli/bake/body_lines.h"
#include "clients/cli/bake/cancellable.h"
#include "clients/cli/bake/folder_command.h"
#include "clients/cli/bake/length_unit.h"
#include "clients/cli/bake/progress_line.h"
#include "engine/bake/input_hash.h"
#include "engine/bake/object_file.h"
#include "engine/base/content_cache.h"
#include "engine/base/fraction.h"
#include "engine/base/preset_folder.h"
#include "engine/modal/bank_file.h"
#include "manual/option.h"
#include "protocol/exit_codes.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <new>
#include <unistd.h>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

using protocol::ExitCode;

// What the command line says; an option that is not given leaves the object file's or the default value.
struct Arguments {
  fs::path input, output, materials;
  std::optional<std::string> material, name, element, error, solver, unit;
  std::optional<double> mesh_size_m, scale;
  std::optional<std::size_t> points;
  std::optional<int> keep;
  std::optional<double> floor_db;
  std::optional<int> processes;
  std::vector<double> band_hz;
  std::map<std::string, double> parameters, figures;
  std::vector<std::string> shaping;  // the options among these that can change a bank, as they were given
  cli::FolderBake folder;
  bool update = false, progress_lines = false;
  bool progress = false, quiet = false, no_cache = false, preview = false;
};

// NAME=NUMBER as given.
struct Settings {
  std::vector<std::string> parameters, figures;
};

void add_options(CLI::App& app, Arguments& arguments, Settings& settings) {
  app.add_option("input", arguments.input,
                 "an object (.toml), a surface (.stl .obj .ply .glb), a geometry (.geo .step .brep), a mesh (.msh .vtk "
                 "...), or a folder of them")
      ->type_name("FILE");
  app.add_option("-o,--output", arguments.output, "the bank to write (.glb); of a folder, where to (default: beside)")
      ->type_name("FILE");
  app.add_option("-m,--material", arguments.material,
                 "name of a material; an object file has one already, and keeps it when a folder is baked");
  app.add_option("--materials", arguments.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  app.add_option("--name", arguments.name, "name kept in the bank (default: the input's)");
  app.add_option("-e,--element", arguments.element,
                 "tet20 (default), tet10, tet35, tet4, or tet4-lumped: the 2011 report's, far too stiff in bending")
      ->type_name("tet20|tet10|tet35|tet4|tet4-lumped");
  app.add_option("--mesh-size", arguments.mesh_size_m,
                 "longest edge in metres, when a surface or a geometry is meshed (default: by the band)")
      ->check(CLI::PositiveNumber);
  app.add_option("--set", settings.parameters, "a parameter of a .geo file, in its unit")->type_name("NAME=NUMBER");
  app.add_option("--unit", arguments.unit, cli::kUnitHelp)->type_name("LENGTH")->check(cli::check_unit);
  app.add_option("--scale", arguments.scale, "how many times as large as its geometry; the mesh stays the same")
      ->check(CLI::Range(bake::kScale.low, bake::kScale.high));
  app.add_option("--set-material", settings.figures, "a figure of the material, e.g. poisson_ratio=0.31")
      ->type_name("NAME=NUMBER");
  app.add_option("--points", arguments.points, "surface points in the bank (default 200)")
      ->check(CLI::Range(4, 1 << 20));
  app.add_option("--band", arguments.band_hz, "LOW HIGH in Hz (default 20 20000)")->expected(2);
  app.add_option("--keep", arguments.keep, "how many modes, the most important ones (default: all in the band)")
      ->check(CLI::Range(1, 16384));
  app.add_option("--floor", arguments.floor_db,
                 "drop modes that no blow makes audible, this many dB below the loudest or masked (default: none)")
      ->check(CLI::Range(1.0, 200.0));
  const auto check_error = [](const std::string& text) {
    const Result<void> good = parse_fraction(text).and_then([](double e) { return check_range(e, bake::kError); });
    return good ? std::string() : good.error().message;
  };
  CLI::Option* error =
      app.add_option("--error", arguments.error,
                     "refine until the estimated error of every frequency is below this: 0.1%, or 0.001")
          ->check(check_error);
  app.add_flag("--preview", arguments.preview, "coarse and quick: order 2, few points, an error that it says")
      ->excludes(error);
  app.add_flag("--no-cache", arguments.no_cache,
               "neither use nor keep earlier results (in $RINGDOWN_CACHE, or ringdown in the user's cache folder)");
  app.add_option("--solver", arguments.solver,
                 "auto (default), block, spectra, dense, or slepc: over MPI, for meshes that outgrow one machine")
      ->type_name("auto|block|spectra|dense|slepc");
  app.add_option("--processes", arguments.processes, "of --solver slepc (default 2)")->check(CLI::Range(1, 4096));
  cli::add_folder_options(app, arguments.folder, arguments.update, arguments.progress_lines);
  app.add_flag("--progress", arguments.progress, "show progress even when stderr is not a terminal");
  app.add_flag("-q,--quiet", arguments.quiet, "print nothing but errors");
  app.footer(protocol::exit_code_help());
}

Result<void> read_settings(const char* option, const std::vector<std::string>& settings,
                           std::map<std::string, double>& parameters) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string text = equals == std::string::npos ? "" : setting.substr(equals + 1);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (equals == 0 || text.empty() || *end != '\0')
      return fail(ErrorKind::bad_input, std::string(option) + " wants NAME=NUMBER, not '" + setting + "'");
    parameters[setting.substr(0, equals)] = value;
  }
  return {};
}

Result<bake::ObjectRecipe> recipe_for(const fs::path& input, const Arguments& arguments) {
  bake::ObjectRecipe recipe;
  if (input.extension() == ".toml") {
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
  if (arguments.processes) recipe.options.processes = *arguments.processes;
  if (arguments.mesh_size_m) recipe.meshing.mesh_size_m = *arguments.mesh_size_m;
  if (arguments.unit) recipe.meshing.unit_m = cli::parse_unit(*arguments.unit);
  if (arguments.scale) recipe.scale = *arguments.scale;
  recipe.figures = arguments.figures;
  if (arguments.points) recipe.options.most_points = *arguments.points;
  if (arguments.keep) recipe.options.keep_modes = *arguments.keep;
  if (arguments.floor_db) recipe.options.floor_db = *arguments.floor_db;
  if (arguments.error) recipe.error = parse_fraction(*arguments.error).value();
  recipe.preview = arguments.preview;
  if (recipe.preview) recipe.error = 0;
  if (!arguments.no_cache) recipe.options.cache = cache_folder().value_or("");
  if (arguments.band_hz.size() == 2) {
    recipe.options.band_low_hz = arguments.band_hz[0];
    recipe.options.band_high_hz = arguments.band_hz[1];
  }
  for (const auto& [name, value] : arguments.parameters) recipe.meshing.parameters[name] = value;
  return recipe;
}

void print_errors(const bake::BakedObject& object) {
  if (const auto& choice = object.choice) {
    std::printf("  mesh size %.3g mm", 1000 * choice->size_m);
    if (choice->edge_size_m > 0 && choice->edge_size_m < choice->size_m) {
      std::printf(", %.3g mm at sharp edges", 1000 * choice->edge_size_m);
    }
    if (choice->shortest_wave_m > 0) std::printf(", for waves of %.3g mm", 1000 * choice->shortest_wave_m);
    if (choice->wall_m > 0) std::printf(", thinnest wall %.3g mm", 1000 * choice->wall_m);
    std::printf("%s\n", choice->bounded ? "; finer would be right, but too much to solve unasked (--mesh-size)" : "");
  }
  if (object.rounds.size() > 1) {
    std::printf("  refined:");
    for (const bake::Round& round : object.rounds) {
      std::printf(" %s %td unknowns %s;", std::string(fem::element_name(round.element)).c_str(), round.unknowns,
                  as_percent(round.error).c_str());
    }
    std::printf("\n");
  }
  const auto spread = modal::error_spread(object.baked.bank);
  if (spread) {
    std::printf("  estimated errors of the frequencies: median %s, largest %s\n", as_percent(spread->median).c_str(),
                as_percent(spread->largest).c_str());
  }
}

void print_summary(const bake::ObjectRecipe& recipe, const bake::BakedObject& object, const fs::path& output) {
  const auto& [bank, report] = object.baked;
  const auto [low, high] = std::minmax_element(bank.frequency_hz.begin(), bank.frequency_hz.end());
  std::error_code error;
  std::printf("%s: %zu modes, %.0f to %.0f Hz, at %zu points -> %s (%.0f kB)\n", recipe.name.c_str(), bank.mode_count(),
              *low, *high, bank.point_count(), output.c_str(),
              static_cast<double>(fs::file_size(output, error)) / 1000);
  std::printf(
      "  %s, %.3f kg; %td elements, %td unknowns; dropped %d rigid, %d below the band, %d over-damped, "
      "%d inaudible, %d unimportant\n",
      bank.material->name.c_str(), bank.mass->mass_kg, report.elements, report.unknowns, report.rigid,
      report.below_band, report.over_damped, report.inaudible, report.unimportant);
  if (bank.provenance.dropped_modes > 0) {
    std::printf("  left out of the band: %lld modes, at most %.1f dB of the energy of a blow\n",
                static_cast<long long>(bank.provenance.dropped_modes), bank.provenance.loss_db);
  }
  if (report.from_cache) std::printf("  from the cache: nothing was solved\n");
  if (!report.cache_trouble.empty()) std::printf("  not kept in the cache: %s\n", report.cache_trouble.c_str());
  std::printf(
      "  seconds: mesh %.1f, assemble %.1f, factors %.1f, modes %.1f, errors %.1f, finish %.1f; largest residual "
      "%.1e\n",
      object.mesh_seconds, report.assemble_seconds, report.factor_seconds, report.iterate_seconds,
      report.estimate_seconds, report.finish_seconds, bank.provenance.largest_residual);
  print_errors(object);
  cli::print_body(object);
  std::fflush(stdout);
}

ExitCode complain(const std::string& message, ExitCode code) {
  std::fprintf(stderr, "ringdown-bake: %s\n", message.c_str());
  return code;
}

cli::ProgressLine::Style progress_style(const Arguments& arguments) {
  using Style = cli::ProgressLine::Style;
  if (arguments.progress_lines) return Style::lines;
  return !arguments.quiet && (arguments.progress || ::isatty(STDERR_FILENO)) ? Style::bar : Style::none;
}

ExitCode bake_one(const fs::path& input, const fs::path& output, const Arguments& arguments,
                  const std::stop_token& stop) {
  const Result<bake::ObjectRecipe> recipe = recipe_for(input, arguments);
  if (!recipe) return complain(recipe.error().message, ExitCode::bad_input);
  const std::string hash = bake::input_hash({.object = input,
                                             .geometry = recipe->geometry,
                                             .material = arguments.materials / (recipe->material + ".toml"),
                                             .options = arguments.shaping})
                               .value_or("");
  if (arguments.update && !hash.empty() && modal::sealed_input_hash(output) == hash) {
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
  if (stop.stop_requested()) return complain("cancelled; " + output.string() + " was not written", ExitCode::cancelled);
  if (!object) return complain(object.error().message, ExitCode::bad_input);
  if (auto written = modal::write_bank(object->baked.bank, output, hash); !written) {
    return complain(written.error().message, ExitCode::failure);
  }
  if (!arguments.quiet) print_summary(*recipe, *object, output);
  return ExitCode::ok;
}

ExitCode bake_folder(const CLI::App& app, const Arguments& arguments) {
  cli::FolderBake request = arguments.folder;
  request.output = arguments.output;
  request.materials = arguments.materials;
  request.material = arguments.material;
  request.quiet = arguments.quiet;
  request.progress = arguments.progress;
  return cli::run_folder_bake(app, std::move(request));
}

ExitCode usage_error(const std::string& message) {
  return complain(message + "; ringdown-bake --help lists the options", ExitCode::usage);
}

// What the man page says beside the options.
const std::vector<manual::Section> kSections = {
    {"FILES", {{"$XDG_CACHE_HOME/ringdown", "What earlier bakes found, so that no mesh is solved twice."}}},
    {"ENVIRONMENT",
     {{"RINGDOWN_CACHE", "Another folder for that."},
      {"RINGDOWN_THREADS", "How many threads it may use (default: as many as there are processors)."},
      {"RINGDOWN_PRESETS", "Folder of the presets, where it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-bake bell.toml -o bell.glb", "An object file names its shape and its material."},
      {"ringdown-bake objects -o banks --jobs 4", "What has changed of a folder, four at a time."},
      {"ringdown-bake cup.stl --unit mm --material steel -o cup.glb", "A surface of your own, in millimetres."}}},
    {"SEE ALSO", {{"ringdown(1), ringdownd(1)", "The other programs."}}},
};

ExitCode run(int argc, char** argv) {
  CLI::App app("Bakes an object's shape and material into a bank of its modes.", "ringdown-bake");
  app.set_version_flag("--version", "ringdown-bake " RINGDOWN_VERSION);
  Arguments arguments;
  Settings settings;
  add_options(app, arguments, settings);
  manual::add_manual_option(app, kSections);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return static_cast<ExitCode>(app.exit(help_or_version));
  } catch (const CLI::ParseError& error) {
    return usage_error(error.what());
  }
  if (arguments.input.empty()) return usage_error("give an input, or a folder of them");
  if (auto chosen = cli::choose_folder(app, arguments.input, arguments.folder); !chosen) {
    return usage_error(chosen.error().message);
  }
  if (arguments.output.empty() && arguments.folder.folder.empty()) {
    return usage_error("say with --output where to write");
  }
  auto read = read_settings("--set", settings.parameters, arguments.parameters);
  if (read) read = read_settings("--set-material", settings.figures, arguments.figures);
  if (!read) return usage_error(read.error().message);
  if (arguments.materials.empty()) {
    const Result<fs::path> presets = ringdown::preset_folder();
    if (!presets) return complain(presets.error().message, ExitCode::failure);
    arguments.materials = *presets / "materials";
  }
  if (!arguments.folder.folder.empty()) return bake_folder(app, arguments);
  arguments.shaping = cli::shaping_options(app);
  return cli::run_cancellable([&](const std::stop_token& stop) {
    try {
      return bake_one(arguments.input, arguments.output, arguments, stop);
    } catch (const std::bad_alloc&) {
      return complain("there is not enough memory to bake " + arguments.input.string() +
                          "; a larger --mesh-size or a lower --element needs less",
                      ExitCode::failure);
    }
  });
}

}  // namespace

int main(int argc, char** argv) { return static_cast<int>(run(argc, argv)); }

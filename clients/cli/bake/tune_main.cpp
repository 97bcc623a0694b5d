// ringdown-tune: finds the parameters of an object at which its modes hit chosen notes. `ringdown tune ...` runs this
// program.
//
// Exit codes (protocol/exit_codes.h): ok; usage; bad_input when the object cannot be baked; failure when the targets
// are out of reach or a file cannot be written; cancelled. Nothing is written of an object whose targets were missed.
#include "clients/cli/long_work.h"
#include "clients/cli/bake/tune_options.h"
#include "engine/base/note.h"
#include "engine/bake/object_file.h"
#include "engine/base/atomic_file.h"
#include "engine/base/output_file.h"
#include "engine/base/content_cache.h"
#include "engine/base/folders.h"
#include "engine/base/toml_table.h"
#include "packaging/manual/command_line.h"

#include <cstdio>
#include <unistd.h>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

using cli::TuneArguments;
using manual::complain_of_usage;
using protocol::complain;
using protocol::ExitCode;

std::string parameters_text(const std::map<std::string, double>& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) {
    text += formatted("{}{} {:.6g}", text.empty() ? "" : ", ", name, value);
  }
  return text;
}

void print_step(const bake::TuneStep& step) {
  std::fprintf(stderr, "%4d %-7s%s:", step.number, std::string(step.stage).c_str(),
               parameters_text(step.parameters).c_str());
  for (const bake::FoundMode& mode : step.found)
    std::fprintf(stderr, "  %.2f Hz %+.2f ct (error %.2f)", mode.frequency_hz, mode.cents, mode.error_cents);
  std::fprintf(stderr, "\n");
}

void print_table(const std::string& name, const bake::TuneRequest& request, const bake::TunedObject& tuned) {
  const std::string mesh =
      tuned.mesh_size_m > 0 ? formatted(", mesh size {:.4g} mm", 1000 * tuned.mesh_size_m) : std::string();
  std::printf("%s: %s%s; %d bakes\n", name.c_str(), parameters_text(tuned.parameters).c_str(), mesh.c_str(),
              tuned.bakes);
  std::printf("  mode            target Hz     found Hz    cents   error, cents   of the first  note\n");
  for (std::size_t i = 0; i < tuned.found.size(); ++i) {
    const bake::TuneTarget& target = request.targets[i];
    const bake::FoundMode& mode = tuned.found[i];
    const std::string label = formatted("{} {}", bake::family_name(target.family), target.mode);
    std::printf("  %-14s %10.3f   %10.3f   %+6.2f         %6.2f       %8.4f  %s\n", label.c_str(), target.frequency_hz,
                mode.frequency_hz, mode.cents, mode.error_cents, mode.frequency_hz / tuned.found.front().frequency_hz,
                note_name(mode.frequency_hz).c_str());
  }
  std::fflush(stdout);
}

std::string missed(const std::string& name, const bake::TunedObject& tuned) {
  double worst = 0, error = 0;
  for (const bake::FoundMode& mode : tuned.found) {
    worst = std::max(worst, std::abs(mode.cents));
    error = std::max(error, mode.error_cents);
  }
  return formatted(
      "{}: the targets are out of reach: the best misses by {:.2f} cents, with an estimated error of {:.2f}; widen the "
      "bounds, vary more parameters, or ask for less. Nothing was written",
      name, worst, error);
}

// The path of the geometry file, relative to `folder`, for an object file there.
fs::path geometry_seen_from(const fs::path& geometry, const fs::path& folder) {
  std::error_code error;
  const fs::path way = fs::relative(fs::absolute(geometry), fs::absolute(folder), error);
  return error || way.empty() ? fs::absolute(geometry) : way;
}

Result<void> write_object(const TuneArguments& arguments, const bake::TuneRequest& request,
                          const bake::TunedObject& tuned, const fs::path& output) {
  const Result<std::string> text = read_whole_file(arguments.input, kMaxTomlFileBytes);
  if (!text) return fail(text);
  bake::ObjectChanges changes{.parameters = tuned.parameters};
  if (request.varies_level()) {
    changes.level_m = tuned.parameters.at(std::string(bake::kLevelVariable));
    changes.parameters.clear();
  }
  changes.parameters.insert(arguments.settings.begin(), arguments.settings.end());
  changes.geometry = geometry_seen_from(request.recipe.geometry, fs::absolute(output).parent_path());
  changes.mesh_size_m = tuned.mesh_size_m;
  const bake::TuneTarget& first = request.targets.front();
  if (first.mode == 1) changes.pitch_hz = first.frequency_hz;
  const Result<std::string> changed = bake::change_object(*text, changes);
  if (!changed) return fail(changed);
  return write_output(output, *changed);
}

// Tunes one object. The parameters found stay in the request, as the start for the next note of a scale.
ExitCode tune_one(const TuneArguments& arguments, bake::TuneRequest& request, const fs::path& output,
                  const std::stop_token& stop) {
  const std::string name = output.stem().string();
  using Style = cli::ProgressLine::Style;
  cli::ProgressLine line(name, !arguments.quiet && ::isatty(STDERR_FILENO) ? Style::bar : Style::none);
  request.progress = [&](std::string_view stage, double fraction) {
    line.show(stage, fraction);
    return !stop.stop_requested();
  };
  request.told = [&](const bake::TuneStep& step) {
    line.clear();
    if (!arguments.quiet) print_step(step);
  };
  const Result<bake::TunedObject> tuned = bake::tune_object(request, arguments.materials);
  line.clear();
  if (!tuned) return cli::complain_unwritten(tuned.error(), output);
  if (!arguments.quiet || !tuned->reached) print_table(name, request, *tuned);
  if (!tuned->reached) return complain({ErrorKind::refused, missed(name, *tuned)});
  if (auto written = write_object(arguments, request, *tuned, output); !written) return complain(written);
  for (bake::TuneVariable& variable : request.variables) variable.start = tuned->parameters.at(variable.name);
  request.slopes = tuned->slopes;
  request.levels = tuned->levels;
  request.recipe.meshing.mesh_size_m = tuned->mesh_size_m;
  return ExitCode::ok;
}

ExitCode tune_scale(const TuneArguments& arguments, bake::TuneRequest& request, const std::stop_token& stop) {
  std::error_code error;
  fs::create_directories(arguments.output, error);
  ExitCode worst = ExitCode::ok;
  for (int note = arguments.lowest_note; note <= arguments.highest_note; ++note) {
    request.targets = cli::targets_at(arguments, note_frequency(note));
    const fs::path output = arguments.output / (note_word(note) + ".toml");
    const ExitCode code = tune_one(arguments, request, output, stop);
    if (code == ExitCode::cancelled) return code;
    if (code != ExitCode::ok) worst = code;
  }
  return worst;
}

// The object's own value where it states one, else the middle of the bounds.
double start_of(const bake::TuneVariable& variable, const bake::ObjectRecipe& recipe) {
  const auto& fill = recipe.options.liquids.fill;
  if (variable.name == bake::kLevelVariable && fill && fill->amount.kind == liquid::Amount::Kind::kLevel)
    return fill->amount.value;
  const auto given = recipe.meshing.parameters.find(variable.name);
  return given == recipe.meshing.parameters.end() ? 0.5 * (variable.low + variable.high) : given->second;
}

ExitCode tune(TuneArguments& arguments, const std::stop_token& stop) {
  Result<bake::ObjectRecipe> recipe = bake::read_object(arguments.input);
  if (!recipe) return complain(recipe);
  if (!arguments.no_cache) recipe->options.cache = cache_folder().value_or("");
  if (arguments.mesh_size_m) recipe->meshing.mesh_size_m = *arguments.mesh_size_m;
  for (const auto& [name, value] : arguments.settings) recipe->meshing.parameters[name] = value;
  bake::TuneRequest request{.recipe = *recipe, .variables = arguments.variables, .strike = arguments.strike};
  request.tolerance_cents = arguments.tolerance_cents;
  for (bake::TuneVariable& variable : request.variables) variable.start = start_of(variable, *recipe);
  if (arguments.is_scale) return tune_scale(arguments, request, stop);
  request.targets = cli::targets_at(arguments, 0);
  return tune_one(arguments, request, arguments.output, stop);
}

// The text of the man page beside the options.
const std::vector<manual::Section> kSections = {
    {"EXAMPLES",
     {{"ringdown-tune bar.toml --vary length:250..400 --vary arch_depth:2..10 --target 1=A4 --target 2=4x -o a4.toml",
       "A bar whose first two bending modes are A4 and two octaves above it."},
      {"ringdown-tune bar.toml --vary length:150..450 --vary arch_depth:2..10 --scale F3..F6 --target 1=note --target "
       "2=4x -o bars",
       "One such bar for each note, bars/F3.toml to bars/F6.toml."},
      {"ringdown-tune glass.toml --vary fill.level:0.07..0.16 --target any:1=A5 -o a5.toml",
       "The level of the liquid in a glass at which its lowest mode is A5."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1)", "The other programs."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Finds the parameters of an object's geometry at which its modes have the frequencies that you name.",
                  "ringdown-tune");
  cli::TuneWords words;
  TuneArguments arguments;
  cli::add_tune_options(app, arguments, words);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  if (auto read = cli::read_words(words, arguments); !read) return complain_of_usage(app, read.error().message);
  const Result<fs::path> materials = material_folder(arguments.materials);
  if (!materials) return complain(materials);
  arguments.materials = *materials;
  keep_stdout_for(arguments.output);
  cli::warn_of_open_sandbox();
  return cli::run_cancellable([&](const std::stop_token& stop) { return tune(arguments, stop); });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}

// ringdown-bake: turns shapes and materials into banks. `ringdown bake ...` runs this program.
//
// Exit codes (protocol/exit_codes.h): ok; usage; bad_input when an object cannot be baked; failure when a bank cannot
// be written; cancelled. One sentence on stderr says why. In a folder, an object that
// fails does not stop the others.
#include "clients/cli/bake/bake_report.h"
#include "clients/cli/bake/exports.h"
#include "clients/cli/bake/folder_command.h"
#include "clients/cli/long_work.h"
#include "clients/cli/bake/options.h"
#include "clients/cli/bake/scene_bake.h"
#include "engine/bake/bake_object.h"
#include "engine/bake/input_hash.h"
#include "engine/bake/recipe_options.h"
#include "engine/base/content_cache.h"
#include "engine/base/file_format.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/base/range.h"
#include "engine/modal/bank_file.h"
#include "packaging/manual/command_line.h"

#include <cstdio>
#include <map>
#include <new>
#include <tuple>
#include <unistd.h>
#include <utility>

namespace {

using namespace ringdown;
namespace fs = std::filesystem;

using bake::RecipeOption;
using manual::complain_of_usage;
using protocol::complain;
using protocol::ExitCode;

struct Arguments {
  fs::path input, output, materials;
  std::optional<std::string> material;
  std::vector<std::string> bodies;  // of a scene: NODE=MATERIAL
  // The options of the recipe that the command line gives. All other options stay as in the object file.
  std::vector<std::pair<const RecipeOption*, bake::OptionValue>> given;
  std::map<const RecipeOption*, bool> flags;
  std::vector<std::string> shaping;  // the given options that can change a bank
  cli::FolderBake folder;
  cli::Exports exports;
  bool update = false, progress_lines = false, progress = false, quiet = false, compress = false;
};

// Adds the option. Its values go to `arguments` while the command line is parsed.
manual::Option* add_recipe_option(manual::App& app, const RecipeOption& row, Arguments& arguments) {
  using enum RecipeOption::Form;
  using Word = std::string;
  using Words = std::vector<std::string>;
  const auto [low, high] = row.in_command;
  const auto take = [&row, &given = arguments.given](double number, const Word& text = "", double second = 0) {
    given.push_back({&row, {.text = text, .number = number, .second = second}});
  };
  const auto take_word = [take, form = row.form](const Word& word) {
    take(form == fraction ? parse_fraction(word).value() : form == length ? *cli::parse_unit(word) : 0, word);
  };
  const auto take_words = [take, form = row.form](const Words& words) {
    if (form == pair) return take(*cli::parse_number(words[0]), "", *cli::parse_number(words[1]));
    for (const Word& word : words) take(0, word);
  };
  const auto wrong_fraction = [range = row.in_command](const Word& text) {
    const Result<void> good = parse_fraction(text).and_then([&](double x) { return check_range(x, range); });
    return good ? "" : good.error().message;
  };
  if (row.form == on) return app.add_flag(row.option, arguments.flags[&row], row.sentence);
  manual::Option* option = nullptr;
  if (row.form == count) {
    option = app.add_option_function<int>(row.option, take, row.sentence);
    option->check(manual::between(static_cast<int>(low), static_cast<int>(high)));
  } else if (row.form == number) {
    option = app.add_option_function<double>(row.option, take, row.sentence);
    option->check(high < bake::kAnyHigh ? manual::between(low, high) : manual::above_zero());
  } else if (row.form == word || row.form == fraction || row.form == length) {
    option = app.add_option_function<Word>(row.option, take_word, row.sentence);
    if (row.form == fraction) option->check(wrong_fraction);
    if (row.form == length) option->check(cli::check_unit);
  } else {
    option = app.add_option_function<Words>(row.option, take_words, row.sentence);
    if (row.form == words) option->allow_extra_args(false);
    if (row.form == pair) option->expected(2)->check(high > 0 ? manual::above_zero() : manual::any_number());
  }
  return option->type_name(row.type);
}

void add_options(manual::App& app, Arguments& arguments) {
  app.add_option(
         "input", arguments.input,
         formatted("an object (.toml), a surface ({}), a geometry ({}), a mesh ({} ...), a folder of them, or a scene "
                   "(.glb .gltf) whose bodies have acoustic materials",
                   example_endings({FileKind::surface, FileKind::gltf}),
                   example_endings({FileKind::program, FileKind::geometry}), example_endings({FileKind::gmsh_mesh})))
      ->type_name("FILE");
  app.add_option("-o,--output", arguments.output,
                 "the bank to write (.glb); for a folder, the folder of its banks (default: beside the inputs); for a "
                 "scene, another file (default: the scene itself)")
      ->type_name("FILE");
  app.add_option("-m,--material", arguments.material,
                 "name of a material; an object file has one already, and keeps it when a folder is baked");
  app.add_option("--body", arguments.bodies,
                 "in a scene, the material of a body in place of what the file says; may be given more than once")
      ->type_name("NODE=MATERIAL")
      ->allow_extra_args(false);
  app.add_option("--materials", arguments.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  manual::Option* last = nullptr;
  for (const RecipeOption& row : bake::recipe_options()) {
    if (row.option.empty()) continue;
    manual::Option* option = add_recipe_option(app, row, arguments);
    if (row.has(RecipeOption::kNotWithLast)) option->excludes(last);
    last = option;
  }
  app.add_flag("--compress", arguments.compress,
               "make the bank a third as large, with shapes rounded by up to 0.5 %; its readers must know glTF's "
               "EXT_meshopt_compression, as Ringdown does");
  arguments.exports.add_to(app);
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
  if (arguments.material) recipe.pitch_hz.reset();  // the object file states that of its own body
  recipe.options.cache = cache_folder().value_or("");
  const double scale = recipe.scale;
  for (const auto& [option, value] : arguments.given) {
    if (option->has(RecipeOption::kOtherBody)) recipe.pitch_hz.reset();
    if (auto set = option->set(recipe, value); !set) return fail(set);
  }
  if (recipe.preview) recipe.error = 0;
  if (recipe.pitch_hz) *recipe.pitch_hz *= scale / recipe.scale;
  if (recipe.options.coupled > recipe.options.nonlinear)
    return fail(
        ErrorKind::bad_input,
        "--coupled must not exceed --nonlinear, because the coupled modes are the lowest of the nonlinear ones");
  return recipe;
}

cli::ProgressLine::Style progress_style(const Arguments& arguments) {
  using Style = cli::ProgressLine::Style;
  if (arguments.progress_lines) return Style::lines;
  return !arguments.quiet && (arguments.progress || ::isatty(STDERR_FILENO)) ? Style::bar : Style::none;
}

ExitCode bake_one(const fs::path& input, const fs::path& output, const Arguments& arguments,
                  const std::stop_token& stop) {
  Result<bake::ObjectRecipe> recipe = recipe_for(input, arguments);
  if (!recipe) return complain(recipe);
  arguments.exports.ask_for(recipe->options);
  const std::string hash = bake::input_hash({.object = input,
                                             .geometry = recipe->geometry,
                                             .material = arguments.materials / (recipe->material + ".toml"),
                                             .options = arguments.shaping,
                                             .part_materials = bake::part_materials(*recipe, arguments.materials),
                                             .part_surfaces = bake::part_surfaces(*recipe)})
                               .value_or("");
  if (arguments.update && arguments.exports.none() && !hash.empty() && modal::read_input_hash(output) == hash) {
    if (!arguments.quiet) std::printf("%s: unchanged\n", recipe->name.c_str());
    return ExitCode::ok;
  }
  cli::ProgressLine line(recipe->name, progress_style(arguments));
  const Progress progress = [&](std::string_view stage, double fraction) {
    line.show(stage, fraction);
    return !stop.stop_requested();
  };
  const Result<bake::BakedObject> object = bake::bake_object(*recipe, arguments.materials, progress);
  const Result<void> exported = object ? arguments.exports.write(object->baked, progress) : Result<void>();
  line.clear();
  if (!object) return cli::complain_unwritten(object.error(), output);
  if (!exported) return complain(exported);
  const auto compression = arguments.compress ? modal::Compression::meshopt : modal::Compression::none;
  if (auto written = modal::write_bank(object->baked.bank, output, hash, compression); !written)
    return complain(written);
  if (!arguments.quiet) cli::print_report(*recipe, *object, output);
  return ExitCode::ok;
}

// NODE=MATERIAL, as --body takes it.
Result<std::map<std::string, std::string>> body_materials(const std::vector<std::string>& given) {
  std::map<std::string, std::string> materials;
  for (const std::string& text : given) {
    const auto equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0)
      return fail(ErrorKind::usage, "--body " + text + " is not NODE=MATERIAL");
    materials[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return materials;
}

ExitCode bake_scene(const Arguments& arguments, const std::stop_token& stop) {
  const auto bodies = body_materials(arguments.bodies);
  if (!bodies) return complain(bodies);
  const cli::SceneBake request{.input = arguments.input,
                               .output = arguments.output.empty() ? arguments.input : arguments.output,
                               .materials = arguments.materials,
                               .recipe_for =
                                   [&arguments](const fs::path& geometry) {
                                     Arguments of_body = arguments;
                                     of_body.material = "of the scene";
                                     return recipe_for(geometry, of_body);
                                   },
                               .body_materials = *bodies,
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
    {"FILES", {{"$XDG_CACHE_HOME/ringdown", "Results of earlier bakes, so that no mesh is solved twice."}}},
    {"ENVIRONMENT",
     {{"RINGDOWN_CACHE", "Another folder for these results."},
      {"RINGDOWN_THREADS", "Number of threads (default: the number of processors)."},
      {"RINGDOWN_MESH_SECONDS", "Processor time for reading or meshing a file (default 600)."},
      {"RINGDOWN_MESH_MIB", "Memory for reading or meshing a file (default: half of the computer's, at most 16384)."},
      {"RINGDOWN_PRESETS", "Folder of the presets, if it is not share/ringdown/presets beside bin."}}},
    {"EXAMPLES",
     {{"ringdown-bake bell.toml -o bell.glb", "An object file names its shape and its material."},
      {"ringdown-bake objects -o banks --jobs 4", "The changed objects of a folder, four at a time."},
      {"ringdown-bake room.glb", "Each body of a scene that has an acoustic material and no model gets its own."},
      {"ringdown-bake cup.stl --unit mm --material steel -o cup.glb", "A surface of your own, in millimetres."}}},
    {"SEE ALSO", {{"ringdown(1), ringdownd(1)", "The other programs."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Bakes an object's shape and material into a bank of its modes.", "ringdown-bake");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  if (arguments.input.empty()) return complain_of_usage(app, "give an input, or a folder of them");
  if (auto chosen = cli::choose_folder(app, arguments.input, arguments.folder); !chosen) {
    const bool is_usage = chosen.error().kind == ErrorKind::usage;
    return is_usage ? complain_of_usage(app, chosen.error().message) : complain(chosen);
  }
  const bool in_scene = arguments.folder.folder.empty() && !arguments.material && cli::has_surfaces(arguments.input);
  std::vector<std::string> not_for_scenes = {"--compress", "--update"};
  for (const RecipeOption& option : bake::recipe_options()) {
    if (option.has(RecipeOption::kNotForScenes)) not_for_scenes.push_back(option.option);
  }
  for (const std::string& name : not_for_scenes) {
    if (in_scene && app.count(name) > 0)
      return complain_of_usage(app, name + " is not for scenes, and " + arguments.input.string() +
                                        " is one; with --material it is a surface");
  }
  for (const char* option : cli::kExportOptions) {
    if ((in_scene || !arguments.folder.folder.empty()) && app.count(option) > 0)
      return complain_of_usage(app, std::string(option) + " is for one object, not for a folder or a scene");
  }
  if (auto good = arguments.exports.check(); !good) return complain_of_usage(app, good.error().message);
  if (arguments.output.empty() && arguments.folder.folder.empty() && !in_scene) {
    return complain_of_usage(app, "name the output with --output");
  }
  for (auto& [option, value] : arguments.given) {
    if (option->form != RecipeOption::Form::settings) continue;
    std::map<std::string, double> setting;
    const auto read = cli::read_settings(option->option, {value.text}, setting);
    if (!read) return complain_of_usage(app, read.error().message);
    std::tie(value.text, value.number) = *setting.begin();
  }
  for (const auto& [option, is_on] : arguments.flags) {
    if (is_on) arguments.given.push_back({option, {.text = "", .number = 1}});
  }
  const Result<fs::path> materials = material_folder(arguments.materials);
  if (!materials) return complain(materials);
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

#include "clients/cli/bake/tune_options.h"

#include "clients/cli/bake/options.h"
#include "engine/base/note.h"
#include "packaging/manual/command_line.h"

#include <cmath>

namespace ringdown::cli {
namespace {

// "LOW..HIGH" as its two halves.
std::optional<std::pair<std::string, std::string>> range_in(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return std::nullopt;
  return std::pair(text.substr(0, dots), text.substr(dots + 2));
}

Result<bake::TuneVariable> variable_in(const std::string& text) {
  const std::string wanted = "--vary takes NAME:LOW..HIGH with LOW below HIGH, not '" + text + "'";
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) return fail(ErrorKind::bad_input, wanted);
  const auto ends = range_in(text.substr(colon + 1));
  if (!ends) return fail(ErrorKind::bad_input, wanted);
  const auto low = parse_number(ends->first), high = parse_number(ends->second);
  if (!low || !high || !(*low < *high)) return fail(ErrorKind::bad_input, wanted);
  return bake::TuneVariable{text.substr(0, colon), *low, *high, 0.5 * (*low + *high)};
}

Result<AskedTarget> target_in(const std::string& text) {
  const std::string wanted =
      "--target takes [FAMILY:]MODE=VALUE, where the value is in Hz, a note such as A4, or a multiple of the first "
      "target such as 4x, not '" +
      text + "'";
  AskedTarget target;
  const std::size_t colon = text.find(':'), equals = text.find('=');
  if (equals == std::string::npos) return fail(ErrorKind::bad_input, wanted);
  std::size_t begin = 0;
  if (colon < equals) {
    const Result<bake::ModeFamily> family = bake::parse_family(text.substr(0, colon));
    if (!family) return fail(family);
    target.family = *family;
    begin = colon + 1;
  }
  const auto mode = parse_number(text.substr(begin, equals - begin));
  if (!mode || !(*mode >= 1 && *mode <= 1000) || *mode != std::floor(*mode)) return fail(ErrorKind::bad_input, wanted);
  target.mode = static_cast<int>(*mode);

  std::string value = text.substr(equals + 1);
  if (value == "note") {
    target.kind = AskedTarget::Kind::kNote;
    return target;
  }
  if (const auto note = note_number(value)) {
    target.value = note_frequency(*note);
    return target;
  }
  if (value.ends_with('x')) {
    target.kind = AskedTarget::Kind::kMultiple;
    value.pop_back();
  }
  const auto number = parse_number(value);
  if (!number || !(*number > 0)) return fail(ErrorKind::bad_input, wanted);
  target.value = *number;
  return target;
}

Result<void> read_scale(const std::string& text, TuneArguments& arguments) {
  const auto ends = range_in(text);
  const auto low = ends ? note_number(ends->first) : std::nullopt,
             high = ends ? note_number(ends->second) : std::nullopt;
  if (!low || !high || *low > *high)
    return fail(ErrorKind::bad_input, "--scale takes two notes, the lower first, such as F3..F6, not '" + text + "'");
  arguments.is_scale = true;
  arguments.lowest_note = *low;
  arguments.highest_note = *high;
  return {};
}

}  // namespace

void add_tune_options(manual::App& app, TuneArguments& arguments, TuneWords& words) {
  app.add_option("input", arguments.input,
                 "an object (.toml) whose geometry is a .geo with parameters, or that has a [fill]")
      ->type_name("FILE")
      ->required();
  app.add_option("-o,--output", arguments.output, "the object to write (.toml); with --scale, the folder")
      ->type_name("FILE")
      ->required();
  app.add_option("--vary", words.vary,
                 "a parameter that may change, in the geometry's unit, or fill.level, in metres; repeat it for others")
      ->type_name("NAME:LOW..HIGH")
      ->required();
  app.add_option(
         "--target", words.targets,
         "target frequency of a mode: Hz, a note (A4, F#3), or a multiple of the first target (4x). MODE counts from 1 "
         "in its family: vertical (default: bending in the strike direction), lateral, torsion, longitudinal, any")
      ->type_name("[FAMILY:]MODE=VALUE")
      ->required();
  app.add_option("--set", words.settings,
                 "a fixed parameter with another value than the object's; repeat it for others")
      ->type_name("NAME=NUMBER");
  app.add_option("--scale", words.scale, "make one object for each note; a target with the value 'note' gets that note")
      ->type_name("LOW..HIGH");
  app.add_option("--strike", words.strike, "direction of the blow that 'vertical' means (default: across a flat body)")
      ->expected(3)
      ->type_name("X Y Z")
      ->check(manual::any_number());
  app.add_option("--tolerance", arguments.tolerance_cents, "largest error of a target in cents (default 0.3)")
      ->check(manual::between(0.001, 100.0));
  app.add_option("--mesh-size", arguments.mesh_size_m, "longest edge in metres, instead of the object's")
      ->check(manual::above_zero());
  app.add_option("--materials", arguments.materials, "folder of materials (default: the presets')")
      ->type_name("FOLDER");
  app.add_flag("--no-cache", arguments.no_cache, "neither use nor keep earlier results");
  app.add_flag("-q,--quiet", arguments.quiet, "print nothing but errors");
}

Result<void> read_words(const TuneWords& words, TuneArguments& arguments) {
  for (const std::string& text : words.vary) {
    const Result<bake::TuneVariable> variable = variable_in(text);
    if (!variable) return fail(variable);
    arguments.variables.push_back(*variable);
  }
  if (auto read = read_settings("--set", words.settings, arguments.settings); !read) return read;
  if (!words.scale.empty()) {
    if (auto scale = read_scale(words.scale, arguments); !scale) return scale;
  }
  for (const std::string& text : words.targets) {
    const Result<AskedTarget> target = target_in(text);
    if (!target) return fail(target);
    if (target->kind == AskedTarget::Kind::kNote && !arguments.is_scale) {
      return fail(ErrorKind::bad_input, "the value 'note' needs a scale; name it with --scale");
    }
    if (target->kind == AskedTarget::Kind::kMultiple && arguments.targets.empty()) {
      return fail(ErrorKind::bad_input,
                  "the first --target must be a frequency or a note, because multiples refer to it");
    }
    arguments.targets.push_back(*target);
  }
  if (words.strike.size() == 3) arguments.strike = Vec3{words.strike[0], words.strike[1], words.strike[2]};
  return {};
}

std::vector<bake::TuneTarget> targets_at(const TuneArguments& arguments, double note_hz) {
  std::vector<bake::TuneTarget> targets;
  for (const AskedTarget& asked : arguments.targets) {
    double hertz = asked.value;
    if (asked.kind == AskedTarget::Kind::kNote) hertz = note_hz;
    if (asked.kind == AskedTarget::Kind::kMultiple) hertz = asked.value * targets.front().frequency_hz;
    targets.push_back({asked.family, asked.mode, hertz});
  }
  return targets;
}

}  // namespace ringdown::cli

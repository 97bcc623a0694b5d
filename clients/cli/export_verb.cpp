#include "clients/cli/long_work.h"
#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "packaging/manual/command_line.h"
#include "server/session/sample_set.h"

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

namespace ringdown::cli {
namespace {

struct ExportArguments {
  session::SampleSetOptions options;
  std::string bank;
  std::vector<int> keys;
  std::vector<std::string> places;
};

ExitCode export_samples(ExportArguments& arguments, const std::stop_token& stop) {
  session::SampleSetOptions& options = arguments.options;
  const auto bank = preset_or_file(arguments.bank, PresetKind::bank);
  if (!bank) return complain(bank);
  options.bank = *bank;
  if (!arguments.keys.empty()) {
    if (arguments.keys[0] > arguments.keys[1]) {
      return complain("--keys: the first key is the lowest one", ExitCode::usage);
    }
    options.keys = {arguments.keys[0], arguments.keys[1]};
  }
  for (const std::string& place : arguments.places) options.places_m.push_back(vector_of(place));
  if (!options.folder.has_filename()) options.folder = options.folder.parent_path();  // bell/ -> bell
  ProgressLine line("export", isatty(STDERR_FILENO) ? ProgressLine::Style::bar : ProgressLine::Style::none);
  const auto made = session::write_sample_set(options, [&](double done) {
    line.show(done > 0 ? "rendering" : "finding the loudest", done);
    return !stop.stop_requested();
  });
  line.clear();
  if (!made) return complain(made);
  std::printf("%s: %zu samples, %.0f s in all; ", made->sfz.c_str(), made->samples, made->seconds);
  if (made->no_pitch.empty()) {
    std::printf("its own pitch is %.2f Hz, on key %d\n", made->pitch_hz, made->key);
  } else {
    std::printf("it has no definite pitch (%s): %.2f Hz lies on key %d, which --pitch changes\n",
                made->no_pitch.c_str(), made->pitch_hz, made->key);
  }
  return ExitCode::ok;
}

}  // namespace

void add_export_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<ExportArguments>();
  session::SampleSetOptions& options = arguments->options;
  manual::App* verb = app.add_subcommand("export", "Renders a bank as samples and an SFZ file, for any sampler.");
  verb->add_option("bank", arguments->bank, "The bank: a .glb file, or the name of a preset.")
      ->type_name("FILE")
      ->required();
  verb->add_option("-o,--output", options.folder, "The folder to make.")->type_name("FOLDER")->required();
  verb->add_option(
          "--keys", arguments->keys,
          "Lowest and highest MIDI key; each key plays the object in another size. Default: only its own size.")
      ->expected(2)
      ->check(manual::between(0, session::kKeys - 1))
      ->type_name("LOW HIGH");
  verb->add_option("--step", options.step, "Keys from one size to the next; a sampler transposes between.")
      ->check(manual::between(1, 24))
      ->capture_default_str();
  verb->add_option("--pitch", options.pitch,
                   "MIDI key of the object in its own size; default: by its pitch, which `ringdown info` prints.")
      ->check(manual::between(0, session::kKeys - 1))
      ->type_name("KEY");
  verb->add_option("--velocities", options.velocities, "Velocity layers; softer blows have longer contacts.")
      ->check(manual::between(1, 32))
      ->capture_default_str();
  verb->add_option("--strikes", options.strikes, "Strikes at nearby points, which take turns when a key is repeated.")
      ->check(manual::between(1, 16))
      ->capture_default_str();
  verb->add_option(
          "--at", arguments->places,
          "Struck point X,Y,Z in metres; if there are several, keys from 0 up choose. Default: the loudest point.")
      ->check(manual::any_vector())
      ->type_name("X,Y,Z");
  verb->add_option("--scatter", options.scatter, "Distance of points that take turns, relative to the object's size.")
      ->check(manual::between(0.0, 1.0))
      ->capture_default_str();
  verb->add_option("--contact", options.contact_time_s,
                   "Contact time of the hardest blow in seconds, at the object's own size; it scales with the size.")
      ->check(manual::between(0.0, 0.1))
      ->capture_default_str();
  verb->add_option("--seconds", options.max_s, "Longest sample in seconds; samples end earlier when they are silent.")
      ->check(manual::between(0.1, 600.0))
      ->capture_default_str();
  verb->add_option("--release", options.release_s,
                   "Damp a released key within this many seconds; default: it rings on.")
      ->check(manual::between(0.0, 60.0))
      ->type_name("SECONDS");
  verb->add_option("--rate", options.sample_rate_hz, "Sample rate in Hz.")
      ->check(manual::between(8000.0, 384000.0))
      ->capture_default_str();
  verb->add_flag("--flac", options.flac, "24-bit FLAC in place of 32-bit float WAV.");
  verb->callback([arguments, &outcome] {
    outcome = run_cancellable([&](const std::stop_token& stop) { return export_samples(*arguments, stop); });
  });
}

}  // namespace ringdown::cli

#include "clients/cli/long_work.h"
#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "packaging/manual/command_line.h"
#include "protocol/wire/score.h"
#include "server/session/offline.h"
#include "server/sound_options.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

struct RenderArguments {
  session::OfflineOptions options;
  std::vector<std::string> objects;
  std::optional<std::filesystem::path> score;
  std::string output;
};

// Shows the percentage on a terminal, and nothing elsewhere.
void show_progress(double done) {
  static int shown = -1;
  const int percent = static_cast<int>(100 * done);
  if (percent != shown && isatty(STDERR_FILENO)) {
    shown = percent;
    std::fprintf(stderr, "\rrendering %3d %%%s", percent, percent == 100 ? "\n" : "");
  }
}

ExitCode render(RenderArguments& arguments, const std::stop_token& stop) {
  for (const std::string& text : arguments.objects) {
    const auto equals = text.find('=');
    if (equals == text.npos) return complain("--object " + text + " is not NAME=BANK", ExitCode::usage);
    const auto bank = preset_or_file(text.substr(equals + 1), PresetKind::bank);
    if (!bank) return complain("--object " + text + ": " + bank.error().message, ExitCode::usage);
    arguments.options.objects.emplace_back(text.substr(0, equals), *bank);
  }
  if (auto& scene = arguments.options.scene; scene) {
    const auto found = preset_or_file(*scene, PresetKind::scene);
    if (!found) return complain("--scene: " + found.error().message, ExitCode::usage);
    scene = *found;
  }
  if (arguments.score) {
    auto score = wire::read_score(*arguments.score);
    if (!score) return complain(score.error());
    arguments.options.score = std::move(*score);
  }
  const auto rendering = session::render_to_file(arguments.options, arguments.output, [&stop](double done) {
    show_progress(done);
    return !stop.stop_requested();
  });
  if (!rendering) return complain(rendering.error());
  for (const std::string& warning : rendering->warnings) complain(warning, ExitCode::ok);
  std::printf("%s: %.2f s at %.0f Hz, peak %.1f dB\n", arguments.output.c_str(), rendering->seconds,
              arguments.options.sample_rate_hz, 20 * std::log10(static_cast<double>(rendering->peak) + 1e-12));
  if (rendering->peak > 1)
    complain("the sound exceeds full scale: lower the objects' gain, or write a .wav file, which holds floats",
             ExitCode::ok);
  const bool asked_for_sound = arguments.options.scene || arguments.score;
  if (rendering->peak == 0 && asked_for_sound)
    return complain(arguments.output + " is digital silence: nothing that sounds was struck", ExitCode::silence);
  return ExitCode::ok;
}

}  // namespace

void add_render_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<RenderArguments>();
  session::OfflineOptions& options = arguments->options;
  manual::App* verb = app.add_subcommand("render", "Renders a scene or an OSC score to a sound file, at full speed.");
  verb->add_option("--scene", options.scene, "Scene: a file (docs/use/scenes.md), or the name of a preset like demo.")
      ->type_name("FILE");
  verb->add_option("--events", arguments->score, "OSC score, the format of scsynth's non-real-time mode.")
      ->type_name("FILE");
  verb->add_option(
          "--object", arguments->objects,
          "Object to load first: its new name, and a bank file or the name of a preset; may be given more than once.")
      ->type_name("NAME=BANK");
  verb->add_option("-o,--output", arguments->output, "File to write: .wav (32-bit float) or .flac (24 bit).")
      ->type_name("FILE")
      ->required();
  verb->add_option("--seconds", options.seconds,
                   "Length; default: the scene's, or the score's plus 5 to 60 s, until the sound has fallen by 60 dB.")
      ->check(manual::between(0.0, session::kMaxRender_s));
  verb->add_option("--rate", options.sample_rate_hz, "Sample rate in Hz.")
      ->check(manual::between(8000.0, 768000.0))
      ->capture_default_str();
  verb->add_option("--block", options.block_frames, "Frames per block; affects only rounding.")
      ->check(manual::between(1, 8192))
      ->capture_default_str();
  server::add_sound_options(*verb, options.mixer);
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->output);
    outcome = run_cancellable([&](const std::stop_token& stop) { return render(*arguments, stop); });
  });
}

}  // namespace ringdown::cli

#include "clients/cli/long_work.h"
#include "clients/cli/sound_output.h"
#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/scene/gltf/scene.h"
#include "packaging/manual/command_line.h"
#include "protocol/wire/score.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

struct RenderArguments {
  session::OfflineOptions options;
  std::vector<std::string> objects;
  std::optional<std::filesystem::path> score;
  SoundOutput output;
};

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
  const bool asked_for_sound = arguments.options.scene || arguments.score;
  const auto judge = [&](const session::Rendering& rendering, const std::string& path) {
    if (rendering.peak > 0 || !asked_for_sound) return ExitCode::ok;
    std::string why = path + " is digital silence: nothing that sounds was struck";
    if (arguments.options.scene && scene::is_gltf(*arguments.options.scene))
      why += ". What bodies do that only keyframes move is heard by `ringdown foley " +
             arguments.options.scene->string() + "`";
    return complain(why, ExitCode::silence);
  };
  return write_sound(arguments.options, arguments.output, stop, {}, judge);
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
  verb->add_option("--seconds", options.seconds,
                   "Length, faded at its end; default: the scene's, or up to the score's last event, and a tail.")
      ->check(manual::between(0.0, session::kMaxRender_s));
  verb->add_option("--block", options.block_frames, "Frames per block; affects only rounding.")
      ->check(manual::between(1, 8192))
      ->capture_default_str();
  verb->add_option("--pickups", arguments->output.file.pickups,
                   "Sound file for the motion that the score's pickups feel (/object/NAME/pickup), a channel for each.")
      ->type_name("FILE");
  add_sound_output(*verb, options, arguments->output);
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->output.path);
    outcome = run_cancellable([&](const std::stop_token& stop) { return render(*arguments, stop); });
  });
}

}  // namespace ringdown::cli

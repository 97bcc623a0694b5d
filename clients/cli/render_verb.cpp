#include "clients/cli/long_work.h"
#include "clients/cli/sound_output.h"
#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/output_file.h"
#include "engine/scene/gltf/scene.h"
#include "packaging/manual/command_line.h"
#include "protocol/schema.h"
#include "protocol/wire/score.h"
#include "server/session/note_map.h"
#include "server/session/session.h"

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
  std::string strike;  // bank
  std::optional<std::string> at, impulse;
  std::optional<double> contact_time_s;
  SoundOutput output;
};

constexpr const char* kStruck = "object";  // the name of the object that --strike loads

// Makes a score of one strike. What the user leaves out is as for a note of a keyboard.
Result<void> add_strike(RenderArguments& arguments) {
  const auto path = preset_or_file(arguments.strike, PresetKind::bank);
  if (!path) return fail("--strike", path);
  session::Session session(arguments.options.sample_rate_hz);
  if (const auto loaded = session.rack().load(kStruck, *path); !loaded) return fail(loaded);
  session::NoteMap map;
  map.notes = {{.object = kStruck,
                .point_m = arguments.at ? std::optional(vector_of(*arguments.at)) : std::nullopt,
                .impulse_ns = arguments.impulse ? std::optional(vector_of(*arguments.impulse)) : std::nullopt,
                .contact_time_s = arguments.contact_time_s}};
  const auto strike = session::resolve(map, session.rack().objects()).notes[0];
  const protocol::Strike request{{.name = kStruck}, {strike->point_m, strike->impulse_ns, strike->contact_time_s}};
  arguments.options.objects.emplace_back(kStruck, *path);
  arguments.options.min_tail_s = session::kMinTail_s;
  arguments.options.score = {{0, protocol::format(protocol::Request(request))}};
  return {};
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
  if (!arguments.strike.empty()) {
    if (arguments.options.scene || arguments.score) {
      return complain("--strike is a sound of its own: leave out --scene and --events", ExitCode::usage);
    }
    if (const auto added = add_strike(arguments); !added) return complain(added.error());
  } else if (arguments.at || arguments.impulse || arguments.contact_time_s) {
    return complain("--at, --impulse and --contact-time describe a --strike, which is missing", ExitCode::usage);
  }
  const bool asked_for_sound = arguments.options.scene || !arguments.options.score.empty();
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
  manual::App* verb =
      app.add_subcommand("render", "Renders a scene, an OSC score or one strike to a sound file, at full speed.");
  verb->add_option("--scene", options.scene, "Scene: a file (docs/use/scenes.md), or the name of a preset like demo.")
      ->type_name("FILE");
  verb->add_option("--events", arguments->score, "OSC score, the format of scsynth's non-real-time mode.")
      ->type_name("FILE");
  verb->add_option(
          "--object", arguments->objects,
          "Object to load first: its new name, and a bank file or the name of a preset; may be given more than once.")
      ->type_name("NAME=BANK");
  verb->add_option("--strike", arguments->strike,
                   "Bank to strike once: a file, or the name of a preset. With --takes, each file is another strike.")
      ->type_name("BANK");
  verb->add_option("--at", arguments->at,
                   "Struck point in metres, in the object's frame; default: where it moves most.")
      ->check(manual::any_vector())
      ->type_name("X,Y,Z");
  verb->add_option("--impulse", arguments->impulse,
                   "Impulse of the strike in N s; default: loud, in the direction in which the point moves most.")
      ->check(manual::any_vector())
      ->type_name("X,Y,Z");
  verb->add_option("--contact-time", arguments->contact_time_s,
                   "Contact time of the strike in seconds; default: 0.0002.")
      ->check(manual::between(0.0, 0.1));
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

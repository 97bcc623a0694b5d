// ringdown foley: the sound of an animation.
#include "clients/cli/long_work.h"
#include "clients/cli/sound_output.h"
#include "clients/cli/verb.h"
#include "engine/base/output_file.h"
#include "engine/scene/gltf/scene.h"
#include "packaging/manual/command_line.h"
#include "server/session/contact_report.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

namespace ringdown::cli {
namespace {

struct FoleyArguments {
  session::OfflineOptions options;
  scene::FoleyLimits limits;
  std::filesystem::path animation;
  std::string report;
  SoundOutput output;
};

// Why nothing is heard, and what to do.
std::string why_silent(const session::Rendering& rendering, const std::string& file) {
  const std::string bake = "`ringdown bake " + file + "` gives them banks, and says which materials it understood";
  const session::BodyCounts& bodies = rendering.bodies;
  if (bodies.moved == 0)
    return "nothing moves in " + file +
           ": no mesh of its scene is moved by keyframes of location or rotation. Export the objects with their meshes "
           "and their animation; a simulation has to be baked to keyframes first";
  if (rendering.contacts.empty())
    return "no two bodies of " + file +
           " push each other. Bodies are meshes, and what pushes them is told by their keyframes: at least two "
           "objects, "
           "of which one is animated by location and rotation, have to touch within --gap";
  if (bodies.sounding == 0) return "bodies touch, but none of " + file + " has a bank; " + bake;
  return "bodies touch, but none that touches has a bank; " + bake;
}

ExitCode foley(FoleyArguments& arguments, const std::stop_token& stop) {
  const std::string file = arguments.animation.string();
  if (!scene::is_gltf(arguments.animation))
    return complain(file + " is no glTF file (.glb, .gltf); export the animation as one", ExitCode::usage);
  arguments.options.scene = arguments.animation;
  arguments.options.foley = arguments.limits;
  const auto impacts = [](const session::Rendering& rendering) {
    return std::ranges::count(rendering.contacts, "impact", &session::ContactRow::kind);
  };
  const auto more = [&](const session::Rendering& rendering) {
    const auto count = static_cast<std::size_t>(impacts(rendering));
    return ", " + std::to_string(count) + " impacts, " + std::to_string(rendering.contacts.size() - count) +
           " contacts that slide or roll";
  };
  const auto judge = [&](const session::Rendering& rendering, const std::string& path) {
    if (!arguments.report.empty()) {
      if (const auto written = session::write_contacts(rendering.contacts, arguments.report); !written)
        return complain(written.error());
    }
    if (rendering.peak > 0) return ExitCode::ok;
    return complain(path + " is digital silence: " + why_silent(rendering, file), ExitCode::silence);
  };
  return write_sound(arguments.options, arguments.output, stop, more, judge);
}

}  // namespace

void add_foley_verb(manual::App& app, ExitCode& outcome) {
  auto arguments = std::make_shared<FoleyArguments>();
  session::OfflineOptions& options = arguments->options;
  scene::FoleyLimits& limits = arguments->limits;
  manual::App* verb =
      app.add_subcommand("foley", "Renders the sound of an animation, whose contacts are found from its keyframes.");
  verb->add_option("animation", arguments->animation, "Animated glTF file (.glb, .gltf), after `ringdown bake`.")
      ->type_name("FILE")
      ->required();
  verb->add_option("--report", arguments->report, "Table of the contacts to write (.csv).")->type_name("FILE");
  verb->add_option("--from", options.from_s, "Second of the animation at which the file begins; default: 0.")
      ->check(manual::between(0.0, session::kMaxRender_s));
  verb->add_option("--to", options.to_s, "Second of the animation after which only the tail follows; default: its end.")
      ->check(manual::between(0.0, session::kMaxRender_s));
  verb->add_option("--fps", limits.frames_per_s, "Frames in a second; default: as often as the file has keys.")
      ->check(manual::between(5.0, 240.0));
  verb->add_option("--gap", limits.gap_m, "Distance in metres at which bodies that push each other touch.")
      ->check(manual::between(0.0, 0.1))
      ->capture_default_str();
  verb->add_option("--jitter", limits.jitter_m_s,
                   "Change of velocity in m/s from frame to frame that is noise of the animation.")
      ->check(manual::between(0.0, 10.0))
      ->capture_default_str();
  verb->add_option("--strike", limits.strike_m_s, "Speed in m/s above which bodies that meet strike each other.")
      ->check(manual::between(0.0, 100.0))
      ->capture_default_str();
  verb->add_option("--jump", limits.jump_m_s, "Speed in m/s above which a body is taken to be put elsewhere.")
      ->check(manual::between(1.0, 1000.0))
      ->capture_default_str();
  add_sound_output(*verb, options, arguments->output);
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->output.path);
    outcome = run_cancellable([&](const std::stop_token& stop) { return foley(*arguments, stop); });
  });
}

}  // namespace ringdown::cli

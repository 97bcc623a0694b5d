// ringdown foley: the sound of an animation.
#include "clients/cli/long_work.h"
#include "clients/cli/verb.h"
#include "engine/base/output_file.h"
#include "engine/scene/gltf/scene.h"
#include "packaging/manual/command_line.h"
#include "server/session/contact_report.h"
#include "server/session/offline.h"
#include "server/sound_options.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>

namespace ringdown::cli {
namespace {

constexpr double kFade_s = 0.03;

struct FoleyArguments {
  session::OfflineOptions options;
  scene::FoleyLimits limits;
  std::filesystem::path animation;
  std::string output, report;
};

ExitCode foley(FoleyArguments& arguments, const std::stop_token& stop) {
  const std::string file = arguments.animation.string();
  if (!scene::is_gltf(arguments.animation))
    return complain(file + " is no glTF file (.glb, .gltf); export the animation as one", ExitCode::usage);
  session::OfflineOptions& options = arguments.options;
  options.scene = arguments.animation;
  options.foley = arguments.limits;
  options.fade_s = kFade_s;
  int shown = -1;
  const auto rendering = session::render_to_file(options, arguments.output, [&](double done) {
    const int percent = static_cast<int>(100 * done);
    if (percent != shown && isatty(STDERR_FILENO))
      std::fprintf(stderr, "\rrendering %3d %%%s", percent, percent == 100 ? "\n" : "");
    shown = percent;
    return !stop.stop_requested();
  });
  if (!rendering) return complain(rendering.error());
  for (const std::string& warning : rendering->warnings) complain(warning, ExitCode::ok);
  if (!arguments.report.empty()) {
    if (const auto written = session::write_contacts(rendering->contacts, arguments.report); !written)
      return complain(written.error());
  }
  const auto impacts = std::ranges::count(rendering->contacts, "impact", &session::ContactRow::kind);
  std::printf("%s: %.2f s at %.0f Hz, peak %.1f dB, %td impacts, %td contacts that slide or roll\n",
              arguments.output.c_str(), rendering->seconds, options.sample_rate_hz,
              20 * std::log10(static_cast<double>(rendering->peak) + 1e-12), impacts,
              static_cast<std::ptrdiff_t>(rendering->contacts.size()) - impacts);
  if (rendering->peak > 1) complain("it exceeds full scale: keep the float file, and lower it there", ExitCode::ok);
  if (rendering->peak > 0) return ExitCode::ok;
  if (rendering->contacts.empty())
    return complain(
        arguments.output + " is digital silence: no two bodies of " + file +
            " push each other. Bodies are meshes, and what pushes them is told by their keyframes: at least "
            "two objects, of which one is animated by location and rotation, have to touch within --gap",
        ExitCode::silence);
  return complain(arguments.output +
                      " is digital silence: bodies touch, but none that touches has a bank; `ringdown bake " + file +
                      "` gives them banks, and says which materials it understood",
                  ExitCode::silence);
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
  verb->add_option("-o,--output", arguments->output, "File to write: .wav (32-bit float) or .flac (24 bit).")
      ->type_name("FILE")
      ->required();
  verb->add_option("--report", arguments->report, "Table of the contacts to write (.csv).")->type_name("FILE");
  verb->add_option("--fps", limits.frames_per_s, "Frames in a second; default: as often as the file has keys.")
      ->check(manual::between(5.0, 240.0));
  verb->add_option("--tail", options.tail_s,
                   "Seconds after the animation, 0 or more; default: until the sound has fallen by 60 dB.")
      ->check(manual::between(0.0, 3600.0));
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
  verb->add_option("--rate", options.sample_rate_hz, "Sample rate in Hz.")
      ->check(manual::between(8000.0, 768000.0))
      ->capture_default_str();
  server::add_sound_options(*verb, options.mixer);
  verb->callback([arguments, &outcome] {
    keep_stdout_for(arguments->output);
    outcome = run_cancellable([&](const std::stop_token& stop) { return foley(*arguments, stop); });
  });
}

}  // namespace ringdown::cli

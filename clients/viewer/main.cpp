// ringdown-viewer: a window onto a daemon, here or on another computer.
#include "clients/viewer/app.h"
#include "clients/viewer/screenshot.h"
#include "packaging/manual/command_line.h"
#include "protocol/defaults.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

namespace {

using namespace ringdown;  // NOLINT: a program
using protocol::complain;
using protocol::ExitCode;
using viewer::Pane;

std::atomic<bool> interrupted = false;

struct Arguments {
  std::string to, scene, screenshot, only, theme;
  double at_s = 1, scale = 0;
  std::vector<int> size;
  bool keys = false;
};

// The sections of the man page.
std::vector<manual::Section> sections() {
  std::vector<manual::Section> all = {
      {"FILES", {{"$XDG_CONFIG_HOME/ringdown/viewer.toml", "The last size, panes, theme, scale and test force."}}},
      {"EXAMPLES",
       {{"ringdown-viewer", "The daemon on this computer."},
        {"ringdown-viewer --to osc.udp://studio:7770", "A daemon on another computer, started with --address."},
        {"xvfb-run -a ringdown-viewer --scene demo.toml --at 2.5 --screenshot demo.png",
         "A picture, without a screen."}}}};
  for (const Pane pane : viewer::kPanesWithKeys) {
    manual::Section section{"KEYS: " + std::string(viewer::heading_of(pane)), {}};
    for (const viewer::Binding& binding : viewer::bindings()) {
      if (binding.pane == pane) section.entries.push_back({std::string(binding.key), std::string(binding.sentence)});
    }
    all.push_back(std::move(section));
  }
  all.push_back({"SEE ALSO", {{"ringdownd(1), ringdown(1)", "The daemon, and the command that sends to it."}}});
  return all;
}

void add_options(manual::App& app, Arguments& arguments) {
  app.add_option("--to", arguments.to, "The daemon, as osc.udp://HOST:PORT; default: the last one, or this computer's.")
      ->type_name("URL");
  auto* scene =
      app.add_option("--scene", arguments.scene, "The scene that the daemon loads; a path on the daemon's computer.")
          ->type_name("FILE");
  app.add_option("--only", arguments.only, "Shows one pane alone.")
      ->check(manual::one_of({"scene", "sound"}))
      ->type_name("scene|sound");
  app.add_option("--theme", arguments.theme, "Dark or light; default: the last one.")
      ->check(manual::one_of({"dark", "light"}))
      ->type_name("dark|light");
  app.add_option("--scale", arguments.scale, "Scale of text and controls; default: the last one, or the display's.")
      ->check(manual::between(0.5, 8.0));
  app.add_option("--size", arguments.size, "Size of the window in pixels; default: the last one.")
      ->type_name("WIDTH HEIGHT")
      ->expected(2)
      ->check(manual::between(240, 8192));
  auto* screenshot = app.add_option("--screenshot", arguments.screenshot,
                                    "Plays --scene until --at, writes a picture and ends. Without --to, a silent "
                                    "daemon of its own plays the scene.")
                         ->type_name("FILE.png")
                         ->needs(scene);
  app.add_option("--at", arguments.at_s, "Time of the picture, in seconds of the scene.")
      ->check(manual::between(0.0, 3600.0))
      ->capture_default_str();
  app.add_flag("--keys", arguments.keys, "Prints the keys as Markdown.")->excludes(screenshot);
}

void take_over(const Arguments& arguments, viewer::Settings& settings) {
  if (!arguments.theme.empty()) settings.dark = arguments.theme == "dark";
  if (arguments.scale > 0) settings.scale = arguments.scale;
  if (!arguments.to.empty()) settings.daemon = arguments.to;
  if (arguments.size.size() == 2) {
    settings.width = static_cast<std::uint64_t>(arguments.size[0]);
    settings.height = static_cast<std::uint64_t>(arguments.size[1]);
  }
}

ExitCode screenshot(const Arguments& arguments, Pane only) {
  viewer::Settings settings;  // not the user's: the same picture everywhere
  take_over(arguments, settings);
  const auto taken =
      viewer::take_screenshot({.output = arguments.screenshot,
                               .scene = arguments.scene,
                               .at_s = arguments.at_s,
                               .daemon = arguments.to.empty() ? std::nullopt : std::optional(arguments.to),
                               .only = only,
                               .keep_going = [] { return !interrupted; }},
                              settings);
  if (taken) return ExitCode::ok;
  return complain(taken);
}

ExitCode show(const Arguments& arguments, Pane only) {
  const auto file = viewer::settings_file();
  auto read = file ? viewer::read_settings(*file) : Result<viewer::Settings>(viewer::Settings{});
  if (!read) complain(read.error().message + "; the defaults are used", ExitCode::bad_input);
  const bool keep = file && read;  // a file that is wrong is the user's to mend
  viewer::Settings settings = read ? *read : viewer::Settings{};
  take_over(arguments, settings);
  if (settings.daemon.empty()) settings.daemon = formatted("osc.udp://127.0.0.1:{}", protocol::kDefaultPort);
  auto window =
      viewer::Window::open({static_cast<int>(settings.width), static_cast<int>(settings.height), true, settings.scale});
  if (!window) return complain(window);
  auto renderer = viewer::SceneRenderer::create();
  if (!renderer) return complain(renderer);
  std::optional<std::string> scene;
  if (!arguments.scene.empty()) scene = arguments.scene;
  viewer::App app(std::move(*window), std::move(*renderer), settings, {settings.daemon, scene, only, std::nullopt});
  while (app.runs() && !interrupted) app.frame();
  if (!keep) return ExitCode::ok;
  const auto written = viewer::write_settings(app.settings(), *file);
  return written ? ExitCode::ok : complain(written);
}

}  // namespace

int main(int argc, char** argv) {
  manual::App app("A window onto Ringdown: see a scene, strike it, tune it.", "ringdown-viewer");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, sections())) return static_cast<int>(*ended);
  if (arguments.keys) {
    std::fputs(viewer::keys_as_markdown().c_str(), stdout);
    return 0;
  }
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { interrupted = true; });
  const Pane only = arguments.only == "scene" ? Pane::scene : arguments.only == "sound" ? Pane::sound : Pane::any;
  return protocol::exit_status(
      [&] { return arguments.screenshot.empty() ? show(arguments, only) : screenshot(arguments, only); });
}

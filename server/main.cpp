// ringdownd: command line and settings file to DaemonOptions.
#include "packaging/manual/command_line.h"
#include "server/options.h"
#include "server/run_daemon.h"
#include "server/settings.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace {

// What the man page says beside the options.
const std::vector<ringdown::manual::Section> kSections = {
    {"FILES",
     {{"$XDG_CONFIG_HOME/ringdown/ringdownd.toml",
       "The settings, where --settings names no other file; ~/.config stands in for XDG_CONFIG_HOME. Every option may "
       "stand there under its long name, as rate = 44100, connect = true, object = [\"bell=bell.glb\"]; the command "
       "line wins."}}},
    {"SIGNALS", {{"SIGINT, SIGTERM", "End it cleanly, with exit code 0."}}},
    {"ENVIRONMENT",
     {{"JACK_DEFAULT_SERVER, JACK_NO_START_SERVER", "Which JACK server, and not to start one: see jackd(1)."},
      {"NOTIFY_SOCKET, WATCHDOG_USEC", "Set by systemd, which is told when sound runs and that it still does."}}},
    {"EXAMPLES",
     {{"ringdownd --object bell=bell.glb --connect", "One object, to the speakers."},
      {"ringdownd --scene demo.toml --driver wav -o demo.wav", "A scene to a file, as fast as it goes."},
      {"systemctl --user enable --now ringdownd", "As a service, from now on."}}},
    {"SEE ALSO", {{"ringdown(1), ringdown-bake(1), jackd(1)", "Its clients, what makes banks, and the sound server."}}},
};

}  // namespace

int main(int argc, char** argv) {
  using namespace ringdown;
  using namespace ringdown::server;
  spdlog::set_default_logger(spdlog::stderr_color_mt("ringdownd"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");

  DaemonOptions options;
  std::optional<std::string> settings;
  CLI::App app("Rings solid objects: a JACK client, struck by OSC messages.", "ringdownd");
  manual::add_common_options(app);
  add_options(app, options);
  app.add_option("--settings", settings,
                 "TOML file of options by their long names; none reads none (ringdown/ringdownd.toml in "
                 "$XDG_CONFIG_HOME, if there is one)")
      ->type_name("FILE")
      ->configurable(false);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return static_cast<int>(*ended);
  if (const auto file = settings_file(settings)) {
    if (const auto read = read_settings(app, *file); !read) return static_cast<int>(protocol::complain(read.error()));
  }
  return static_cast<int>(run_daemon(options));
}

// ringdownd: command line to DaemonOptions.
#include "server/daemon.h"

#include "protocol/names.h"

#include <CLI/CLI.hpp>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <map>

namespace {

using ringdown::server::DaemonOptions;

std::pair<std::string, std::filesystem::path> parse_object_option(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == text.npos || !ringdown::protocol::is_object_name(text.substr(0, equals))) {
    throw CLI::ValidationError("--object", "'" + text + "' is not NAME=BANK, where NAME is of A-Z a-z 0-9 _ . -");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

ringdown::server::Latency parse_latency_option(const std::string& text) {
  const auto latency = ringdown::server::parse_latency(text);
  if (!latency) throw CLI::ValidationError("--latency", latency.error().message);
  return *latency;
}

}  // namespace

int main(int argc, char** argv) {
  using ringdown::protocol::ExitCode;
  spdlog::set_default_logger(spdlog::stderr_color_mt("ringdownd"));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");

  DaemonOptions options;
  CLI::App app("Rings solid objects: a JACK client, struck by OSC messages (docs/protocol.md).", "ringdownd");
  app.set_version_flag("--version", RINGDOWN_VERSION);
  app.footer(std::string(ringdown::protocol::kExitCodeHelp));
  std::vector<std::string> objects;
  std::string latency;
  const std::map<std::string, DaemonOptions::DriverKind> drivers = {{"jack", DaemonOptions::DriverKind::jack},
                                                                    {"wav", DaemonOptions::DriverKind::wav},
                                                                    {"null", DaemonOptions::DriverKind::null}};
  app.add_option("--scene", options.scene, "Scene file to run (docs/scenes.md)")->type_name("FILE");
  app.add_option("--object", objects, "Object to load; may be given more than once")->type_name("NAME=BANK");
  app.add_option("--driver", options.driver, "jack; wav: render the scene to a file at full speed; null: no sound")
      ->transform(CLI::CheckedTransformer(drivers).description(""))
      ->type_name("jack|wav|null");
  app.add_option("--port", options.port, "UDP port for OSC; 0 takes any free one")->capture_default_str();
  app.add_option("--address", options.address, "Address to listen on; others than this machine's own let strangers in")
      ->capture_default_str();
  app.add_option(
         "--root", options.roots,
         "Folder that messages may open files in, may be given more than once; default: the current one. The presets "
         "and the folders of --object and --scene are always among them")
      ->type_name("DIR");
  app.add_option(
         "--latency", latency,
         "From an untimed message to its sound, always the same: frames, or with ms; default one block and a 16th")
      ->type_name("FRAMES|MSms");
  app.add_option_function<double>(
         "--merge", [&options](double merge_ms) { options.merge_s = 1e-3 * merge_ms; },
         "In a flood, strikes on one point so many ms apart become one; 0 merges none, and loses some; default 1")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("MS");
  app.add_option("--tcp", options.tcp_port,
                 "Receive OSC by TCP too, framed by SLIP, on this port; 0 takes any free one")
      ->type_name("PORT");
  app.add_option("--record", options.record, "Write all that is played as an OSC score, for `ringdown render --events`")
      ->type_name("FILE");
  app.add_option("--capture", options.capture, "Write what is rendered (null): .wav or .flac")->type_name("FILE");
  app.add_option("--scene-to", options.scene_to, "Send the scene's strikes to another daemon instead of playing them")
      ->type_name("osc.udp://HOST:PORT");
  app.add_option("--name", options.jack_name, "Name of the JACK client")->capture_default_str();
  app.add_flag("--connect", options.connect, "Connect to the speakers (JACK)");
  app.add_option("--rate", options.sample_rate_hz, "Sample rate in Hz (wav, null)")
      ->check(CLI::Range(8000.0, 768000.0))
      ->capture_default_str();
  app.add_option("--block", options.block_frames, "Frames per block (wav, null)")
      ->check(CLI::Range(1, 8192))
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Threads that mix big scenes, JACK's among them; the others spin")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--floor", options.floor_db, "Modes this many dB below full scale rest until they are struck")
      ->check(CLI::Range(20.0, 300.0))
      ->capture_default_str();
  app.add_option("--limiter", options.limiter_db,
                 "Keep the mix below a ceiling in dB, -1 unless given; it comes 2 ms later")
      ->expected(0, 1)
      ->default_str("-1")
      ->check(CLI::Range(-60.0, 0.0))
      ->type_name("DB");
  app.add_option("--seconds", options.seconds, "Stop after this time; wav: the length of the file")
      ->check(CLI::Range(0.0, 86400.0));
  app.add_option("-o,--output", options.output, "File to write (wav): .wav or .flac")->capture_default_str();
  try {
    app.parse(argc, argv);
    for (const std::string& text : objects) options.objects.push_back(parse_object_option(text));
    if (!latency.empty()) options.latency = parse_latency_option(latency);
  } catch (const CLI::ParseError& error) {
    const bool asked_for = error.get_exit_code() == 0;  // --help, --version
    return app.exit(error) == 0 && asked_for ? 0 : static_cast<int>(ExitCode::usage);
  }
  return static_cast<int>(ringdown::server::run_daemon(options));
}

#include "server/options.h"

#include "protocol/names.h"
#include "server/daemon.h"

#include <CLI/CLI.hpp>

#include <map>

namespace ringdown::server {
namespace {

std::pair<std::string, std::filesystem::path> parse_object(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == text.npos || !protocol::is_object_name(text.substr(0, equals))) {
    throw CLI::ValidationError("--object", "'" + text + "' is not NAME=BANK, where NAME is of A-Z a-z 0-9 _ . -");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

Latency parse_latency_option(const std::string& text) {
  const auto latency = parse_latency(text);
  if (!latency) throw CLI::ValidationError("--latency", latency.error().message);
  return *latency;
}

void add_what_to_play(CLI::App& app, DaemonOptions& options) {
  const auto take_objects = [&options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) options.objects.push_back(parse_object(text));
  };
  app.add_option("--scene", options.scene, "Scene file to run (docs/scenes.md)")->type_name("FILE");
  app.add_option_function<std::vector<std::string>>("--object", take_objects,
                                                    "Object to load; may be given more than once")
      ->type_name("NAME=BANK");
  app.add_option("--root", options.roots,
                 "Folder that messages may open files in, may be given more than once; default: the current one. The "
                 "presets and the folders of --object and --scene are always among them")
      ->type_name("FOLDER");
  app.add_option("--scene-to", options.scene_to, "Send the scene's strikes to another daemon instead of playing them")
      ->type_name("osc.udp://HOST:PORT");
  app.add_option("--record", options.record, "Write all that is played as an OSC score, for `ringdown render --events`")
      ->type_name("FILE");
}

void add_driver(CLI::App& app, DaemonOptions& options) {
  const std::map<std::string, DaemonOptions::DriverKind> drivers = {{"jack", DaemonOptions::DriverKind::jack},
                                                                    {"wav", DaemonOptions::DriverKind::wav},
                                                                    {"null", DaemonOptions::DriverKind::null}};
  const std::map<std::string, PortMode> ports = {
      {"mix", PortMode::mix}, {"objects", PortMode::objects}, {"groups", PortMode::groups}};
  app.add_option("--driver", options.driver, "jack; wav: render the scene to a file at full speed; null: no sound")
      ->transform(CLI::CheckedTransformer(drivers).description(""))
      ->type_name("jack|wav|null");
  app.add_option("--name", options.jack_name, "Name of the JACK client")->capture_default_str();
  app.add_flag("--connect", options.connect, "Connect to the speakers (JACK)");
  app.add_flag("--wait", options.wait, "Start without a JACK server, and wait for one");
  app.add_option("--ports", options.ports, "JACK outputs beside the stereo mix: none, one per object, one per group")
      ->transform(CLI::CheckedTransformer(ports).description(""))
      ->type_name("mix|objects|groups");
  app.add_option("--notes", options.notes, "What MIDI notes strike; default: objects in order, from note 60")
      ->type_name("FILE");
  app.add_option("--rate", options.sample_rate_hz, "Sample rate in Hz (wav, null)")
      ->check(CLI::Range(8000.0, 768000.0))
      ->capture_default_str();
  app.add_option("--block", options.block_frames, "Frames per block (wav, null)")
      ->check(CLI::Range(1, 8192))
      ->capture_default_str();
  app.add_option("--capture", options.capture, "Write what is rendered (null): .wav or .flac")->type_name("FILE");
  app.add_option("--seconds", options.seconds, "Stop after this time; wav: the length of the file")
      ->check(CLI::Range(0.0, 86400.0));
  app.add_option("-o,--output", options.output, "File to write (wav): .wav or .flac")
      ->type_name("FILE")
      ->capture_default_str();
}

void add_osc(CLI::App& app, DaemonOptions& options) {
  app.add_option("--port", options.port, "UDP port for OSC; 0 takes any free one")->capture_default_str();
  app.add_option("--address", options.address, "Address to listen on; others than this machine's own let strangers in")
      ->capture_default_str();
  app.add_option("--tcp", options.tcp_port,
                 "Receive OSC by TCP too, framed by SLIP, on this port; 0 takes any free one")
      ->type_name("PORT");
  app.add_option("--query", options.query_port,
                 "Describe the namespace by OSCQuery: JSON over HTTP, read-only, on this port; 0 takes any free one")
      ->type_name("PORT");
  app.add_option_function<std::string>(
         "--latency", [&options](const std::string& text) { options.latency = parse_latency_option(text); },
         "From an untimed message to its sound, always the same: frames, or with ms; default one block and a 16th")
      ->type_name("FRAMES|MSms");
  app.add_option_function<double>(
         "--merge", [&options](double merge_ms) { options.merge_s = 1e-3 * merge_ms; },
         "In a flood, strikes on one point so many ms apart become one; 0 merges none, and loses some; default 1")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("MS");
}

void add_mixer(CLI::App& app, DaemonOptions& options) {
  app.add_option("--threads", options.threads, "Threads that mix big scenes, JACK's among them; the others spin")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--floor", options.floor_db, "Modes this many dB below full scale rest until they are struck")
      ->check(CLI::Range(20.0, 300.0))
      ->capture_default_str();
  app.add_flag("--masking", options.masking, "Leave out modes that louder ones hide");
  app.add_option_function<double>(
         "--budget", [&options](double percent) { options.budget = 0.01 * percent; },
         "Of a block's time, what may be used before what is heard least is left out; 0: all, and more; default 80")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("PERCENT");
  app.add_option("--limiter", options.limiter_db,
                 "Keep the mix below a ceiling in dB, -1 unless given; it comes 2 ms later")
      ->expected(0, 1)
      ->default_str("-1")
      ->check(CLI::Range(-60.0, 0.0))
      ->type_name("DB");
}

}  // namespace

void add_options(CLI::App& app, DaemonOptions& options) {
  add_what_to_play(app, options);
  add_driver(app, options);
  add_osc(app, options);
  add_mixer(app, options);
}

}  // namespace ringdown::server

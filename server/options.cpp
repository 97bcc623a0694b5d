#include "server/options.h"

#include "engine/base/folders.h"
#include "engine/base/object_name.h"
#include "packaging/manual/command_line.h"
#include "server/sound_options.h"

#include <cmath>
#include <cstdio>
#include <map>

namespace ringdown::server {
namespace {

std::filesystem::path found(const std::string& option, const std::string& given, PresetKind kind) {
  const auto path = preset_or_file(given, kind);
  if (!path) throw manual::WrongValue{option, path.error().message};
  return *path;
}

std::pair<std::string, std::filesystem::path> parse_object(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == text.npos || !is_object_name(text.substr(0, equals))) {
    throw manual::WrongValue{"--object", "'" + text + "' is not NAME=BANK, where NAME is of A-Z a-z 0-9 _ . -"};
  }
  return {text.substr(0, equals), found("--object", text.substr(equals + 1), PresetKind::bank)};
}

Vec3 parse_vector(const std::string& text, const std::string& whole, double max) {
  Vec3 v;
  int used = 0;
  const bool good = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v.x, &v.y, &v.z, &used) == 3 &&
                    static_cast<std::size_t>(used) == text.size() && std::abs(v.x) <= max && std::abs(v.y) <= max &&
                    std::abs(v.z) <= max;
  if (good) return v;
  throw manual::WrongValue{
      "--input", formatted("'{}': '{}' is not X,Y,Z, each number at most {}", whole, text, static_cast<int>(max))};
}

DaemonOptions::Input parse_input(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  if (parts.size() > 3 || !is_object_name(parts[0])) {
    throw manual::WrongValue{"--input", "'" + text + "' is not OBJECT, OBJECT:X,Y,Z or OBJECT:X,Y,Z:FX,FY,FZ"};
  }
  DaemonOptions::Input input{.object = parts[0]};
  if (parts.size() > 1) input.point_m = parse_vector(parts[1], text, 1e4);
  if (parts.size() > 2) input.force_n = parse_vector(parts[2], text, 1e6);
  return input;
}

Latency parse_latency_option(const std::string& text) {
  const auto latency = parse_latency(text);
  if (!latency) throw manual::WrongValue{"--latency", latency.error().message};
  return *latency;
}

void add_what_to_play(manual::App& app, DaemonOptions& options) {
  const auto take_objects = [&options](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) options.objects.push_back(parse_object(text));
  };
  app.add_option_function<std::string>(
         "--scene",
         [&options](const std::string& given) { options.scene = found("--scene", given, PresetKind::scene); },
         "Scene to run: a file (docs/use/scenes.md), or the name of a preset like demo")
      ->type_name("FILE");
  app.add_option_function<std::vector<std::string>>(
         "--object", take_objects,
         "Object to load: its new name, and a bank file or the name of a preset; may be given more than once")
      ->type_name("NAME=BANK");
  app.add_option("--state", options.state, "Objects, inputs and scene as /state/save wrote them")->type_name("FILE");
  app.add_option("--root", options.roots,
                 "Folder in which messages may open files; may be given more than once; default: the current folder. "
                 "The presets, the banks of meshes dropped onto the window, and the folders of --object, --scene and "
                 "--state are always included")
      ->type_name("FOLDER");
  app.add_option("--scene-to", options.scene_to, "Send the scene's strikes to another daemon instead of playing them")
      ->type_name("osc.udp://HOST:PORT");
  app.add_option("--record", options.record,
                 "Write everything that is played as an OSC score, for `ringdown render --events`")
      ->type_name("FILE");
}

void add_driver(manual::App& app, DaemonOptions& options) {
  const std::map<std::string, DaemonOptions::DriverKind> drivers = {{"jack", DaemonOptions::DriverKind::jack},
                                                                    {"wav", DaemonOptions::DriverKind::wav},
                                                                    {"null", DaemonOptions::DriverKind::null}};
  const std::map<std::string, session::PortMode> ports = {
      {"mix", session::PortMode::mix}, {"objects", session::PortMode::objects}, {"groups", session::PortMode::groups}};
  app.add_choice("--driver", options.driver, drivers,
                 "jack: play through JACK; wav: render the scene to a file at full speed; null: make no sound")
      ->type_name("jack|wav|null");
  app.add_option("--name", options.jack_name, "Name of the JACK client")->capture_default_str();
  app.add_flag("--connect", options.connect,
               "Connect to the speakers, and to the first MIDI keyboard as soon as there is one (JACK)");
  app.add_option("--keyboard", options.keyboard,
                 "Connect to the first MIDI port with this in its name, as soon as there is one (JACK)")
      ->type_name("NAME");
  app.add_flag("--wait", options.wait, "Start without a JACK server, and wait for one");
  app.add_choice("--ports", options.ports, ports,
                 "JACK outputs beside the stereo mix: none, one per object, one per group")
      ->type_name("mix|objects|groups");
  app.add_option_function<std::string>(
         "--notes",
         [&options](const std::string& given) { options.notes = found("--notes", given, PresetKind::notes); },
         "What MIDI notes strike: a file, or the name of a preset; default: objects in order, from note 60")
      ->type_name("FILE");
  const auto take_inputs = [&options](const std::vector<std::string>& texts) {
    if (texts.size() > protocol::kMaxInputs) {
      throw manual::WrongValue{"--input", formatted("at most {} inputs can be given", protocol::kMaxInputs)};
    }
    for (const std::string& text : texts) options.inputs.push_back(parse_input(text));
  };
  app.add_option_function<std::vector<std::string>>("--input", take_inputs,
                                                    "Object that a JACK input (in_1, in_2 ...) excites, the point [m], "
                                                    "and the force of a sample of 1 [N]; may be given up to four times")
      ->type_name("OBJECT[:X,Y,Z[:FX,FY,FZ]]");
  app.add_option("--rate", options.sample_rate_hz, "Sample rate in Hz (wav, null)")
      ->check(manual::between(8000.0, 768000.0))
      ->capture_default_str();
  app.add_option("--block", options.block_frames, "Frames per block (wav, null)")
      ->check(manual::between(1, 8192))
      ->capture_default_str();
  app.add_option("--capture", options.capture, "Write the mix to a file: .wav or .flac")->type_name("FILE");
  app.add_option("--seconds", options.seconds, "Stop after this time; wav: the length of the file")
      ->check(manual::between(0.0, 86400.0));
  app.add_option("-o,--output", options.output, "File to write (wav): .wav or .flac")
      ->type_name("FILE")
      ->capture_default_str();
}

void add_osc(manual::App& app, DaemonOptions& options) {
  const manual::Check port = manual::between(0, 65535);
  app.add_option("--port", options.port, "UDP port for OSC; 0 takes any free one")->check(port)->capture_default_str();
  app.add_option("--address", options.address,
                 "Address to listen on; any but 127.x.x.x and ::1 lets other computers in")
      ->capture_default_str();
  app.add_option("--tcp", options.tcp_port,
                 "Also accept OSC over TCP on this port, in SLIP frames or with length prefixes; 0 takes any free one")
      ->check(port)
      ->type_name("PORT");
  app.add_option("--query", options.query_port,
                 "Describe the namespace by OSCQuery (JSON over HTTP, read-only) on this port; 0 takes any free one")
      ->check(port)
      ->type_name("PORT");
  app.add_flag("--zeroconf", options.zeroconf, "Announce the OSC ports on the network by Zeroconf (Avahi)");
  app.add_option_function<std::string>(
         "--latency", [&options](const std::string& text) { options.latency = parse_latency_option(text); },
         "Constant delay from an untimed message to its sound, in frames, or in ms as 5ms; default: one block and a "
         "sixteenth")
      ->type_name("FRAMES|MSms");
  app.add_option_function<double>(
         "--merge", [&options](double merge_ms) { options.merge_s = 1e-3 * merge_ms; },
         "In a flood, merge strikes on one point within this many ms; 0 merges none, so some may be lost; default: 1")
      ->check(manual::between(0.0, 100.0))
      ->type_name("MS");
}

void add_mixer(manual::App& app, DaemonOptions& options) {
  app.add_option("--threads", options.mixer.threads, "Threads that mix large scenes, including JACK's; the others spin")
      ->check(manual::between(1, 64))
      ->capture_default_str();
  app.add_option_function<double>(
         "--budget", [&options](double percent) { options.mixer.budget = 0.01 * percent; },
         "jack: share of a block's time that the mixer may use before it mutes the least audible modes; 0: no limit; "
         "default: 80")
      ->check(manual::between(0.0, 100.0))
      ->type_name("PERCENT");
  add_sound_options(app, options.mixer);
}

}  // namespace

void add_options(manual::App& app, DaemonOptions& options) {
  add_what_to_play(app, options);
  add_driver(app, options);
  add_osc(app, options);
  add_mixer(app, options);
}

}  // namespace ringdown::server

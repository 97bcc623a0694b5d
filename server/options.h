// The options of ringdownd, and the one table from which its command line and --help are made. [main]
//
//   DaemonOptions options;
//   manual::App app;
//   add_options(app, options);  // app fills options when it parses; options must outlive it
//
// A new option is a member of DaemonOptions and a row in options.cpp.
#pragma once

#include "engine/base/vec3.h"
#include "protocol/defaults.h"
#include "server/latency.h"
#include "server/session/buses.h"
#include "engine/synth/mixer.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::manual {
class App;
}

namespace ringdown::server {

struct DaemonOptions {
  enum class DriverKind { jack, wav, null };
  DriverKind driver = DriverKind::jack;
  std::vector<std::pair<std::string, std::filesystem::path>> objects;  // name and bank
  struct Input {
    std::string object;
    std::optional<Vec3> point_m, force_n;  // in the object's frame; absent: chosen from its bank
  };
  std::vector<Input> inputs;                   // JACK ports in_1 and so on, and the objects that they excite
  std::optional<std::filesystem::path> state;  // loaded after objects, inputs and scene (state.h)
  std::optional<std::filesystem::path> scene;
  std::optional<std::string> scene_to;  // osc.udp://host:port that gets the scene's strikes instead of our own mixer
  std::string address = "127.0.0.1";    // where OSC is received
  std::uint16_t port = protocol::kDefaultPort;   // 0: any free one
  std::optional<std::uint16_t> tcp_port;         // OSC by TCP as well; 0: any free one
  std::optional<std::uint16_t> query_port;       // OSCQuery over HTTP; 0: any free one
  bool zeroconf = false;                         // announce both OSC ports
  std::optional<std::filesystem::path> record;   // file for the whole session, as an OSC score
  std::optional<std::filesystem::path> capture;  // sound file for what the null driver renders
  double merge_s = 0.001;                    // in a flood, strikes on one point this close become one (strike_merger.h)
  std::vector<std::filesystem::path> roots;  // folders in which messages may open files; empty: the current folder
  Latency latency;                           // latency of untimed messages
  std::string jack_name = "ringdown";
  std::optional<std::filesystem::path> notes;        // note map for MIDI (note_map.h)
  session::PortMode ports = session::PortMode::mix;  // JACK ports in addition to the stereo mix
  bool connect = false;                              // connect to the speakers, and to a keyboard
  std::optional<std::string> keyboard;               // part of the name of the keyboard to connect to
  bool wait = false;                                 // wait for a JACK server if there is none yet
  double sample_rate_hz = 48000;                     // wav, null, and until there is a JACK server
  std::size_t block_frames = 256;                    // wav, null, and until there is a JACK server
  synth::MixerSettings mixer = {.budget = 0.8};      // the budget counts with jack only
  std::optional<double> seconds;                     // null, jack: stop after this time; wav: length of the file
  std::filesystem::path output = "ringdown.wav";     // wav
};

// Adds all options to the app. A wrong value (a number out of range, an object without a name) ends the parsing with a
// sentence that names the option.
void add_options(manual::App& app, DaemonOptions& options);

}  // namespace ringdown::server

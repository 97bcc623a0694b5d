// The state of a daemon as a readable TOML file: objects with bank, gain, pan, material and group; the objects that
// inputs excite; the listener; the scene. `--state` and session managers load the file; `/state/save` and session
// managers write it.
//
//   [[object]]
//   name = "bell"
//   bank = "/home/me/banks/bell.glb"
//   gain = 0.5                                # this and all below may be left out: 1, 0, the bank's own, none
//   pan = -0.3
//   group = "metal"
//   mute = false
//   solo = false
//   material = { alpha = 1, beta = 1, density = 1, stiffness = 4, size = 1, heat = 1, air = 1 }   # factors
//   modes = { first = 0, count = 20 }         # by ascending frequency, as in /object/.../modes
//   [[object.touch]]                          # as in /object/.../hold
//   number = 0
//   point_m = [0.05, 0, 0.02]
//   direction = [0, 0, 0]
//   damping_ns_m = 5
//
//   [[input]]
//   input = 1
//   object = "bell"
//   point_m = [0.05, 0, 0.02]
//   force_n = [0, 0, -1]
//
//   [listener]                                # as in /listener and /listener/air
//   on = true                                 # false: nobody listens, even if the scene has a listener
//   position_m = [0, -2, 1]
//   rotation = [0, 0, 0, 1]
//   temperature_c = 20
//   humidity_percent = 50
//
//   [scene]
//   file = "/home/me/scenes/drop.toml"        # starts from its beginning
//   paused = false
//   cleared = false                           # whether its bodies were removed
//
// The file does not contain ringing sound, the poses of bodies and objects, spawned bodies, pickups, or the connections
// of ports, which a session manager keeps itself. [worker, or before the worker runs]
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/modal/damper.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_range.h"
#include "engine/modal/tubes/tube_tuning.h"
#include "engine/synth/events/event.h"
#include "server/session/listener_memory.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::session {

class Session;

struct State {
  struct Object {
    std::string name;
    std::filesystem::path bank;
    double gain = 1, pan = 0;
    std::string group;  // empty: the object is in no group
    modal::MaterialScale material;
    modal::ModeRange modes;
    modal::Dampers dampers;  // except the dampers of the scene
    bool mute = false, solo = false;
    std::optional<double> level_m;           // of its liquid; nothing: as baked
    std::optional<modal::TubeTuning> tubes;  // nothing: as baked
    double fan_hz = 0, fan_depth = 0;
  };
  struct Input {
    std::size_t input = 1;  // in_1 is 1
    std::string object;
    Vec3 point_m, force_n;
  };
  struct Scene {
    std::filesystem::path file;
    bool paused = false, cleared = false;
  };
  std::vector<Object> objects;
  std::vector<Input> inputs;
  std::optional<ListenerMemory::Listener> listener;
  std::optional<Scene> scene;
};

// Reads a state. Errors begin with path:line and name the missing, wrong or unknown key.
Result<State> read_state(const std::filesystem::path& path);
Result<State> parse_state(std::string_view text, const std::filesystem::path& path);

std::string to_toml(const State& state);
Result<void> write_state(const State& state, const std::filesystem::path& path);

// Returns the present state of the session. Banks get absolute paths.
State state_of(const Session& session);

// Loads the objects, inputs, listener and scene that the state names. Other objects stay; a scene that plays ends. The
// new scene starts at `frame`. Stops at the first error.
Result<void> restore(const State& state, Session& session, synth::Frame frame);

}  // namespace ringdown::session

#include "server/session/state.h"

#include "engine/base/atomic_file.h"
#include "engine/base/quote.h"
#include "engine/base/toml_table.h"
#include "engine/base/version.h"
#include "protocol/names.h"
#include "server/session/file_roots.h"
#include "server/session/session.h"

#include <cmath>

namespace ringdown::session {
namespace {

constexpr Range kGain{0, 100}, kPan{-1, 1}, kDamping{0, 1e3}, kScale{1e-3, 1e3}, kSize{1e-2, 1e2};
constexpr Range kPosition_m{-1e4, 1e4}, kForce_n{-1e6, 1e6}, kDirection{-1e3, 1e3}, kDamping_ns_m{0, 1e6};
constexpr Range kTemperature_c{-50, 60}, kHumidity_percent{0, 100};

void read_name(TomlTable& table, std::string_view key, std::string& name) {
  table.text(key, name);
  if (!name.empty() && !is_object_name(name)) {
    table.complain(key, "a name is 1 to 64 of A-Z a-z 0-9 _ . - and not digits only");
  }
}

void read_damper(TomlTable& table, modal::Dampers& dampers) {
  std::uint64_t number = 0;
  modal::Damper damper;
  table.require({"point_m", "damping_ns_m"});
  table.whole("number", number, 0, modal::kFirstSceneDamper - 1);
  table.vector("point_m", damper.point_m, kPosition_m);
  table.vector("direction", damper.direction, kDirection);
  table.number("damping_ns_m", damper.damping_ns_m, kDamping_ns_m);
  dampers[static_cast<std::uint32_t>(number)] = damper;
}

modal::ModeRange read_modes(TomlTable& table) {
  std::uint64_t first = 0, count = modal::ModeRange::kAll;
  table.whole("first", first, 0, protocol::kMaxNumber);
  table.whole("count", count, 0, modal::ModeRange::kAll);
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)};
}

State::Object read_object(TomlTable& table) {
  State::Object object;
  std::string bank;
  table.require({"name", "bank"});
  read_name(table, "name", object.name);
  table.text("bank", bank);
  object.bank = bank;
  table.number("gain", object.gain, kGain);
  table.number("pan", object.pan, kPan);
  if (table.has("group")) read_name(table, "group", object.group);
  table.boolean("mute", object.mute);
  table.boolean("solo", object.solo);
  if (auto material = table.table("material")) {
    material->number("alpha", object.material.alpha, kDamping);
    material->number("beta", object.material.beta, kDamping);
    material->number("density", object.material.density, kScale);
    material->number("stiffness", object.material.stiffness, kScale);
    material->number("size", object.material.size, kSize);
    material->number("heat", object.material.heat, kDamping);
    material->number("air", object.material.air, kDamping);
  }
  if (table.has("level_m")) table.number("level_m", object.level_m.emplace(), kPosition_m);
  if (auto tubes = table.table("resonator")) {
    modal::TubeTuning& tuning = object.tubes.emplace();
    tubes->number("detune_cents", tuning.detune_cents, modal::kTubeDetune_cents);
    tubes->number("opening", tuning.opening, modal::kTubeOpening);
  }
  if (auto fan = table.table("fan")) {
    fan->number("rate_hz", object.fan_hz, synth::verb::Fan::kRate_hz);
    fan->number("depth", object.fan_depth, synth::verb::Fan::kDepth);
  }
  if (auto modes = table.table("modes")) object.modes = read_modes(*modes);
  for (TomlTable& damper : table.tables("touch")) read_damper(damper, object.dampers);
  return object;
}

State::Input read_input(TomlTable& table) {
  State::Input input;
  std::uint64_t number = 1;
  table.require({"input", "object", "point_m", "force_n"});
  table.whole("input", number, 1, protocol::kMaxInputs);
  input.input = number;
  read_name(table, "object", input.object);
  table.vector("point_m", input.point_m, kPosition_m);
  table.vector("force_n", input.force_n, kForce_n);
  return input;
}

ListenerMemory::Listener read_listener(TomlTable& table) {
  ListenerMemory::Listener listener{.on = true};
  std::vector<double> turn{0, 0, 0, 1};
  table.boolean("on", listener.on);
  table.vector("position_m", listener.pose.position_m, kPosition_m);
  table.numbers("rotation", turn);
  if (turn.size() == 4) listener.pose.rotation = Rotation::from_xyzw(turn[0], turn[1], turn[2], turn[3]);
  if (turn.size() != 4 || std::abs(norm(listener.pose.rotation) - 1) > 1e-6) {
    table.complain("rotation", "rotation must be a quaternion of length 1, [x, y, z, w]");
  }
  table.number("temperature_c", listener.temperature_c, kTemperature_c);
  table.number("humidity_percent", listener.humidity_percent, kHumidity_percent);
  return listener;
}

State::Scene read_scene(TomlTable& table) {
  State::Scene scene;
  std::string file;
  table.require({"file"});
  table.text("file", file);
  scene.file = file;
  table.boolean("paused", scene.paused);
  table.boolean("cleared", scene.cleared);
  return scene;
}

}  // namespace

Result<State> read_state(const std::filesystem::path& path) {
  const auto text = read_whole_file(path, kMaxTomlFileBytes);
  if (!text) return fail(text);
  return parse_state(*text, path);
}

Result<State> parse_state(std::string_view text, const std::filesystem::path& path) {
  auto file = TomlTable::parse(text, path);
  if (!file) return fail(file);
  State state;
  for (TomlTable& table : file->tables("object")) state.objects.push_back(read_object(table));
  for (TomlTable& table : file->tables("input")) state.inputs.push_back(read_input(table));
  if (auto table = file->table("listener")) state.listener = read_listener(*table);
  if (auto table = file->table("scene")) state.scene = read_scene(*table);
  if (const auto good = file->finish(); !good) return fail(good);
  return state;
}

std::string to_toml(const State& state) {
  std::string text = formatted("{}; ringdownd --state reads it.\nversion = {}\n", kStateKind.mark, kTextFileVersion);
  for (const State::Object& object : state.objects) {
    text += "\n[[object]]\nname = " + toml_string(object.name) + "\nbank = " + toml_string(object.bank.string()) + "\n";
    text += formatted("gain = {}\npan = {}\n", toml_number(object.gain), toml_number(object.pan));
    if (!object.group.empty()) text += "group = " + toml_string(object.group) + "\n";
    if (object.mute) text += "mute = true\n";
    if (object.solo) text += "solo = true\n";
    const modal::MaterialScale& m = object.material;
    if (m != modal::MaterialScale{}) {
      text += "material = { alpha = " + toml_number(m.alpha) + ", beta = " + toml_number(m.beta) +
              ", density = " + toml_number(m.density) + ", stiffness = " + toml_number(m.stiffness) +
              ", size = " + toml_number(m.size) + ", heat = " + toml_number(m.heat) + ", air = " + toml_number(m.air) +
              " }\n";
    }
    if (object.level_m) text += "level_m = " + toml_number(*object.level_m) + "\n";
    if (object.tubes)
      text += "resonator = { detune_cents = " + toml_number(object.tubes->detune_cents) +
              ", opening = " + toml_number(object.tubes->opening) + " }\n";
    if (object.fan_depth > 0)
      text += "fan = { rate_hz = " + toml_number(object.fan_hz) + ", depth = " + toml_number(object.fan_depth) + " }\n";
    if (object.modes != modal::ModeRange{}) {
      text += "modes = { first = " + std::to_string(object.modes.first) +
              ", count = " + std::to_string(object.modes.count) + " }\n";
    }
    for (const auto& [number, damper] : object.dampers) {
      text += "[[object.touch]]\nnumber = " + std::to_string(number) + "\npoint_m = " + toml_vector(damper.point_m) +
              "\ndirection = " + toml_vector(damper.direction) +
              "\ndamping_ns_m = " + toml_number(damper.damping_ns_m) + "\n";
    }
  }
  for (const State::Input& input : state.inputs) {
    text += "\n[[input]]\ninput = " + std::to_string(input.input) + "\nobject = " + toml_string(input.object) +
            "\npoint_m = " + toml_vector(input.point_m) + "\nforce_n = " + toml_vector(input.force_n) + "\n";
  }
  const auto flag = [](bool on) { return on ? "true\n" : "false\n"; };
  if (const auto& listener = state.listener) {
    const Rotation& turn = listener->pose.rotation;
    text += "\n[listener]\non = " + std::string(flag(listener->on)) +
            "position_m = " + toml_vector(listener->pose.position_m) + "\nrotation = [" + toml_number(turn.x) + ", " +
            toml_number(turn.y) + ", " + toml_number(turn.z) + ", " + toml_number(turn.w) +
            "]\ntemperature_c = " + toml_number(listener->temperature_c) +
            "\nhumidity_percent = " + toml_number(listener->humidity_percent) + "\n";
  }
  if (!state.scene) return text;
  return formatted("{}\n[scene]\nfile = {}\npaused = {}cleared = {}", text, toml_string(state.scene->file.string()),
                   flag(state.scene->paused), flag(state.scene->cleared));
}

Result<void> write_state(const State& state, const std::filesystem::path& path) {
  return write_file_atomically(path, to_toml(state));
}

State state_of(const Session& session) {
  const Rack& rack = session.rack();
  State state;
  std::error_code ignored;
  for (const ObjectSnapshot& snapshot : rack.objects()) {
    if (session.breakage().is_piece(snapshot->number) || session.scene().pieces().contains(snapshot->number))
      continue;  // the whole object is saved
    const ObjectState object = untuned(*snapshot);
    const auto scenes = object.dampers.lower_bound(modal::kFirstSceneDamper);
    state.objects.push_back({object.name,
                             std::filesystem::absolute(object.bank, ignored),
                             object.gain,
                             object.pan,
                             object.group,
                             object.material,
                             object.modes,
                             {object.dampers.begin(), scenes},
                             object.mute,
                             object.solo,
                             level_m(object),
                             tube_tuning(object),
                             object.fan_hz,
                             object.fan_depth});
  }
  for (std::size_t input = 0; input < rack.excitations().size(); ++input) {
    const auto& excitation = rack.excitations()[input];
    const auto object = excitation ? rack.find({.number = excitation->object}) : fail(ErrorKind::bad_input, "");
    if (object) state.inputs.push_back({input + 1, (*object)->name, excitation->point_m, excitation->force_n});
  }
  state.listener = rack.listener().last();
  if (const auto playing = session.scene().playing()) {
    state.scene = {std::filesystem::absolute(playing->file, ignored), playing->paused, playing->cleared};
  }
  return state;
}

namespace {

Result<void> restore_scene(const State::Scene& scene, Session& session, synth::Frame frame) {
  if (const auto loaded = session.scene().load(scene.file, frame); !loaded) return fail(loaded);
  if (scene.paused) {
    if (const auto paused = session.scene().pause(true); !paused) return paused;
  }
  return scene.cleared ? session.scene().clear() : Result<void>{};
}

// Returns the changes that replace an object's `present` dampers by the `wanted` ones. A scene's dampers stay.
modal::Dampers damper_changes(const modal::Dampers& wanted, const modal::Dampers& present) {
  modal::Dampers changes = wanted;
  for (const auto& [number, damper] : present) {
    if (number < modal::kFirstSceneDamper) changes.try_emplace(number);  // no damping: removed
  }
  return changes;
}

// `from` is the frame at which a restored scene sets gains and pans; the object's own are set again at that frame.
Result<void> restore_object(const State::Object& object, Session& session, synth::Frame from) {
  Rack& rack = session.rack();
  const protocol::ObjectRef ref{.name = object.name};
  const bool was_there = rack.find(ref).has_value();
  const auto number = session.perform(protocol::LoadObject{object.name, object.bank.string()}, from);
  if (!number) return fail(number);
  if (const auto set = rack.set_group(ref, object.group); !set) return set;
  if (const auto set = rack.set_heard(ref, &ObjectState::mute, object.mute); !set) return set;
  if (const auto set = rack.set_heard(ref, &ObjectState::solo, object.solo); !set) return set;
  if (object.material != (*rack.find(ref))->material) {
    if (const auto set = rack.set_material(ref, object.material); !set) return set;
  }
  if (object.level_m) {
    if (const auto set = rack.set_level(ref, *object.level_m); !set) return set;
  }
  if (object.tubes) {
    if (const auto set = rack.set_tubes(ref, *object.tubes); !set) return set;
  }
  if (object.modes != modal::ModeRange{}) {
    if (const auto set = rack.select_modes(ref, object.modes); !set) return set;
  }
  if (const auto held = rack.set_dampers(ref, damper_changes(object.dampers, (*rack.find(ref))->dampers)); !held)
    return held;
  const synth::Frame now = rack.mixer().counters().frames;
  for (const synth::Verb& verb :
       {synth::Verb(synth::verb::Gain{object.gain}), synth::Verb(synth::verb::Pan{object.pan}),
        synth::Verb(synth::verb::Fan{object.fan_hz, object.fan_depth})}) {
    if (verb.holds<synth::verb::Fan>() && !was_there && !(object.fan_depth > 0)) continue;
    for (const synth::Frame frame : {now, from}) {
      if (frame == from && (!was_there || from == now)) continue;
      const auto which = static_cast<synth::ObjectNumber>(**number);
      if (!rack.push(synth::Producer::worker, {frame, which, verb})) {
        return fail(ErrorKind::refused, "too many objects at once; wait for those before to be taken up");
      }
    }
  }
  return {};
}

Result<void> restore_listener(const ListenerMemory::Listener& listener, Session& session, synth::Frame frame) {
  const synth::verb::ListenerAir air_verb{listener.temperature_c, listener.humidity_percent};
  const synth::Event air{.frame = frame, .verb = air_verb};
  synth::Event place{.frame = frame, .verb = synth::verb::ListenerOff{}};
  if (listener.on) {
    place.verb = synth::verb::Listener{{listener.pose.position_m, normalized(listener.pose.rotation)}};
  }
  Rack& rack = session.rack();
  if (rack.push(synth::Producer::worker, air) && rack.push(synth::Producer::worker, place)) return {};
  return fail(ErrorKind::refused, "listener: too many changes at once; try again");
}

}  // namespace

Result<void> restore(const State& state, Session& session, synth::Frame frame) {
  if (state.scene) {
    if (const auto restored = restore_scene(*state.scene, session, frame); !restored) return restored;
  }
  for (const State::Object& object : state.objects) {
    if (const auto restored = restore_object(object, session, frame); !restored) return restored;
  }
  if (state.listener) {
    if (const auto restored = restore_listener(*state.listener, session, frame); !restored) return restored;
  }
  for (const State::Input& input : state.inputs) {
    const auto set = session.rack().excite(input.input - 1, {.name = input.object}, input.point_m, input.force_n);
    if (!set) return set;
  }
  return {};
}

}  // namespace ringdown::session

#include "clients/viewer/commands.h"

#include "clients/viewer/mode_list.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>

namespace ringdown::viewer {
namespace {

using modal::MaterialScale;
using modal::ModeRange;
using protocol::ObjectRef;
using protocol::Request;

constexpr std::uint32_t kHighest = 20;
constexpr double kSemitone = 1.122462048309373;  // factor of stiffness or density; frequency follows its square root
constexpr double kDampingStep = 1.4142135623730951;
constexpr double kForceStep = 1.4142135623730951;

ObjectRef ref(const std::string& name) { return {name, std::nullopt}; }

std::string stem_of(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  for (char& c : name) {
    if (c == ' ' || c == '/') c = '-';
  }
  return name;
}

}  // namespace

std::string time_of_day() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[48];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &local);
  return text;
}

void Commands::update(double now_s) {
  edits_.update(now_s);
  loader_.update(now_s);
  if (!chosen() || !chosen_by_hand_) {
    const auto& objects = model_.objects();
    const auto richest = std::ranges::max_element(objects, {}, [](const auto& entry) { return entry.second.modes; });
    choose_object(richest == objects.end() ? std::string() : richest->first);
    chosen_by_hand_ = false;
  }
}

void Commands::restart() {
  edits_.restart();
  choice_.tone = false;
  loader_.stop_waiting();
}

void Commands::choose_object(const std::string& name) {
  chosen_by_hand_ = true;
  if (name == choice_.object) return;
  choice_.object = name;
  choice_.mode = choice_.node = 0;
  model_.choose(name);
}

void Commands::strike(const std::string& object, Vec3 point_m, Vec3 normal, double impulse_ns) {
  send_(protocol::Strike{ref(object), {point_m, -impulse_ns * normal, choice_.contact_time_s}});
}

void Commands::project_test_force() {
  const KnownObject* object = chosen();
  if (!object || !object->bank) return;
  const modal::Bank& bank = object->bank->bank;
  const auto node = std::min<std::uint32_t>(choice_.node, static_cast<std::uint32_t>(bank.point_count()) - 1);
  send_(protocol::StrikeVertex{ref(object->name),
                               {node, -choice_.impulse_ns * outward_normal(bank, node), choice_.contact_time_s}});
}

void Commands::play_modes(ModeRange range) {
  const KnownObject* object = chosen();
  if (!object) return;
  if (edits_.adjustment_of(*object).range != range)
    edits_.change(*object, protocol::SelectModes{ref(object->name), range}, "modes");
  send_(protocol::RingModes{
      ref(object->name),
      {range.first, range.count, synth::kDefaultRingAmplitude / std::sqrt(std::max(1, object->modes))}});
}

void Commands::hear_alone(const KnownObject& object, std::uint32_t rank) {
  choose_object(object.name);
  choice_.mode = rank;
  const ModeRange alone{rank, 1};
  if (edits_.adjustment_of(object).range == alone) {
    edits_.change(object, protocol::SelectModes{ref(object.name), {}}, "modes");
    return;
  }
  edits_.change(object, protocol::SelectModes{ref(object.name), alone}, "modes");
  send_(protocol::RingModes{ref(object.name), {rank, 1, synth::kDefaultRingAmplitude}});
}

void Commands::step_mode_count(int by) {
  const KnownObject* object = chosen();
  if (!object || object->modes == 0) return;
  const ModeRange now = edits_.adjustment_of(*object).range;
  const auto max = static_cast<std::uint32_t>(object->modes);
  const std::uint32_t had = now.first >= max ? 0 : std::min(now.count, max - now.first);
  const auto step = static_cast<int>(std::max<std::uint32_t>(1, had / 10));
  const int count = std::clamp(static_cast<int>(had) + by * step, 1, object->modes);
  const ModeRange range{0, count == object->modes ? ModeRange::kAll : static_cast<std::uint32_t>(count)};
  if (range != now) edits_.change(*object, protocol::SelectModes{ref(object->name), range}, "modes");
}

void Commands::scale_material(double MaterialScale::*factor, double by) {
  const KnownObject* object = chosen();
  if (!object) return;
  MaterialScale scale = edits_.adjustment_of(*object).scale;
  scale.*factor = std::clamp(scale.*factor * by, 1e-3, 1e3);
  edits_.change(*object, protocol::SetMaterial{ref(object->name), scale}, "material");
}

void Commands::step_object(int by) {
  const auto& objects = model_.objects();
  if (objects.empty()) return;
  auto at = objects.find(choice_.object);
  if (at == objects.end()) return choose_object(objects.begin()->first);
  if (by > 0) {
    if (++at == objects.end()) at = objects.begin();
  } else {
    at = std::prev(at == objects.begin() ? objects.end() : at);
  }
  choose_object(at->first);
}

void Commands::step_node(int by) {
  const KnownObject* object = chosen();
  if (!object || !object->bank) return;
  const auto nodes = static_cast<int>(object->bank->bank.point_count());
  choice_.node = static_cast<std::uint32_t>((static_cast<int>(choice_.node) + by + nodes) % nodes);
}

void Commands::step_mode(int by) {
  const KnownObject* object = chosen();
  if (!object || object->modes == 0) return;
  choice_.mode = static_cast<std::uint32_t>(std::clamp(static_cast<int>(choice_.mode) + by, 0, object->modes - 1));
}

void Commands::load_scene(const std::string& path) {
  edits_.forget_bodies();
  loader_.load(path);
}

void Commands::load_bank(const std::string& path) { send_(protocol::LoadObject{stem_of(path), path}); }

void Commands::toggle_recording() {
  if (model_.recording()) {
    send_(protocol::RecordStop{});
  } else {
    send_(protocol::RecordStart{"ringdown-" + time_of_day() + ".osc"});
  }
}

void Commands::set_mute(const KnownObject& object, bool on) {
  send_(protocol::SetMute{ref(object.name), on});
  send_(protocol::DescribeObject{ref(object.name)});
}

void Commands::set_solo(const KnownObject& object, bool on) {
  send_(protocol::SetSolo{ref(object.name), on});
  send_(protocol::DescribeObject{ref(object.name)});
}

bool Commands::perform(Action action) {
  return perform_choice(action) || perform_material(action) || perform_modes(action) || perform_scene(action);
}

bool Commands::perform_choice(Action action) {
  switch (action) {
    case Action::undo:
      return edits_.undo(), true;
    case Action::redo:
      return edits_.redo(), true;
    case Action::record:
      return toggle_recording(), true;
    case Action::next_object:
      return step_object(1), true;
    case Action::previous_object:
      return step_object(-1), true;
    case Action::next_node:
      return step_node(1), true;
    case Action::previous_node:
      return step_node(-1), true;
    case Action::next_mode:
      return step_mode(1), true;
    case Action::previous_mode:
      return step_mode(-1), true;
    case Action::stronger:
    case Action::weaker: {
      const double step = action == Action::stronger ? kForceStep : 1 / kForceStep;
      choice_.impulse_ns = std::clamp(choice_.impulse_ns * step, 1e-5, 100.0);
      return true;
    }
    case Action::vibrate:
      choice_.vibrate = !choice_.vibrate;
      return true;
    default:
      return false;
  }
}

bool Commands::perform_material(Action action) {
  struct Step {
    Action up, down;
    double MaterialScale::*factor;
    double by;
  };
  static constexpr Step kSteps[] = {
      {Action::alpha_up, Action::alpha_down, &MaterialScale::alpha, kDampingStep},
      {Action::beta_up, Action::beta_down, &MaterialScale::beta, kDampingStep},
      {Action::density_up, Action::density_down, &MaterialScale::density, kSemitone},
      {Action::stiffness_up, Action::stiffness_down, &MaterialScale::stiffness, kSemitone},
  };
  for (const auto& [up, down, factor, by] : kSteps) {
    if (action != up && action != down) continue;
    scale_material(factor, action == up ? by : 1 / by);
    return true;
  }
  return false;
}

bool Commands::perform_modes(Action action) {
  const KnownObject* object = chosen();
  switch (action) {
    case Action::all_modes:
      return play_modes({}), true;
    case Action::highest_modes:
      if (object) {
        const int first = std::max(object->modes - static_cast<int>(kHighest), 0);
        play_modes({static_cast<std::uint32_t>(first), kHighest});
      }
      return true;
    case Action::more_modes:
      return step_mode_count(1), true;
    case Action::fewer_modes:
      return step_mode_count(-1), true;
    case Action::hear_mode:
      if (object) hear_alone(*object, choice_.mode);
      return true;
    case Action::test_tone:
      choice_.tone = !choice_.tone;
      return send_(protocol::TestTone{choice_.tone ? synth::kDefaultRingAmplitude : 0, 440}), true;
    case Action::project_test_force:
      return project_test_force(), true;
    case Action::clear_sound:
      edits_.forget_touches();
      return send_(protocol::ClearAll{}), true;
    default:
      return false;
  }
}

// New bodies play the chosen object and take their size from it; without a chosen object they are silent and have a
// default size.
bool Commands::perform_scene(Action action) {
  constexpr double kSilentSize_m = 0.06, kSilentDensity_kg_m3 = 2500;
  const KnownObject* object = chosen();
  const std::optional<ObjectRef> plays = object ? std::optional(ref(object->name)) : std::nullopt;
  const double size = plays ? 0 : kSilentSize_m, density = plays ? 0 : kSilentDensity_kg_m3;
  switch (action) {
    case Action::new_box:
      return send_(protocol::SpawnBox{plays, choice_.drop_m, {}, {size, size, size}, density}), true;
    case Action::new_sphere:
      return send_(protocol::SpawnSphere{plays, choice_.drop_m, {}, size / 2, density}), true;
    case Action::clear_scene:
      edits_.forget_bodies();
      return send_(protocol::SceneClear{}), true;
    case Action::pause:
      loader_.stop_waiting();
      return send_(protocol::ScenePause{!model_.scene().paused()}), true;
    case Action::restart:
      if (const auto& file = model_.scene().description().file) load_scene(*file);
      return true;
    default:
      return false;
  }
}

}  // namespace ringdown::viewer

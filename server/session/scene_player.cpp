#include "server/session/scene_player.h"

#include "engine/base/folders.h"
#include "engine/base/toml_table.h"
#include "engine/gltf/gltf_file.h"
#include "engine/modal/bank_file.h"
#include "engine/scene/gltf/scene.h"
#include "engine/scene/gltf/silent.h"
#include "engine/scene/scene_file.h"
#include "engine/scene/silence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::Frame;

scene::SoundingObject as_sounding(const ObjectState& object) {
  return {object.name, object.number, {object.map, &object.map->bank()}, object.map};
}

constexpr double kWarnEvery_s = 0.5;  // lost time between two warnings

tl::unexpected<Error> no_scene() { return fail(ErrorKind::refused, "there is no scene; load one first"); }

// Changes the world, and the scene as it would be saved.
Result<void> change_bodies(const ScenePlayer::Change& change, scene::World& world, KeptScene& kept) {
  const auto id = [](const auto& request) { return static_cast<scene::BodyId>(request.body); };
  return visit(Overloaded{
                   [&](const protocol::SceneRemove& request) {
                     return world.remove(id(request)).map([&] { kept.remove(id(request)); });
                   },
                   [&](const protocol::SceneRestore& request) {
                     return world.restore(id(request)).map([&] { kept.restore(id(request)); });
                   },
                   [&](const protocol::ScenePlace& request) {
                     return world.place(id(request), request.pose).map([&] { kept.place(id(request), request.pose); });
                   },
                   [&](const protocol::ScenePush& request) { return world.push(id(request), request.impulse_ns); },
               },
               change);
}

// Returns the events that put a scene's listener in place. A scene without a listener removes the listener if the
// previous scene has set it (`ends`), but not if somebody else has.
std::vector<Event> listener_events(const scene::SceneDescription& scene, bool ends, Frame frame) {
  if (!scene.listener)
    return ends ? std::vector<Event>{{.frame = frame, .verb = synth::verb::ListenerOff{}}} : std::vector<Event>{};
  const synth::verb::ListenerAir air{scene.listener->temperature_c, scene.listener->humidity_percent};
  const synth::verb::Listener listener{scene::listener_pose(*scene.listener)};
  return {{.frame = frame, .verb = air}, {.frame = frame, .verb = listener}};
}

// The delay with which the listener gets the bodies' poses: two poses. When the mixer starts towards a pose, the pose
// after that is then known, too, so motion does not depend on the size of blocks.
Frame pose_delay(const scene::World& world, double sample_rate_hz) {
  return std::llround(2 * ScenePoses::interval_s(world) * sample_rate_hz);
}

// Reads the files beside a glTF file.
modal::ReadBeside beside(const FileRoots& roots, const std::filesystem::path& path) {
  return [&roots, path](const std::string& relative, std::size_t limit) {
    return roots.read_beside(path, relative, limit);
  };
}

// Reads a scene, and warns of parts of the file that a scene cannot have.
Result<scene::SceneDescription> read_below(const FileRoots& roots, const std::filesystem::path& path,
                                           const std::optional<scene::FoleyLimits>& foley,
                                           const std::optional<std::string>& camera,
                                           const std::function<void(const std::string&)>& warn) {
  const bool is_gltf = scene::is_gltf(path);
  const auto text = roots.read(path, is_gltf ? modal::kMaxBankFileBytes : kMaxTomlFileBytes);
  if (!text) return fail(text);
  if (!is_gltf && camera)
    return fail(ErrorKind::bad_input, "{} has no cameras to listen by; its [listener] says where one is",
                path.string());
  if (!is_gltf) return scene::parse_scene(*text, path, preset_folder().value_or(std::filesystem::path()));
  auto read = scene::parse_gltf_scene(std::as_bytes(std::span(*text)), path, beside(roots, path), foley, camera);
  if (!read) return fail(read);
  for (const std::string& note : read->notes) warn("scene: " + note);
  return std::move(read->scene);
}

// Returns advice on how the bodies of a scene file get their sound.
std::string cure_of_silence(const FileRoots& roots, const std::filesystem::path& path) {
  if (!scene::is_gltf(path)) return "name an [[object]] with a bank in their [[body]]";
  const std::string bake = "`ringdown bake " + path.string() + "`";
  const auto text = roots.read(path, modal::kMaxBankFileBytes);
  if (!text) return bake;
  const auto glb = modal::parse_gltf(std::as_bytes(std::span(*text)), path.string(), beside(roots, path));
  const auto silent = glb ? scene::find_silent_bodies(*glb) : fail(glb);
  if (silent && !silent->bodies.empty()) return bake + " gives them banks";
  return "give them acoustic surfaces with a material (KHR_audio_rigid_bodies) in the file, and " + bake +
         " gives them banks";
}

// Warns of bodies that will not be heard.
void warn_of_silence(const scene::SceneDescription& scene, std::span<const scene::SoundingObject> objects,
                     const std::function<std::string()>& cure, const std::function<void(const std::string&)>& warn) {
  for (const std::string& sentence : scene::above_hearing(scene, objects)) warn("scene: " + sentence);
  if (!scene::why_silent(scene, objects, "")) return;
  warn("scene: " + *scene::why_silent(scene, objects, cure()));
}

}  // namespace

// Reads a scene of either format.
Result<std::size_t> ScenePlayer::load(const std::filesystem::path& path, Frame frame, bool paused) {
  const auto warn = [this](const std::string& sentence) { rack_.warn(sentence); };
  auto description = read_below(roots_, path, foley_, camera_, warn);
  if (!description) return fail(description);
  if (const auto kept = reliefs_.keep(*description); !kept) return fail(kept);
  std::vector<std::shared_ptr<const modal::StrikeMap>> banks;  // read before anything changes
  for (const auto& object : description->objects) {
    auto bank = banks_.read(object.bank);
    if (!bank) return fail(bank);
    banks.push_back(std::move(bank->map));
  }
  synth::Mixer& mixer = rack_.mixer();
  const auto pieces = pieces_.load_objects(*description, path, frame);
  if (!pieces) {
    pieces_.forget_loaded();
    return fail(pieces);
  }
  std::vector<scene::SoundingObject> objects;
  for (const ObjectSnapshot& object : rack_.objects()) {
    objects.push_back(as_sounding(*object));
    if (const auto sets = pieces->find(object->name); sets != pieces->end()) objects.back().pieces = sets->second;
  }
  auto world = scene::World::create(*description, objects, mixer.sample_rate_hz());
  if (!world) {
    pieces_.forget_loaded();
    return fail(path.string(), world);
  }
  warn_of_silence(
      *description, objects, [&] { return cure_of_silence(roots_, path); }, warn);

  for (const Event& event : listener_events(*description, sets_listener_, frame)) {
    if (!rack_.push(synth::Producer::worker, event)) {
      return fail(ErrorKind::refused, "too many changes of the listener at once; try again");
    }
  }
  sets_listener_ = description->listener.has_value();

  std::vector<scene::RestDamping> removed;
  {
    ++given_up_;
    const std::scoped_lock lock(mutex_);
    --given_up_;
    removed = end_contacts();
    world_ = std::move(*world);
    world_->set_sample_rate(mixer.sample_rate_hz());  // the rate may have changed since the world was made
    world_->set_start_frame(start_ = frame);
    playing_ = {.file = path, .paused = paused};
    kept_ = KeptScene(*description);
    ++version_;
    duration_s_ = description->duration_s;
    body_count_ = world_->bodies().size();
    poses_.forget();
    if (!sink_) dropped_ += poses_.send(*world_, kept_.description().listener, frame, rack_);
  }
  pieces_.keep_loaded();
  set_dampers(removed);
  return body_count_.load();
}

Result<void> ScenePlayer::pause(bool paused) {
  const std::scoped_lock lock(mutex_);
  if (!world_) return no_scene();
  playing_.paused = paused;
  return {};
}

Result<scene::BodyId> ScenePlayer::spawn(const std::optional<protocol::ObjectRef>& object,
                                         scene::BodyDescription body) {
  if (object) {
    const auto known = rack_.find(*object);
    if (!known) return fail(known);
    body.object = (*known)->name;
  }
  const std::scoped_lock lock(mutex_);
  if (!world_) return no_scene();
  const auto id = world_->spawn(body);
  if (id) {
    kept_.add(*id, std::move(body), world_->time_s());
    body_count_ = world_->bodies().size();
    ++version_;
  }
  return id;
}

Result<scene::BodyId> ScenePlayer::spawn(const protocol::SpawnBox& box) {
  return spawn(box.object, {.name = "box",
                            .shape = {scene::ShapeType::box, box.size_m, 0},
                            .density_kg_m3 = box.density_kg_m3,
                            .position_m = box.position_m,
                            .velocity_m_s = box.velocity_m_s});
}

Result<scene::BodyId> ScenePlayer::spawn(const protocol::SpawnSphere& sphere) {
  return spawn(sphere.object, {.name = "sphere",
                               .shape = {scene::ShapeType::sphere, {}, sphere.radius_m},
                               .density_kg_m3 = sphere.density_kg_m3,
                               .position_m = sphere.position_m,
                               .velocity_m_s = sphere.velocity_m_s});
}

Result<void> ScenePlayer::clear() {
  std::vector<scene::RestDamping> removed;
  {
    ++given_up_;
    const std::scoped_lock lock(mutex_);
    --given_up_;
    if (!world_) return no_scene();
    removed = end_contacts();
    playing_.cleared = true;
    kept_.clear();
    body_count_ = 0;
    ++version_;
  }
  pieces_.free();
  set_dampers(removed);
  return {};
}

// A scene without bodies is not stepped, so the contacts of the last body that is taken out are ended here.
Result<void> ScenePlayer::change(const Change& change) {
  std::vector<scene::RestDamping> dampings;
  {
    const std::scoped_lock lock(mutex_);
    if (!world_) return no_scene();
    if (const auto changed = change_bodies(change, *world_, kept_); !changed) return changed;
    const std::size_t left = world_->bodies().size();
    if (left != body_count_.exchange(left)) ++version_;
    if (left == 0) {
      do {
        pass_on(world_->step(), dampings);
      } while (world_->has_lasting_contacts());
    }
  }
  set_dampers(dampings);
  return {};
}

ScenePlayer::Poses ScenePlayer::poses() const {
  const std::scoped_lock lock(mutex_);
  if (!world_) return {.version = version_};
  return {version_, world_->time_s(), playing_.paused, world_->bodies()};
}

ScenePlayer::Description ScenePlayer::describe() const {
  const std::scoped_lock lock(mutex_);
  if (!world_) return {.version = version_};
  std::vector<scene::StaticOutline> statics;
  for (const auto& described : kept_.description().statics) statics.push_back(scene::outline_of(described));
  return {version_, duration_s_, kept_.description().camera, playing_.file, world_->describe(), std::move(statics)};
}

std::optional<scene::SceneDescription> ScenePlayer::description() const {
  const std::scoped_lock lock(mutex_);
  return world_ ? std::optional(kept_.description()) : std::nullopt;
}

std::optional<ScenePlayer::Playing> ScenePlayer::playing() const {
  const std::scoped_lock lock(mutex_);
  return world_ ? std::optional(playing_) : std::nullopt;
}

Result<void> ScenePlayer::object_changed(const ObjectState& object) {
  const std::scoped_lock lock(mutex_);
  if (!world_) return {};
  ++version_;
  return world_->set_object(as_sounding(object));
}

void ScenePlayer::object_freed(synth::ObjectNumber number) {
  pieces_.note_freed(number);
  const std::scoped_lock lock(mutex_);
  if (!world_) return;
  ++version_;
  world_->remove_object(number);
}

void ScenePlayer::advance_to(Frame frame, std::optional<Frame> slack) {
  while (step_towards(frame, slack)) continue;
}

bool ScenePlayer::step_towards(Frame frame, std::optional<Frame> slack) {
  std::vector<scene::RestDamping> dampings;
  bool more = false;
  {
    const std::scoped_lock lock(mutex_);
    if (!world_) return false;
    // All events before this frame have been passed on. It lies one step before the world's time, because a strike is
    // found in the step after the one in which it happens.
    const auto reported_until = [this] {
      return position() - std::llround(world_->step_s() * rack_.mixer().sample_rate_hz());
    };
    const bool matters = body_count_ > 0 && (watched_ || world_->sounds());
    if (playing_.paused || !(matters || world_->has_lasting_contacts())) {
      const Frame by = frame - reported_until();
      if (by > 0) world_->set_start_frame(start_ += by);
      return false;
    }
    if (slack) slow_down(frame - reported_until() - *slack);
    if (reported_until() < frame) {
      pass_on(world_->step(&given_up_), dampings);
      if (!sink_)
        dropped_ += poses_.send(*world_, kept_.description().listener,
                                position() + pose_delay(*world_, rack_.mixer().sample_rate_hz()), rack_);
    }
    more = reported_until() < frame;
  }
  set_dampers(dampings);
  return more;
}

// Removes all bodies and ends their lasting contacts, which would otherwise sound until they time out. Returns the
// dampings that remove the scene's dampers from every object.
std::vector<scene::RestDamping> ScenePlayer::end_contacts() {
  std::vector<scene::RestDamping> dampings;
  if (!world_) return dampings;
  world_->clear();
  while (world_->has_lasting_contacts()) pass_on(world_->step(), dampings);
  dampings.clear();
  scene::RestDamping without;
  for (std::uint32_t number = modal::kFirstSceneDamper; number < modal::kMaxDampers; ++number) {
    without.dampers[number] = {};
  }
  for (const synth::ObjectNumber object : std::exchange(damped_, {})) {
    without.object = object;
    dampings.push_back(without);
  }
  return dampings;
}

void ScenePlayer::change_sample_rate(double sample_rate_hz) {
  const std::scoped_lock lock(mutex_);
  const double ratio = sample_rate_hz / rack_.mixer().sample_rate_hz();
  const Frame now = rack_.mixer().counters().frames.load(std::memory_order_acquire);
  const Frame ahead = world_ ? std::llround(static_cast<double>(position() - now) * ratio) : 0;
  rack_.change_sample_rate(sample_rate_hz);
  if (!world_) return;
  world_->set_sample_rate(sample_rate_hz);
  world_->set_start_frame(start_ = now + ahead - std::llround(world_->time_s() * sample_rate_hz));
}

// The frame of the world's present time.
Frame ScenePlayer::position() const { return start_ + std::llround(world_->time_s() * rack_.mixer().sample_rate_hz()); }

// Moves the scene later by the time that the computer could not keep up, and warns now and then.
void ScenePlayer::slow_down(Frame by) {
  if (by <= 0) return;
  const double rate = rack_.mixer().sample_rate_hz();
  world_->set_start_frame(start_ += by);
  slowed_s_ = slowed_s_ + static_cast<double>(by) / rate;
  if (slowed_s_ < reported_slowed_s_ + kWarnEvery_s) return;
  reported_slowed_s_ = slowed_s_;
  rack_.warn(formatted(
      "scene: this computer cannot keep up with it, and it has lost {:.1f} s; fewer bodies or a longer step_s help",
      reported_slowed_s_));
}

// Sets or removes the dampers of the scene's bodies on objects. Called without the mutex, because the worker, which
// carries out the changes, may be waiting for the mutex.
void ScenePlayer::set_dampers(const std::vector<scene::RestDamping>& dampings) {
  for (const scene::RestDamping& damping : dampings) {
    const auto set = [this, damping] {
      const auto done = rack_.set_dampers({.number = damping.object}, damping.dampers, damping.frame);
      if (!done) ++dropped_;
    };
    if (!post_) {
      set();
    } else if (!post_(set)) {
      ++dropped_;
    }
  }
}

void ScenePlayer::pass_on(const scene::StepReport& report, std::vector<scene::RestDamping>& dampings) {
  dropped_ += report.dropped_events;
  if (watch_) watch_(report.contacts);
  if (sink_) {
    dropped_ += sink_(report);
  } else {
    for (const Event& event : report.events) dropped_ += !rack_.push(synth::Producer::scene, event);
    for (const scene::RestDamping& damping : report.rest_dampings) {
      damped_.insert(damping.object);
      dampings.push_back(damping);
    }
  }
  pieces_.note_broken(report.broken);
  for (const std::string& notice : report.notices) rack_.warn("scene: " + notice);
  if (report.notices.empty()) return;
  const std::size_t left = world_->bodies().size();
  if (left != body_count_.exchange(left)) ++version_;
}

}  // namespace ringdown::session

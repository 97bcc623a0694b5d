#include "server/session/scene_player.h"

#include "engine/base/folders.h"
#include "engine/base/toml_table.h"
#include "engine/scene/scene_file.h"

#include <cmath>
#include <cstdio>
#include <utility>

namespace ringdown::session {
namespace {

using synth::Event;
using synth::EventType;
using synth::Frame;

scene::SoundingObject as_sounding(const ObjectState& object) {
  return {object.name, object.number, {object.map, &object.map->bank()}};
}

constexpr double kComplainEvery_s = 0.5;  // that is lost

tl::unexpected<Error> no_scene() { return fail(ErrorKind::refused, "there is no scene; load one with /scene/load"); }

}  // namespace

Result<std::size_t> ScenePlayer::load(const std::filesystem::path& path, Frame frame) {
  const auto text = roots_.read(path, kMaxTomlFileBytes);
  if (!text) return fail(text.error());
  const auto description = scene::parse_scene(*text, path, preset_folder().value_or(std::filesystem::path()));
  if (!description) return fail(description.error());
  std::vector<std::shared_ptr<const modal::StrikeMap>> banks;  // all read before anything changes
  for (const auto& object : description->objects) {
    auto bank = banks_.read(object.bank);
    if (!bank) return fail(bank.error());
    banks.push_back(std::move(bank->map));
  }
  synth::Mixer& mixer = rack_.mixer();
  for (const auto& object : description->objects) {
    const auto number = rack_.load(object.name, object.bank);
    if (!number) return fail(number.error());
    if (!object.group.empty()) {
      if (const auto set = rack_.set_group({.name = object.name}, object.group); !set) return fail(set.error());
    }
    if (object.material != modal::MaterialScale{}) {
      if (const auto set = rack_.set_material({.name = object.name}, object.material); !set) return fail(set.error());
    }
    const bool sent = rack_.push(synth::Producer::worker,
                                 {.frame = frame, .object = *number, .type = EventType::gain, .value = object.gain}) &&
                      rack_.push(synth::Producer::worker,
                                 {.frame = frame, .object = *number, .type = EventType::pan, .value = object.pan});
    if (!sent)
      return fail(ErrorKind::refused,
                  path.string() + ": too many objects at once; wait for those before to be taken up");
  }
  std::vector<scene::SoundingObject> objects;
  for (const ObjectSnapshot& object : rack_.objects()) objects.push_back(as_sounding(*object));
  auto world = scene::World::create(*description, objects, mixer.sample_rate_hz());
  if (!world) return fail(world.error().kind, path.string() + ": " + world.error().message);

  std::vector<scene::RestDamping> lifted;
  {
    const std::scoped_lock lock(mutex_);
    lifted = end_contacts();
    world_ = std::move(*world);
    world_->set_sample_rate(mixer.sample_rate_hz());  // it may have changed since
    world_->set_start_frame(start_ = frame);
    playing_ = {.file = path};
    camera_ = description->camera;
    statics_.clear();
    for (const scene::StaticDescription& still : description->statics) statics_.push_back(scene::outline_of(still));
    ++version_;
    duration_s_ = description->duration_s;
    body_count_ = world_->bodies().size();
  }
  lean(lifted);
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
    if (!known) return fail(known.error());
    body.object = (*known)->name;
  }
  const std::scoped_lock lock(mutex_);
  if (!world_) return no_scene();
  const auto id = world_->spawn(std::move(body));
  if (id) {
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
  std::vector<scene::RestDamping> lifted;
  {
    const std::scoped_lock lock(mutex_);
    if (!world_) return no_scene();
    lifted = end_contacts();
    playing_.cleared = true;
    body_count_ = 0;
    ++version_;
  }
  lean(lifted);
  return {};
}

Result<void> ScenePlayer::push(scene::BodyId body, Vec3 impulse_ns) {
  const std::scoped_lock lock(mutex_);
  return world_ ? world_->push(body, impulse_ns) : no_scene();
}

ScenePlayer::Poses ScenePlayer::poses() const {
  const std::scoped_lock lock(mutex_);
  if (!world_) return {.version = version_};
  return {version_, world_->time_s(), playing_.paused, world_->bodies()};
}

ScenePlayer::Description ScenePlayer::describe() const {
  const std::scoped_lock lock(mutex_);
  if (!world_) return {.version = version_};
  return {version_, duration_s_, camera_, playing_.file, world_->describe(), statics_};
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
  const std::scoped_lock lock(mutex_);
  if (!world_) return;
  ++version_;
  world_->remove_object(number);
}

void ScenePlayer::advance_to(Frame frame, std::optional<Frame> slack) {
  std::vector<scene::RestDamping> dampings;
  {
    const std::scoped_lock lock(mutex_);
    if (!world_) return;
    if (playing_.paused || !matters()) return move_start(frame - told_until());
    if (slack) slow_down(frame - told_until() - *slack);
    while (told_until() < frame && matters()) take(world_->step(), dampings);
  }
  lean(dampings);
}

bool ScenePlayer::matters() const {
  return world_->has_lasting_contacts() || (body_count_ > 0 && (watched_ || world_->sounds()));
}

// No body, no contact: what is being told of would otherwise sound on until it times out, and what rests would damp on.
std::vector<scene::RestDamping> ScenePlayer::end_contacts() {
  std::vector<scene::RestDamping> dampings;
  if (!world_) return dampings;
  world_->clear();
  while (world_->has_lasting_contacts()) take(world_->step(), dampings);
  dampings.clear();
  scene::RestDamping nothing;
  for (std::uint32_t number = modal::kFirstSceneDamper; number < modal::kMaxDampers; ++number) {
    nothing.dampers[number] = {};
  }
  for (const synth::ObjectNumber object : std::exchange(leaned_on_, {})) {
    nothing.object = object;
    dampings.push_back(nothing);
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

// A strike is found in the step after the one in which it happens.
Frame ScenePlayer::told_until() const {
  return position() - std::llround(world_->step_s() * rack_.mixer().sample_rate_hz());
}

// It could not keep up: what it missed it does not make up for.
void ScenePlayer::slow_down(Frame by) {
  if (by <= 0) return;
  const double rate = rack_.mixer().sample_rate_hz();
  move_start(by);
  slowed_s_ = slowed_s_ + static_cast<double>(by) / rate;
  if (slowed_s_ < complained_s_ + kComplainEvery_s) return;
  complained_s_ = slowed_s_;
  char lost[32];
  std::snprintf(lost, sizeof lost, "%.1f", complained_s_);
  rack_.warn("scene: this computer cannot keep up with it, and it has lost " + std::string(lost) +
             " s; fewer bodies or a longer step_s help");
}

void ScenePlayer::move_start(Frame later) {
  if (later > 0) world_->set_start_frame(start_ += later);
}

// What the scene lays on objects, or takes away. Without the lock: a worker that waits for it could not do this either.
void ScenePlayer::lean(const std::vector<scene::RestDamping>& dampings) {
  for (const scene::RestDamping& damping : dampings) {
    const auto hold = [this, damping] {
      if (const auto held = rack_.set_dampers({.number = damping.object}, damping.dampers, damping.frame); !held)
        ++dropped_;
    };
    if (!post_) {
      hold();
    } else if (!post_(hold)) {
      ++dropped_;
    }
  }
}

void ScenePlayer::take(const scene::StepReport& report, std::vector<scene::RestDamping>& dampings) {
  dropped_ += report.dropped_events;
  if (sink_) {
    dropped_ += sink_(report);
  } else {
    for (const Event& event : report.events) dropped_ += !rack_.push(synth::Producer::scene, event);
    for (const scene::RestDamping& damping : report.rest_dampings) {
      leaned_on_.insert(damping.object);
      dampings.push_back(damping);
    }
  }
  for (const std::string& notice : report.notices) rack_.warn("scene: " + notice);
  if (report.notices.empty()) return;
  const std::size_t left = world_->bodies().size();
  if (left != body_count_.exchange(left)) ++version_;
}

}  // namespace ringdown::session

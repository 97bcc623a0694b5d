#include "clients/viewer/edits.h"

#include "engine/base/formatted.h"

#include <algorithm>

namespace ringdown::viewer {
namespace {

using protocol::Request;

constexpr double kConfirmedWithin_s = 1;
constexpr double kShownWithin_s = 0.3;  // the window shows a scene a few notices late

// Applies a request to `adjustment`. Returns the name of the object, or nothing when the request sets nothing there.
std::optional<std::string> apply(const Request& request, Adjustment& adjustment) {
  if (const auto* material = request.get_if<protocol::SetMaterial>()) {
    adjustment.scale = material->scale;
    return material->object.name;
  }
  if (const auto* gain = request.get_if<protocol::SetGain>()) {
    adjustment.gain = gain->verb.gain;
    return gain->object.name;
  }
  if (const auto* pan = request.get_if<protocol::SetPan>()) {
    adjustment.pan = pan->verb.pan;
    return pan->object.name;
  }
  if (const auto* fill = request.get_if<protocol::SetFill>()) {
    adjustment.level_m = fill->level_m;
    return fill->object.name;
  }
  if (const auto* modes = request.get_if<protocol::SelectModes>()) {
    adjustment.range = modes->range;
    return modes->object.name;
  }
  return std::nullopt;
}

// The request that sets what `request` sets as it is in `adjustment`.
Request reverted(Request request, const Adjustment& adjustment) {
  if (auto* material = request.get_if<protocol::SetMaterial>()) material->scale = adjustment.scale;
  if (auto* gain = request.get_if<protocol::SetGain>()) gain->verb.gain = adjustment.gain;
  if (auto* pan = request.get_if<protocol::SetPan>()) pan->verb.pan = adjustment.pan;
  if (auto* fill = request.get_if<protocol::SetFill>()) fill->level_m = adjustment.level_m;
  if (auto* modes = request.get_if<protocol::SelectModes>()) modes->range = adjustment.range;
  return request;
}

}  // namespace

void History::note(const std::string& what, Request before, Request after, double now_s) {
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(done_), entries_.end());
  if (!entries_.empty() && entries_.back().what == what && now_s - entries_.back().when_s < kOneGesture_s) {
    entries_.back().after = std::move(after);
    entries_.back().when_s = now_s;
    return;
  }
  if (entries_.size() == kMaxUndone) entries_.erase(entries_.begin());
  entries_.push_back({what, std::move(before), std::move(after), now_s});
  done_ = entries_.size();
}

std::optional<Request> History::undo() {
  if (done_ == 0) return std::nullopt;
  entries_[--done_].when_s = -kOneGesture_s;
  return entries_[done_].before;
}

std::optional<Request> History::redo() {
  if (done_ == entries_.size()) return std::nullopt;
  return entries_[done_++].after;
}

void History::forget_bodies() {
  const auto is_body = [](const Entry& entry) {
    return entry.before.get_if<protocol::SceneRemove>() || entry.before.get_if<protocol::SceneRestore>() ||
           entry.before.get_if<protocol::ScenePlace>();
  };
  const auto end_of_done = entries_.begin() + static_cast<std::ptrdiff_t>(done_);
  done_ -= static_cast<std::size_t>(std::count_if(entries_.begin(), end_of_done, is_body));
  std::erase_if(entries_, is_body);
}

void Edits::update(double now_s) {
  now_s_ = now_s;
  std::erase_if(pending_, [&](const auto& entry) { return now_s - entry.second.sent_at_s > kConfirmedWithin_s; });
  std::erase_if(placed_, [&](const auto& entry) { return now_s - entry.second.sent_at_s > kShownWithin_s; });
  touches_.keep([this](const std::string& object) { return model_.object(object) != nullptr; });
  note_new_bodies();
}

void Edits::restart() {
  history_.clear();
  pending_.clear();
  placed_.clear();
  listener_.reset();
  touches_.clear();
  messages_seen_ = 0;
}

void Edits::remove_body(std::int32_t body) {
  const auto found = model_.scene().bodies().find(body);
  const std::string name = found == model_.scene().bodies().end() ? "" : found->second.name;
  send_(protocol::SceneRemove{body});
  history_.note(formatted("remove body {} {}", body, name), protocol::SceneRestore{body}, protocol::SceneRemove{body},
                now_s_);
}

void Edits::forget_bodies() {
  history_.forget_bodies();
  placed_.clear();
}

std::optional<ringdown::Pose> Edits::pose_of(std::int32_t body) const {
  if (const auto placed = placed_.find(body); placed != placed_.end()) return placed->second.pose;
  const auto known = model_.scene().bodies().find(body);
  if (known == model_.scene().bodies().end() || !model_.scene().present(known->second)) return std::nullopt;
  const auto last_s = known->second.track.last_time_s();
  const auto pose = last_s ? known->second.track.pose_at(*last_s) : std::nullopt;
  if (!pose) return std::nullopt;
  const Quaternion& q = pose->rotation;
  return ringdown::Pose{pose->position_m, Rotation::from_xyzw(q.x, q.y, q.z, q.w)};
}

void Edits::place_body(std::int32_t body, const ringdown::Pose& pose) {
  const auto before = pose_of(body);
  if (!before) return;
  const auto known = model_.scene().bodies().find(body);
  const std::string name = known == model_.scene().bodies().end() ? "" : known->second.name;
  history_.note(formatted("place body {} {}", body, name), protocol::ScenePlace{body, *before},
                protocol::ScenePlace{body, pose}, now_s_);
  send(protocol::ScenePlace{body, pose});
}

void Edits::set_listener(const std::optional<ringdown::Pose>& pose) {
  const auto request = [](const std::optional<ringdown::Pose>& one) {
    return one ? Request(protocol::SetListener{{*one}}) : Request(protocol::ListenerOff{});
  };
  history_.note("listener", request(listener_), request(pose), now_s_);
  send(request(pose));
}

void Edits::touch(const Request& bow_or_coupling) {
  std::string what;
  if (const auto* bow = bow_or_coupling.get_if<protocol::SetBow>()) what = bow->object.name + ": bow";
  if (const auto* coupling = bow_or_coupling.get_if<protocol::SetCoupling>())
    what = formatted("coupling {} of {} and {}", coupling->verb.number, coupling->object.name, coupling->other.name);
  history_.note(what, touches_.reverting(bow_or_coupling), bow_or_coupling, now_s_);
  send(bow_or_coupling);
}

// The daemon's answers name the bodies that were dropped.
void Edits::note_new_bodies() {
  for (const KnownMessage& message : model_.messages()) {
    if (message.order < messages_seen_ || message.failed || !message.number) continue;
    if (!message.address.starts_with("/scene/spawn/")) continue;
    const std::int32_t body = *message.number;
    history_.note(formatted("new body {}", body), protocol::SceneRemove{body}, protocol::SceneRestore{body}, now_s_);
  }
  messages_seen_ = model_.message_count();
}

Adjustment Edits::adjustment_of(const KnownObject& object) const {
  const auto pending = pending_.find(object.name);
  if (pending != pending_.end()) return pending->second.adjustment;
  const bool all = object.selected.first == 0 && object.selected.count >= static_cast<std::uint32_t>(object.modes);
  return {object.scale, object.gain, object.pan, all ? modal::ModeRange{} : object.selected, object.level_m};
}

void Edits::change(const KnownObject& object, const Request& request, const std::string& what) {
  history_.note(object.name + ": " + what, reverted(request, adjustment_of(object)), request, now_s_);
  send(request);
}

void Edits::send(const Request& request) {
  Adjustment requested;
  const auto name = apply(request, requested);
  const KnownObject* object = name ? model_.object(*name) : nullptr;
  if (object) {
    Adjustment adjustment = adjustment_of(*object);
    apply(request, adjustment);
    pending_.insert_or_assign(*name, Pending{adjustment, now_s_});
  }
  if (const auto* place = request.get_if<protocol::ScenePlace>()) {
    placed_.insert_or_assign(place->body, Placed{place->pose, now_s_});
  }
  if (const auto* listener = request.get_if<protocol::SetListener>()) listener_ = listener->verb.pose;
  if (request.get_if<protocol::ListenerOff>()) listener_.reset();
  touches_.follow(request);
  send_(request);
  if (name && !name->empty()) send_(protocol::DescribeObject{{*name, std::nullopt}});
}

void Edits::send_if_any(const std::optional<Request>& request) {
  if (request) send(*request);
}

}  // namespace ringdown::viewer

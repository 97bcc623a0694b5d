#include "clients/viewer/link/known_objects.h"

#include "protocol/wire/message.h"

#include <algorithm>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr std::size_t kMaxDescriptions = 16;  // asked for in one frame
constexpr double kTurn_s = 2;

}  // namespace

const KnownObject* KnownObjects::find(const std::string& name) const {
  const auto found = objects_.find(name);
  return found == objects_.end() ? nullptr : &found->second;
}

KnownObject* KnownObjects::find_or_ask(const std::string& name) {
  const auto found = objects_.find(name);
  if (found != objects_.end()) return &found->second;
  if (undescribed_.size() < kMaxKnownObjects) undescribed_.try_emplace(name);
  return nullptr;
}

void KnownObjects::forget(const std::string& name) {
  undescribed_.erase(name);
  objects_.erase(name);
}

void KnownObjects::on(const protocol::ObjectReply& reply) {
  undescribed_.erase(reply.name);
  if (!objects_.contains(reply.name) && objects_.size() == kMaxKnownObjects) return;
  KnownObject& object = objects_[reply.name];
  if (object.version != reply.version || object.bank_content != reply.bank_content || object.bank_path != reply.bank) {
    object = {};
  }
  object.name = reply.name;
  object.number = reply.number;
  object.version = reply.version;
  object.bank_bytes = reply.bank_bytes;
  object.bank_content = reply.bank_content;
  object.bank_path = reply.bank;
  object.modes = reply.modes;
  object.selected = {static_cast<std::uint32_t>(std::max(0, reply.first_mode)),
                     static_cast<std::uint32_t>(std::max(0, reply.selected_modes))};
  object.scale = reply.scale;
  object.gain = reply.gain;
  object.pan = reply.pan;
  object.mute = reply.mute;
  object.solo = reply.solo;
  object.level_m = reply.level_m;
  object.group = reply.group;
}

void KnownObjects::on(const protocol::NotifyObject& notice) {
  if (undescribed_.size() < kMaxKnownObjects) undescribed_[notice.name] = {};
}

void KnownObjects::on(const protocol::NotifyGroup& notice) {
  if (KnownObject* object = find_or_ask(notice.name)) object->group = notice.group;
}

void KnownObjects::on(const protocol::NotifyObjectPeak& notice, double now_s) {
  KnownObject* object = find_or_ask(notice.object);
  if (!object) return;
  object->peak = notice.peak;
  object->peak_at_s = now_s;
}

void KnownObjects::on(const protocol::NotifyModes& notice, double now_s) {
  KnownObject* object = find_or_ask(notice.object);
  if (!object || notice.first < 0) return;
  const auto modes = std::min(static_cast<std::size_t>(std::max(0, object->modes)), kMaxModes);
  const std::vector<float> amplitudes = wire::decode_floats(notice.amplitudes);
  if (static_cast<std::size_t>(notice.first) + amplitudes.size() > modes) return;
  object->amplitudes.resize(modes);
  std::ranges::copy(amplitudes, object->amplitudes.begin() + notice.first);
  object->amplitudes_at_s = now_s;
}

void KnownObjects::add_requests(double now_s, std::optional<std::int32_t> object_count, Requests& requests) {
  std::size_t room = kMaxDescriptions;
  for (auto& [name, question] : undescribed_) {
    if (room == 0) break;
    --room;
    if (question.due(now_s)) requests.emplace_back(protocol::DescribeObject{object_named(name)});
  }
  // The notice of an object was lost: a pattern asks for all descriptions.
  if (object_count && undescribed_.empty() && std::cmp_greater(*object_count, objects_.size()) &&
      everything_.due(now_s, kTurn_s)) {
    requests.emplace_back(protocol::DescribeObject{object_named("*")});
  }
  if (objects_.empty() || !next_in_turn_.due(now_s, kTurn_s)) return;
  auto next = objects_.upper_bound(last_in_turn_);
  if (next == objects_.end()) next = objects_.begin();
  last_in_turn_ = next->first;
  requests.emplace_back(protocol::DescribeObject{object_named(last_in_turn_)});
}

}  // namespace ringdown::viewer

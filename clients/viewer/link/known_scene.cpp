#include "clients/viewer/link/known_scene.h"

#include <algorithm>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kGone_s = 0.5;  // of scene time without being told

std::string sounding(const std::string& object) { return object == "-" ? "" : object; }

std::size_t at_most(std::int32_t count, std::size_t most) {
  return std::min(static_cast<std::size_t>(std::max(count, 0)), most);
}

}  // namespace

KnownScene::Parts* KnownScene::parts_of(std::int32_t version) {
  if (version < parts_version_ || described_version_ == version) return nullptr;
  if (version > parts_version_) parts_ = {};
  parts_version_ = version;
  return &parts_;
}

void KnownScene::on(const protocol::SceneReply& reply) {
  Parts* parts = parts_of(reply.version);
  if (!parts) return;
  parts->head = reply;
  finish();
}

void KnownScene::on(const protocol::SceneBody& reply) {
  Parts* parts = parts_of(reply.version);
  if (!parts || parts->bodies.size() == kMaxBodies) return;
  parts->bodies.insert_or_assign(reply.id, reply);
  finish();
}

void KnownScene::on(const protocol::SceneStatic& reply) {
  Parts* parts = parts_of(reply.version);
  if (!parts || parts->statics.size() == kMaxStatics) return;
  parts->statics.insert_or_assign(reply.number, reply);
  finish();
}

void KnownScene::finish() {
  if (!parts_.head || parts_.bodies.size() < at_most(parts_.head->bodies, kMaxBodies) ||
      parts_.statics.size() < at_most(parts_.head->statics, kMaxStatics)) {
    return;
  }
  std::erase_if(bodies_,
                [&](const auto& known) { return !known.second.shape.empty() && !parts_.bodies.contains(known.first); });
  for (auto& [id, told] : parts_.bodies) {
    if (!bodies_.contains(id) && bodies_.size() == kMaxBodies) continue;
    KnownBody& body = bodies_[id];
    body = {id,          told.name,  sounding(told.object), told.shape,
            told.size_m, told.fixed, std::move(body.track), body.told_in_notice};
  }
  statics_.clear();
  for (auto& [number, told] : parts_.statics) statics_.push_back(std::move(told));
  description_ = *parts_.head;
  described_version_ = parts_version_;
  parts_ = {};
}

void KnownScene::on(const protocol::NotifyScene& reply, double now_s) {
  late_ = told_version_ && reply.version < *told_version_;
  if (late_) return;
  const bool begins_anew = told_version_ && reply.version > *told_version_ && reply.time_s < time_s_;
  if (begins_anew) clock_.restart();
  const DisplayClock::Course course = clock_.observe(now_s, reply.time_s, reply.paused);
  late_ = course == DisplayClock::Course::late;
  if (late_) return;
  if (begins_anew || course == DisplayClock::Course::anew) {
    for (auto& [id, body] : bodies_) body.track.restart();
  }
  told_version_ = reply.version;
  ++notice_;
  time_s_ = reply.time_s;
  paused_ = reply.paused;
  std::erase_if(bodies_, [&](const auto& known) { return known.second.shape.empty() && !present(known.second); });
}

void KnownScene::on(const protocol::NotifyBody& reply) {
  if (late_ || !told_version_) return;
  if (!bodies_.contains(reply.id) && bodies_.size() == kMaxBodies) return;
  KnownBody& body = bodies_[reply.id];
  if (body.shape.empty()) {
    body.id = reply.id;
    body.name = reply.name;
    body.object = sounding(reply.object);
  }
  // Told twice in one notice: it belongs to the next one, whose /notify.scene was lost, and its time is unknown.
  if (!paused_ && body.told_in_notice == notice_) return;
  body.told_in_notice = notice_;
  body.track.tell(time_s_, {reply.position_m, {reply.x, reply.y, reply.z, reply.w}});
}

bool KnownScene::present(const KnownBody& body) const {
  const std::optional<double> told_s = body.track.last_told_s();
  return told_s && *told_s >= time_s_ - kGone_s;
}

std::optional<protocol::Request> KnownScene::wants(double now_s) {
  if (!told_version_ || (described_version_ && *described_version_ >= *told_version_)) return std::nullopt;
  if (asked_at_s_ && now_s - *asked_at_s_ <= kPatience_s) return std::nullopt;
  asked_at_s_ = now_s;
  return protocol::SceneDescribe{};
}

}  // namespace ringdown::viewer

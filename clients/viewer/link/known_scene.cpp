#include "clients/viewer/link/known_scene.h"

#include <algorithm>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kGone_s = 0.5;  // a body that no notice has named for so much scene time has left

std::string object_or_none(const std::string& object) { return object == "-" ? "" : object; }

std::size_t capped(std::int32_t count, std::size_t max) {
  return std::min(static_cast<std::size_t>(std::max(count, 0)), max);
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
  if (!parts_.head || parts_.bodies.size() < capped(parts_.head->bodies, kMaxBodies) ||
      parts_.statics.size() < capped(parts_.head->statics, kMaxStatics)) {
    return;
  }
  std::erase_if(bodies_,
                [&](const auto& known) { return !known.second.shape.empty() && !parts_.bodies.contains(known.first); });
  for (auto& [id, described] : parts_.bodies) {
    if (!bodies_.contains(id) && bodies_.size() == kMaxBodies) continue;
    KnownBody& body = bodies_[id];
    body = {id,
            described.name,
            object_or_none(described.object),
            described.shape,
            described.size_m,
            described.fixed,
            std::move(body.track),
            body.last_notice};
  }
  statics_.clear();
  for (auto& [number, described] : parts_.statics) statics_.push_back(std::move(described));
  description_ = *parts_.head;
  described_version_ = parts_version_;
  parts_ = {};
}

void KnownScene::on(const protocol::NotifyScene& reply, double now_s) {
  late_ = noticed_version_ && reply.version < *noticed_version_;
  if (late_) return;
  const bool restarts = noticed_version_ && reply.version > *noticed_version_ && reply.time_s < time_s_;
  if (restarts) clock_.restart();
  const DisplayClock::Course course = clock_.observe(now_s, reply.time_s, reply.paused);
  late_ = course == DisplayClock::Course::late;
  if (late_) return;
  if (restarts || course == DisplayClock::Course::jumped) {
    for (auto& [id, body] : bodies_) body.track.restart();
  }
  noticed_version_ = reply.version;
  ++notice_;
  time_s_ = reply.time_s;
  paused_ = reply.paused;
  std::erase_if(bodies_, [&](const auto& known) { return known.second.shape.empty() && !present(known.second); });
}

void KnownScene::on(const protocol::NotifyBody& reply) {
  if (late_ || !noticed_version_) return;
  if (!bodies_.contains(reply.id) && bodies_.size() == kMaxBodies) return;
  KnownBody& body = bodies_[reply.id];
  if (body.shape.empty()) {
    body.id = reply.id;
    body.name = reply.name;
    body.object = object_or_none(reply.object);
  }
  // A second pose within one notice belongs to the next notice, whose /notify.scene was lost: its time is unknown.
  if (!paused_ && body.last_notice == notice_) return;
  body.last_notice = notice_;
  body.track.add(time_s_, {reply.position_m, {reply.x, reply.y, reply.z, reply.w}});
}

bool KnownScene::present(const KnownBody& body) const {
  const std::optional<double> last_s = body.track.last_time_s();
  return last_s && *last_s >= time_s_ - kGone_s;
}

std::optional<protocol::Request> KnownScene::wants(double now_s) {
  if (!noticed_version_ || (described_version_ && *described_version_ >= *noticed_version_)) return std::nullopt;
  if (!question_.due(now_s)) return std::nullopt;
  return protocol::SceneDescribe{};
}

}  // namespace ringdown::viewer

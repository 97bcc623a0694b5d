// The scene as the window knows it: bodies with their poses, and statics.
//
// The description (/scene/describe) comes in parts that carry a common version. A description is requested when notices
// name a newer version, and again while parts of it are missing. Poses come with every notice. [one thread: the
// window's]
#pragma once

#include "clients/viewer/link/pose_track.h"
#include "clients/viewer/link/question.h"
#include "protocol/reply.h"
#include "protocol/request.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::viewer {

struct KnownBody {
  std::int32_t id = 0;
  std::string name;
  std::string object;  // the object that sounds when the body is hit; empty: silent
  std::string shape;   // "box", "sphere", "convex", "trimesh"; empty: not described yet
  Vec3 size_m;         // edges of the shape's bounding box
  bool fixed = false;
  PoseHistory track;              // empty: the body is not in the scene yet
  std::uint64_t last_notice = 0;  // number of the notice with the last pose
};

class KnownScene {
 public:
  static constexpr std::size_t kMaxBodies = 1024, kMaxStatics = 1024;

  explicit KnownScene(double notice_period_s) : clock_(notice_period_s) {}

  void on(const protocol::SceneReply& reply);
  void on(const protocol::SceneBody& reply);
  void on(const protocol::SceneStatic& reply);
  void on(const protocol::NotifyScene& reply, double now_s);
  void on(const protocol::NotifyBody& reply);  // belongs to the last NotifyScene

  // Returns /scene/describe when it is due.
  [[nodiscard]] std::optional<protocol::Request> wants(double now_s);

  // Returns the last complete description. A description without a file means that there is no scene.
  [[nodiscard]] const protocol::SceneReply& description() const { return description_; }
  [[nodiscard]] bool described() const { return described_version_.has_value(); }
  // Return the newest version that the daemon has announced, and whether that version is the one described.
  [[nodiscard]] std::optional<std::int32_t> version() const { return noticed_version_; }
  [[nodiscard]] bool up_to_date() const { return described() && described_version_ == noticed_version_; }
  [[nodiscard]] const std::map<std::int32_t, KnownBody>& bodies() const { return bodies_; }
  [[nodiscard]] const std::vector<protocol::SceneStatic>& statics() const { return statics_; }
  [[nodiscard]] double reported_time_s() const { return time_s_; }
  [[nodiscard]] bool paused() const { return paused_; }

  // Returns whether notices still name the body. If not, it has left the scene, or has not entered yet.
  [[nodiscard]] bool present(const KnownBody& body) const;

  // Returns the scene time to show now, for bodies().at(id).track.pose_at(*time). Advances the display clock to
  // `now_s`.
  std::optional<double> shown_time_at(double now_s) { return clock_.time_at(now_s); }

 private:
  // A description that is still arriving.
  struct Parts {
    std::optional<protocol::SceneReply> head;
    std::map<std::int32_t, protocol::SceneBody> bodies;
    std::map<std::int32_t, protocol::SceneStatic> statics;
  };
  Parts* parts_of(std::int32_t version);
  void finish();

  protocol::SceneReply description_;
  std::optional<std::int32_t> noticed_version_, described_version_;
  std::int32_t parts_version_ = 0;
  Parts parts_;
  Question question_;
  std::map<std::int32_t, KnownBody> bodies_;
  std::vector<protocol::SceneStatic> statics_;
  DisplayClock clock_;
  std::uint64_t notice_ = 0;  // number of the last notice
  double time_s_ = 0;
  bool paused_ = false, late_ = false;
};

}  // namespace ringdown::viewer

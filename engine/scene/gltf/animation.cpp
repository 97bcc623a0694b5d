#include "engine/scene/gltf/animation.h"

#include "engine/base/formatted.h"
#include "engine/base/quote.h"
#include "engine/scene/description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace ringdown::scene {

using modal::JsonPlace;

GltfAnimations::GltfAnimations(GltfDocument& document, const std::optional<FoleyLimits>& foley)
    : document_(document), once_(foley.has_value()) {
  const JsonPlace animations = document.root()["animations"];
  for (std::size_t k = 0; k < animations.size(); ++k) add(animations[k]);
  if (!channels_.empty() && !(length_s_ > 0))
    document_.notes.add("the animations have keys at one moment only, so that nothing moves");
  if (foley) every_s_ = foley->frames_per_s > 0 ? 1 / foley->frames_per_s : frame_s();
}

// The smallest distance of two keys of a channel, if it may be that of two frames: programs write a key in every frame.
// The mean over the channel removes the rounding of its times. Keys that are farther apart were set by hand.
double GltfAnimations::frame_s() const {
  constexpr double kShortest_s = 1.0 / 240, kLongest_s = 1.0 / 11, kByHand_s = 1.0 / 60;
  double shortest_s = 1e300, span_s = 0;
  for (const auto& [node, channels] : channels_) {
    for (const Channel& channel : channels) {
      if (channel.target == Target::scale) continue;  // two keys that hide a body until it starts lie anywhere
      for (std::size_t k = 0; k + 1 < channel.times_s.size(); ++k) {
        const double apart_s = static_cast<double>(channel.times_s[k + 1]) - static_cast<double>(channel.times_s[k]);
        if (apart_s < 0.99 * shortest_s) {
          shortest_s = apart_s;
          span_s = 0;
        }
      }
      const double whole_s = static_cast<double>(channel.times_s.back()) - static_cast<double>(channel.times_s.front());
      span_s = std::max(span_s, whole_s);
    }
  }
  if (!(shortest_s <= kLongest_s)) return kByHand_s;
  if (shortest_s < kShortest_s) return kShortest_s;
  return span_s > 0 ? span_s / std::max(1.0, std::round(span_s / shortest_s)) : shortest_s;
}

void GltfAnimations::add(const JsonPlace& animation) {
  constexpr std::array kTargets = {"translation", "rotation", "scale"};
  constexpr std::array kWays = {"LINEAR", "STEP", "CUBICSPLINE"};
  const JsonPlace channels = animation["channels"], samplers = animation["samplers"];
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const JsonPlace target = channels[k]["target"];
    const auto path = std::ranges::find(kTargets, target["path"].text_or(""));
    if (!target["node"].present()) continue;  // of an extension
    const auto node = target["node"].index();
    if (!node || *node >= document_.nodes().size())
      return document_.refuse(target["node"].wrong("the number of a node of the file"));
    if (path == kTargets.end()) continue;  // morph targets
    const JsonPlace sampler = document_.element(channels[k]["sampler"], samplers);
    if (!sampler.present()) return document_.refuse(channels[k]["sampler"].wrong("the number of a sampler"));
    const auto way = std::ranges::find(kWays, sampler["interpolation"].text_or("LINEAR"));
    if (way == kWays.end()) return document_.refuse(sampler["interpolation"].wrong("LINEAR, STEP or CUBICSPLINE"));
    Channel channel{static_cast<Target>(path - kTargets.begin()), static_cast<Way>(way - kWays.begin()), {}, {}};
    const std::size_t width = channel.target == Target::rotation ? 4 : 3;
    if (keys_ > kMaxAllKeys)
      return document_.notes.add("the animations have too many keys; further channels are not played");
    auto times = modal::read_floats(document_.glb(), sampler["input"], 1, kMaxKeys);
    auto values = modal::read_floats(document_.glb(), sampler["output"], width, 3 * kMaxKeys);
    const std::size_t each = width * (channel.way == Way::cubic ? 3 : 1);
    const auto leave_out = [&](const std::string& why) {
      document_.notes.add(std::string("the animated ") + *path + " of " + quote(document_.nodes()[*node].name) +
                          " is not played: " + why);
    };
    if (!times || !values) {
      leave_out((times ? values.error() : times.error()).message);
    } else if (times->empty() || values->size() != each * times->size()) {
      leave_out("it does not have a value for each of its " + std::to_string(times->size()) + " keys");
    } else if (std::ranges::adjacent_find(*times, std::greater_equal<>()) != times->end() || !(times->front() >= 0)) {
      leave_out("its keys do not lie at times from 0 that rise");
    } else {
      keys_ += times->size();
      length_s_ = std::max(length_s_, static_cast<double>(times->back()));
      channel.times_s = *std::move(times);
      channel.values = *std::move(values);
      channels_[*node].push_back(std::move(channel));
    }
  }
}

// Returns true if a body is put on the scene by its scale, which is 0 until then.
bool GltfAnimations::is_hidden(const Channel& channel, std::size_t key) {
  constexpr float kHidden = 1e-3F;
  const std::size_t at = channel.way == Way::cubic ? 9 * key + 3 : 3 * key;
  return std::ranges::all_of(std::span(channel.values).subspan(at, 3),
                             [](float scale) { return std::abs(scale) < kHidden; });
}

bool GltfAnimations::changes_size(const Channel& channel) {
  constexpr float kSame = 1e-3F;
  const std::size_t step = channel.way == Way::cubic ? 9 : 3, from = channel.way == Way::cubic ? 3 : 0;
  std::size_t first = 0;
  while (first + 1 < channel.times_s.size() && is_hidden(channel, first)) ++first;
  for (std::size_t k = first; k < channel.times_s.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float size = channel.values[first * step + from + c];
      if (std::abs(channel.values[k * step + from + c] - size) > kSame * std::abs(size)) return true;
    }
  }
  return false;
}

double GltfAnimations::appears_s(std::size_t node) const {
  double from_s = 0;
  for (std::optional<std::size_t> at = node; at; at = document_.nodes()[*at].parent) {
    const auto found = channels_.find(*at);
    if (found == channels_.end()) continue;
    for (const Channel& channel : found->second) {
      std::size_t key = 0;
      while (channel.target == Target::scale && key + 1 < channel.times_s.size() && is_hidden(channel, key)) ++key;
      if (key > 0) from_s = std::max(from_s, static_cast<double>(channel.times_s[key]));
    }
  }
  return from_s;
}

// Follows glTF's appendix C.
std::vector<double> GltfAnimations::value_at(const Channel& channel, double time_s) {
  const std::vector<float>& times = channel.times_s;
  const std::size_t width = channel.target == Target::rotation ? 4 : 3;
  const std::size_t each = width * (channel.way == Way::cubic ? 3 : 1), value = channel.way == Way::cubic ? width : 0;
  // A frame whose time is that of a key but for rounding has the key's value.
  constexpr double kRounding_s = 1e-5;
  const double reached_s = channel.way == Way::step ? time_s + kRounding_s : time_s;
  const auto after = std::ranges::upper_bound(times, reached_s, {}, [](float t) { return static_cast<double>(t); });
  const std::size_t k = after == times.begin() ? 0 : static_cast<std::size_t>(after - times.begin()) - 1;
  const auto at = [&](std::size_t key, std::size_t offset, std::size_t c) {
    return static_cast<double>(channel.values[key * each + offset + c]);
  };
  std::vector<double> result(width);
  const double from = static_cast<double>(times[k]);
  const bool held = k + 1 == times.size() || channel.way == Way::step || time_s <= from;
  const double span = held ? 1 : static_cast<double>(times[k + 1]) - from, t = held ? 0 : (time_s - from) / span;
  // A rotation takes the shorter way, at a steady rate; between equal ones a straight line serves.
  double along = 0;
  for (std::size_t c = 0; c < width && !held; ++c) along += at(k, value, c) * at(k + 1, value, c);
  const double sign = channel.target == Target::rotation && channel.way == Way::linear && along < 0 ? -1 : 1;
  double a = 1 - t, b = t;
  if (sign * along < 1 && !held && channel.target == Target::rotation && channel.way == Way::linear) {
    const double angle = std::acos(std::clamp(sign * along, -1.0, 1.0));
    if (angle > 1e-6) {
      a = std::sin((1 - t) * angle) / std::sin(angle);
      b = std::sin(t * angle) / std::sin(angle);
    }
  }
  for (std::size_t c = 0; c < width; ++c) {
    if (held) {
      result[c] = at(k, value, c);
    } else if (channel.way == Way::cubic) {
      const double t2 = t * t, t3 = t2 * t;
      result[c] = (2 * t3 - 3 * t2 + 1) * at(k, width, c) + span * (t3 - 2 * t2 + t) * at(k, 2 * width, c) +
                  (3 * t2 - 2 * t3) * at(k + 1, width, c) + span * (t3 - t2) * at(k + 1, 0, c);
    } else {
      result[c] = a * at(k, 0, c) + sign * b * at(k + 1, 0, c);
    }
  }
  return result;
}

Affine GltfAnimations::local_at(std::size_t node, double time_s) const {
  const GltfNode& described = document_.nodes()[node];
  const auto found = channels_.find(node);
  if (found == channels_.end()) return described.local;
  const Parts parts = parts_of(described.local.linear);
  Vec3 place = described.local.shift_m, scale = parts.scale;
  Rotation turn = parts.rotation;
  for (const Channel& channel : found->second) {
    const std::vector<double> v = value_at(channel, time_s);
    if (channel.target == Target::translation) place = {v[0], v[1], v[2]};
    const bool hidden = channel.target == Target::scale && std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]) < 3e-3;
    if (channel.target == Target::scale && !hidden) scale = {v[0], v[1], v[2]};
    if (channel.target == Target::rotation) {
      const Rotation q = Rotation::from_xyzw(v[0], v[1], v[2], v[3]);
      turn = norm(q) > 1e-6 ? normalized(q) : Rotation{};
    }
  }
  Affine local{to_matrix(turn), place};
  for (auto& row : local.linear) {
    row[0] *= scale.x;
    row[1] *= scale.y;
    row[2] *= scale.z;
  }
  return local;
}

std::shared_ptr<const MotionPath> GltfAnimations::path_of(std::size_t node) {
  std::vector<std::size_t> chain;
  bool animated = false, scales = false;
  for (std::optional<std::size_t> at = node; at; at = document_.nodes()[*at].parent) {
    chain.push_back(*at);
    const auto found = channels_.find(*at);
    if (found == channels_.end()) continue;
    animated = true;
    for (const Channel& channel : found->second)
      scales = scales || (channel.target == Target::scale && changes_size(channel));
  }
  if (!animated || !(length_s_ > 0)) return nullptr;
  if (scales)
    document_.notes.add("an animation changes the scale of " + quote(document_.nodes()[node].name) +
                        ", which collisions do not follow");
  const double count = std::ceil(length_s_ / every_s_ - 1e-3) + 1;
  const double nodes = static_cast<double>(chain.size());
  if (!(count <= static_cast<double>(kMaxPathPoses)) || !(count * nodes <= static_cast<double>(kMaxPoses - poses_))) {
    document_.notes.add(
        formatted("the animations are longer than {} s, or than {} s of all bodies and the nodes above them together; "
                  "further bodies do not move",
                  static_cast<int>(static_cast<double>(kMaxPathPoses) * every_s_),
                  static_cast<int>(static_cast<double>(kMaxPoses) * every_s_)));
    return nullptr;
  }
  poses_ += static_cast<std::size_t>(count * nodes);
  auto path = std::make_shared<MotionPath>();
  path->every_s = once_ ? every_s_ : length_s_ / (count - 1);
  path->once = once_;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    Affine world;
    for (const std::size_t at : chain) world = local_at(at, static_cast<double>(k) * path->every_s) * world;
    world = upright(world);
    const Pose pose{world.shift_m, parts_of(world.linear).rotation};
    if (!ringdown::is_finite(pose.position_m) || !(length(pose.position_m) <= range::kPosition_m.high)) {
      document_.notes.add("an animation leads out of the scene; its body does not move");
      return nullptr;
    }
    path->poses.push_back(pose);
  }
  return path;
}

}  // namespace ringdown::scene

#include "engine/scene/sounding.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace ringdown::scene {
namespace {

// A strike weaker than this (a grain of sand from 1 mm) is not worth an event.
constexpr double kMinImpulse_ns = 1e-9;

BodyPair pair_of(const Touch& touch) { return std::minmax(touch.body, touch.other); }

Vec3 to_object(const Motion& motion, const Side& side, Vec3 world_m) {
  return transpose(to_matrix(motion.rotation)) * (world_m - motion.position_m) + side.center_m;
}

Vec3 across(Vec3 v, Vec3 normal) { return v - dot(v, normal) * normal; }

// All points of one pair in one step; nothing when no force acts.
std::optional<Touching> gather(BodyPair pair, std::span<const Touch* const> touches, const Side& first,
                               const Side& second) {
  Touching all{.pair = pair};
  double weight = 0;
  Vec3 normals;
  for (const Touch* touch : touches) {
    const double force = length(touch->impulse_ns);
    const bool straight = touch->body == pair.first;
    weight += force;
    all.point_m = all.point_m + force * touch->point_m;
    all.impulse_ns = all.impulse_ns + (straight ? 1 : -1) * touch->impulse_ns;
    normals = normals + (straight ? force : -force) * touch->normal;
    all.first = straight ? touch->of_body : touch->of_other;
    all.second = straight ? touch->of_other : touch->of_body;
  }
  if (!(weight > 0) || !std::isfinite(weight) || !(length(normals) > 0)) return {};
  all.point_m = (1 / weight) * all.point_m;
  const Vec3 normal = (1 / length(normals)) * normals;
  all.slip_m_s = length(across(all.first.velocity_at(all.point_m) - all.second.velocity_at(all.point_m), normal));
  const double turning = length(across(all.first.spin_rad_s - all.second.spin_rad_s, normal));
  const auto reach = [&](const Side& side, const Motion& motion) {
    return side.mass ? length(all.point_m - motion.position_m) : 0.0;
  };
  all.most_roll_m_s = turning * std::max(reach(first, all.first), reach(second, all.second));
  return all;
}

}  // namespace

synth::Frame Timeline::frame(double time_s) const {
  return start + static_cast<synth::Frame>(std::llround(time_s * sample_rate_hz));
}

Sounding::Sounding(const SceneDescription& scene)
    : lives_(scene.contact.minimum_repeat_s, scene.step_s),
      rests_(scene.step_s),
      step_s_(scene.step_s),
      bounce_threshold_m_s_(bounce_threshold(scene)),
      clicks_(scene.contact.clicks),
      rest_damping_s_m_(scene.contact.rest_damping_s_m) {
  events_.reserve(kMaxEventsPerStep);
}

void Sounding::set_side(BodyId id, Side side) {
  if (const Side* before = find(id)) look_again(*before);
  look_again(side);
  sides_.insert_or_assign(id, std::move(side));
}

// Who plays its object has changed.
void Sounding::look_again(const Side& side) {
  if (side.object) look_again_.insert(*side.object);
}

void Sounding::remove_side(BodyId id) {
  if (const Side* side = find(id)) look_again(*side);
  sides_.erase(id);
  rests_.remove(id);
}

void Sounding::silence(synth::ObjectNumber object) {
  for (auto& [id, side] : sides_) {
    if (side.object == object) side.object.reset();
  }
  leaned_on_.erase(object);
}

const Side* Sounding::find(BodyId id) const {
  const auto found = sides_.find(id);
  return found == sides_.end() ? nullptr : &found->second;
}

std::span<const synth::Event> Sounding::hear(std::span<const Touch> touches, std::span<const Moved> moved, double now_s,
                                             const Timeline& timeline) {
  events_.clear();
  leanings_.clear();
  dropped_ = 0;
  by_pair_.clear();
  for (const Touch& touch : touches) by_pair_.push_back(&touch);
  std::ranges::stable_sort(by_pair_, {}, [](const Touch* touch) { return pair_of(*touch); });
  for (auto begin = by_pair_.begin(); begin != by_pair_.end();) {
    const BodyPair pair = pair_of(**begin);
    const auto end = std::find_if(begin, by_pair_.end(), [&](const Touch* touch) { return pair_of(*touch) != pair; });
    hear_pair(pair, std::span(begin, end), now_s, timeline);
    begin = end;
  }
  for (const BodyId id : rests_.advance(moved)) {
    if (const Side* side = find(id)) look_again(*side);
  }
  for (const synth::ObjectNumber object : std::exchange(look_again_, {})) {
    lean(object, timeline.frame(std::max(now_s, latest_s_)));
  }
  for (const Telling& telling : lives_.advance(now_s)) tell(telling, timeline.frame(std::max(now_s, latest_s_)));
  std::ranges::stable_sort(events_, {}, &synth::Event::frame);
  return events_;
}

bool Sounding::is_blow(const Touch& touch) const {
  return touch.approach_m_s > bounce_threshold_m_s_ && is_finite(touch.impulse_ns) &&
         length(touch.impulse_ns) >= kMinImpulse_ns;
}

void Sounding::hear_pair(BodyPair pair, std::span<const Touch* const> touches, double now_s, const Timeline& timeline) {
  double fastest_m_s = 0;
  for (const Touch* touch : touches) {
    if (is_blow(*touch)) fastest_m_s = std::max(fastest_m_s, touch->approach_m_s);
  }
  if (fastest_m_s > 0 && lives_.strikes(pair, fastest_m_s, now_s)) {
    for (const Touch* touch : touches) {
      if (is_blow(*touch)) strike(*touch, now_s, timeline);
    }
    if (clicks_) click(pair, touches, timeline);
    return;
  }
  const Side *first = find(pair.first), *second = find(pair.second);
  if (!first || !second || (!first->object && !second->object)) return;
  const auto all = gather(pair, touches, *first, *second);
  if (!all) return;
  lives_.touch(*all, now_s);
  if (rest_damping_s_m_ > 0) rests_.touch(*all, touches);
}

double Sounding::contact_time_s(const Side& body, const Side& other, const Touch& touch) const {
  if (const auto given = combine(body.surface, other.surface).contact_time_s) return *given;
  const auto gives_way = [&](const Side& side, const Motion& motion) {
    if (!side.mass) return 0.0;
    return inverse_effective_mass(*side.mass, to_matrix(motion.rotation), touch.point_m - motion.position_m,
                                  touch.normal);
  };
  const double inverse_mass = gives_way(body, touch.of_body) + gives_way(other, touch.of_other);
  const double time_s = hertz_time(inverse_mass, relative_radius(body.curvature, other.curvature),
                                   contact_modulus(body.elastic, other.elastic), touch.approach_m_s);
  return std::min(time_s, range::kContactTime_s.high);
}

void Sounding::strike(const Touch& touch, double now_s, const Timeline& timeline) {
  const Side *body = find(touch.body), *other = find(touch.other);
  if (!body || !other) return;
  const double since_s = std::clamp(touch.depth_m / touch.approach_m_s, 0.0, step_s_);
  latest_s_ = std::max(latest_s_, now_s + touch.found_s - since_s);
  synth::Event event;
  event.frame = timeline.frame(latest_s_);
  event.contact_time_s = contact_time_s(*body, *other, touch);
  const auto strike_side = [&](const Side& side, const Motion& motion, Vec3 impulse_ns) {
    if (!side.object) return;
    event.object = *side.object;
    event.point_m = to_object(motion, side, touch.point_m);
    event.impulse_ns = transpose(to_matrix(motion.rotation)) * impulse_ns;
    push(event);
  };
  strike_side(*body, touch.of_body, touch.impulse_ns);
  strike_side(*other, touch.of_other, -1 * touch.impulse_ns);
}

// Several bodies of one object share its modes: nothing can damp one of them alone.
void Sounding::lean(synth::ObjectNumber object, synth::Frame frame) {
  const auto plays = [object](const auto& entry) { return entry.second.object == object; };
  const bool alone = std::ranges::count_if(sides_, plays) == 1;
  std::vector<modal::Damper> all;
  if (alone) {
    const auto& [id, side] = *std::ranges::find_if(sides_, plays);
    rests_.each_of(id, [&, id = id, &side = side](const Rest& rest) {
      const bool is_first = rest.pair.first == id;
      const Side* const other = find(is_first ? rest.pair.second : rest.pair.first);
      if (!other) return;
      const Motion& motion = is_first ? rest.first : rest.second;
      const double lost = 1 - combine(side.surface, other->surface).restitution;
      const double each_n = rest.force_n / static_cast<double>(rest.points.size());
      for (const Rest::Point& point : rest.points) {
        all.push_back({to_object(motion, side, point.point_m), transpose(to_matrix(motion.rotation)) * point.normal,
                       rest_damping_s_m_ * lost * each_n});
      }
    });
  }
  if (all.empty() && !leaned_on_.contains(object)) return;
  if (all.empty()) {
    leaned_on_.erase(object);
  } else {
    leaned_on_.insert(object);
  }
  std::ranges::stable_sort(all, std::greater{}, &modal::Damper::damping_ns_m);
  Leaning leaning{.frame = frame, .object = object, .dampers = {}};
  for (std::uint32_t i = 0; i < modal::kMaxDampers - modal::kFirstSceneDamper; ++i) {
    leaning.dampers[modal::kFirstSceneDamper + i] = i < all.size() ? all[i] : modal::Damper{};
  }
  leanings_.push_back(std::move(leaning));
}

// All points of a blow move a body at once; the hardest says for how long.
void Sounding::click(BodyPair pair, std::span<const Touch* const> touches, const Timeline& timeline) {
  const Touch* hardest = nullptr;
  Vec3 on_first_ns;
  for (const Touch* touch : touches) {
    if (!is_blow(*touch)) continue;
    on_first_ns = on_first_ns + (touch->body == pair.first ? 1 : -1) * touch->impulse_ns;
    if (!hardest || length(touch->impulse_ns) > length(hardest->impulse_ns)) hardest = touch;
  }
  const Side *body = find(hardest->body), *other = find(hardest->other);
  if (!body || !other) return;
  synth::Event event;
  event.frame = timeline.frame(latest_s_);
  event.type = synth::EventType::click;
  event.contact_time_s = contact_time_s(*body, *other, *hardest);
  const auto click_side = [&](const Side& side, const Motion& motion, double sign) {
    if (!side.object || !side.mass) return;
    event.object = *side.object;
    event.impulse_ns = sign * (transpose(to_matrix(motion.rotation)) * on_first_ns);
    push(event);
  };
  const double sign = hardest->body == pair.first ? 1 : -1;
  click_side(*body, hardest->of_body, sign);
  click_side(*other, hardest->of_other, -sign);
}

void Sounding::tell(const Telling& telling, synth::Frame frame) {
  const Side *first = find(telling.pair.first), *second = find(telling.pair.second);
  const synth::Texture texture = first && second ? combine(first->surface, second->surface).texture : synth::Texture{};
  const auto entry = lines_.try_emplace(telling.pair).first;
  Lines& lines = entry->second;
  tell_side(telling, first, lines.first, telling.first, telling.force_n, texture, frame);
  tell_side(telling, second, lines.second, telling.second, -1 * telling.force_n, texture, frame);
  if (!lines.first && !lines.second) lines_.erase(entry);
}

void Sounding::tell_side(const Telling& telling, const Side* side, std::optional<Line>& line, const Motion& motion,
                         Vec3 force_n, const synth::Texture& texture, synth::Frame frame) {
  const bool sounds = side && side->object;
  if (!line && (!sounds || telling.ends)) return;
  if (!line) line = Line{*side->object, free_number(*side->object)};
  synth::Event event;
  event.frame = frame;
  event.type = synth::EventType::contact;
  event.object = line->object;
  event.contact.number = line->number;
  if (!telling.ends && sounds && side->object == line->object) {
    event.point_m = to_object(motion, *side, telling.point_m);
    event.contact.force_n = transpose(to_matrix(motion.rotation)) * force_n;
    event.contact.slip_m_s = telling.slip_m_s;
    event.contact.roll_m_s = telling.roll_m_s;
    event.contact.texture = texture;
  } else {
    line.reset();
  }
  push(event);
}

std::uint32_t Sounding::free_number(synth::ObjectNumber object) const {
  std::vector<std::uint32_t> taken;
  for (const auto& [pair, lines] : lines_) {
    for (const auto& line : {lines.first, lines.second}) {
      if (line && line->object == object) taken.push_back(line->number);
    }
  }
  std::ranges::sort(taken);
  std::uint32_t number = 0;
  for (const std::uint32_t other : taken) number += other == number;
  return number;
}

void Sounding::push(const synth::Event& event) {
  if (events_.size() == kMaxEventsPerStep) {
    ++dropped_;
    return;
  }
  events_.push_back(event);
}

}  // namespace ringdown::scene

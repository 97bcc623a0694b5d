#include "engine/scene/contact/contact_sounds.h"

#include "engine/scene/contact/bearing.h"
#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/contact/hertz.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

// From the contact points of a step to events, downward:
//
// 1. Points are sorted by pair of bodies; those of one pair mostly follow each other already (process).
// 2. A pair with a point that approaches faster than the bounce threshold may strike: ContactLives decides whether this
//    is a new strike or chatter. Every such point becomes a strike event for both objects, and all of them together one
//    click, the rigid body's own sound (process_pair, strike, click). If a body breaks
//    under its blows (break_share), it ends here.
// 3. The points of any other pair are combined into one contact (combine_points), which ContactLives and RestDampings
//    follow over time.
// 4. At the end of the step come the reports of lasting contacts (LastingEvents) and the dampers of resting ones.
namespace ringdown::scene {
namespace {

// A strike weaker than this (a grain of sand from 1 mm) is not worth an event.
constexpr double kMinImpulse_ns = 1e-9;

BodyPair pair_of(const ContactPoint& point) { return std::minmax(point.body, point.other); }

// The part of a vector that lies in a surface.
Vec3 along(Vec3 v, Vec3 normal) { return v - dot(v, normal) * normal; }

// The contact of a pair: point and normal are means weighted by force. Nothing when no force acts.
std::optional<PairContact> combine_points(BodyPair pair, std::span<const ContactPoint* const> points,
                                          const ContactSide& first, const ContactSide& second) {
  PairContact all{.pair = pair};
  double weight = 0;
  Vec3 normals;
  for (const ContactPoint* point : points) {
    const double force = length(point->impulse_ns);
    const bool straight = point->body == pair.first;
    weight += force;
    all.point_m = all.point_m + force * point->point_m;
    all.impulse_ns = all.impulse_ns + (straight ? 1 : -1) * point->impulse_ns;
    normals = normals + (straight ? force : -force) * point->normal;
  }
  const ContactPoint& last = *points.back();
  all.first = last.body == pair.first ? last.motions->of_body : last.motions->of_other;
  all.second = last.body == pair.first ? last.motions->of_other : last.motions->of_body;
  if (!(weight > 0) || !std::isfinite(weight) || !(length(normals) > 0)) return {};
  all.point_m = (1 / weight) * all.point_m;
  all.normal = (1 / length(normals)) * normals;
  all.slide_m_s = along(all.first.velocity_at(all.point_m) - all.second.velocity_at(all.point_m), all.normal);
  const double turning = length(along(all.first.spin_rad_s - all.second.spin_rad_s, all.normal));
  const auto arm = [&](const ContactSide& side, const Motion& motion) {
    return side.mass ? length(all.point_m - motion.position_m) : 0.0;
  };
  all.max_roll_m_s = turning * std::max(arm(first, all.first), arm(second, all.second));
  return all;
}

// One over the mass that two bodies oppose to an impact [1/kg].
double inverse_mass_of(const ContactSide& body, const ContactSide& other, const ContactPoint& point) {
  return inverse_mass(body, point.motions->of_body, point.point_m, point.normal) +
         inverse_mass(other, point.motions->of_other, point.point_m, point.normal);
}

// Returns the duration of an impact: the one that the surfaces state, or that of Hertz's law (hertz.h) for the mass
// that each side opposes to the impact, their curvatures and their elasticities.
double contact_time_s(const ContactSide& body, const ContactSide& other, const ContactPoint& point) {
  if (const auto given = combine(body.surface, other.surface).contact_time_s) return *given;
  const double both = inverse_mass_of(body, other, point);
  const double time_s = hertz_time(both, relative_radius(body.curvature, other.curvature),
                                   contact_modulus(body.elastic, other.elastic), point.approach_m_s);
  return std::min(time_s, range::kContactTime_s.high);
}

synth::verb::Strike strike_of(const ContactPoint& point, const ContactSide& side, const Motion& motion, Vec3 impulse_ns,
                              double contact_time_s) {
  return {.point_m = to_object(motion, side, point.point_m),
          .impulse_ns = transpose(to_matrix(motion.rotation)) * impulse_ns,
          .contact_time_s = contact_time_s};
}

}  // namespace

synth::Frame FrameClock::frame(double time_s) const {
  return start + static_cast<synth::Frame>(std::llround(time_s * sample_rate_hz));
}

ContactSounds::ContactSounds(const SceneDescription& scene)
    : step_s_(scene.step_s),
      bounce_threshold_m_s_(bounce_threshold(scene)),
      clicks_(scene.contact.clicks),
      lives_(scene.contact.minimum_repeat_s, scene.step_s),
      resting_(scene) {
  events_.events.reserve(kMaxEventsPerStep);
}

void ContactSounds::set_side(BodyId id, ContactSide side) {
  if (const ContactSide* before = find(sides_, id)) resting_.side_changed(*before);
  resting_.side_changed(side);
  sides_.insert_or_assign(id, std::move(side));
}

void ContactSounds::remove_side(BodyId id) {
  if (const ContactSide* side = find(sides_, id)) resting_.side_changed(*side);
  sides_.erase(id);
  resting_.remove(id);
}

void ContactSounds::silence(synth::ObjectNumber object) {
  for (auto& [id, side] : sides_) {
    if (side.object == object) side.object.reset();
  }
  resting_.silence(object);
}

std::span<const synth::Event> ContactSounds::process(std::span<const ContactPoint> points,
                                                     std::span<const MovedBody> moved, double now_s,
                                                     const FrameClock& timeline) {
  events_.clear();
  heard_.clear();
  by_pair_.clear();
  runs_.clear();
  for (const ContactPoint& point : points) {
    const BodyPair pair = pair_of(point);
    if (runs_.empty() || runs_.back().pair != pair) runs_.push_back({pair, {&point, 0}});
    runs_.back().points = {runs_.back().points.data(), runs_.back().points.size() + 1};
  }
  std::ranges::stable_sort(runs_, {}, &Run::pair);
  for (const Run& run : runs_) {
    for (const ContactPoint& point : run.points) by_pair_.push_back(&point);
  }
  for (auto begin = by_pair_.begin(); begin != by_pair_.end();) {
    const BodyPair pair = pair_of(**begin);
    const auto is_other = [&](const ContactPoint* point) { return pair_of(*point) != pair; };
    const auto end = std::find_if(begin, by_pair_.end(), is_other);
    process_pair(pair, std::span(begin, end), now_s, timeline);
    begin = end;
  }
  const synth::Frame frame = timeline.frame(std::max(now_s, latest_s_));
  rest_dampings_ = resting_.advance(moved, sides_, frame);
  for (const ContactReport& report : lives_.advance(now_s)) {
    lasting_.add(report, sides_, frame, events_);
    heard_.push_back({report.ends ? HeardContact::end : HeardContact::lasting, now_s, report.pair, report.point_m,
                      report.force_n, report.slip_m_s, report.roll_m_s});
  }
  if (!std::ranges::is_sorted(events_.events, {}, &synth::Event::frame)) {
    std::ranges::stable_sort(events_.events, {}, &synth::Event::frame);
  }
  return events_.events;
}

bool ContactSounds::is_impact(const ContactPoint& point) const {
  return point.approach_m_s > bounce_threshold_m_s_ && is_finite(point.impulse_ns) &&
         length(point.impulse_ns) >= kMinImpulse_ns;
}

void ContactSounds::process_pair(BodyPair pair, std::span<const ContactPoint* const> points, double now_s,
                                 const FrameClock& timeline) {
  double fastest_m_s = 0;
  for (const ContactPoint* point : points) {
    if (is_impact(*point)) fastest_m_s = std::max(fastest_m_s, point->approach_m_s);
  }
  if (fastest_m_s > 0 && lives_.strikes(pair, fastest_m_s, now_s)) {
    strike(pair, points, now_s, timeline);
    note_blow(pair, points);
    return;
  }
  const ContactSide *first = find(sides_, pair.first), *second = find(sides_, pair.second);
  if (!first || !second || (!first->object && !second->object)) return;
  const auto contact = combine_points(pair, points, *first, *second);
  if (!contact) return;
  lives_.add(*contact, now_s);
  resting_.add(*contact, points);
}

// Returns how long two faces touch when they meet (bearing.h). Returns nothing unless a surface has a waviness and the
// points span a patch.
std::optional<double> ContactSounds::face_time_s(std::span<const ContactPoint* const> points) const {
  constexpr double kMin_m2 = 1e-10;
  const ContactPoint& last = *points.back();
  const ContactSide *body = find(sides_, last.body), *other = find(sides_, last.other);
  if (points.size() < 3 || !body || !other || !(body->surface.waviness || other->surface.waviness)) return {};
  if (combine(body->surface, other->surface).contact_time_s) return {};
  std::vector<Vec3> places;
  Vec3 middle_m;
  double weight = 0, approach_m_s = 0;
  for (const ContactPoint* point : points) {
    places.push_back(point->point_m);
    const double force = length(point->impulse_ns);
    middle_m = middle_m + force * point->point_m;
    weight += force;
    approach_m_s = std::max(approach_m_s, point->approach_m_s);
  }
  const double area_m2 = patch_area(places, last.normal);
  if (!(weight > 0) || !(area_m2 > kMin_m2)) return {};
  ContactPoint all = last;
  all.point_m = (1 / weight) * middle_m;
  const double time_s =
      face_impact_time(inverse_mass_of(*body, *other, all), contact_modulus(body->elastic, other->elastic), area_m2,
                       waviness_of(body->surface, other->surface), approach_m_s);
  return std::min(time_s, range::kContactTime_s.high);
}

// Every point strikes both objects, unless a body breaks.
void ContactSounds::strike(BodyPair pair, std::span<const ContactPoint* const> points, double now_s,
                           const FrameClock& timeline) {
  const std::optional<double> face_s = face_time_s(points);
  strikes_.clear();
  for (const ContactPoint* point : points) {
    const ContactSide *body = find(sides_, point->body), *other = find(sides_, point->other);
    if (!is_impact(*point) || !body || !other) continue;
    const double since_s = std::clamp(point->depth_m / point->approach_m_s, 0.0, step_s_);
    latest_s_ = std::max(latest_s_, now_s + point->found_s - since_s);
    const bool by_hertz = !face_s && !combine(body->surface, other->surface).contact_time_s;
    strikes_.push_back({point, face_s ? *face_s : contact_time_s(*body, *other, *point), timeline.frame(latest_s_),
                        point->found_s - since_s, by_hertz});
  }
  if (strikes_.empty()) return;
  const std::optional<double> first_breaks = break_share(pair.first, pair.second),
                              second_breaks = break_share(pair.second, pair.first);
  const bool whole = !first_breaks && !second_breaks;
  const double share = std::min(first_breaks.value_or(1), second_breaks.value_or(1));
  for (const PairStrike& strike : strikes_) {
    const auto& [point, lasting_s, frame, touched_s, by_hertz] = strike;
    const ContactSide &body = sides_.at(point->body), &other = sides_.at(point->other);
    const bool two_way = (body.two_way || other.two_way) && whole;
    if (two_way && strike_two_way(body, other, *point, lasting_s, frame)) continue;
    const auto strike_side = [&](BodyId id, const ContactSide& side, const Motion& motion, Vec3 impulse_ns) {
      if (!side.object || (id == pair.first ? first_breaks : second_breaks)) return;
      events_.push({frame, *side.object, strike_of(*point, side, motion, impulse_ns, lasting_s)});
    };
    strike_side(point->body, body, point->motions->of_body, share * point->impulse_ns);
    strike_side(point->other, other, point->motions->of_other, -share * point->impulse_ns);
  }
  if (clicks_) click(pair, share);
  if (first_breaks) end_contacts(pair.first, strikes_.front().frame);
  if (second_breaks) end_contacts(pair.second, strikes_.front().frame);
}

// Returns the corners of the body's face between the points of the strikes, in the world: those that are nearly as deep
// as the deepest one, as many as a meeting may have, spread evenly. Empty if the strikes span no face.
std::vector<Vec3> ContactSounds::face_around(const ContactSide& side, bool straight) const {
  constexpr double kMin_m2 = 1e-6, kDepth_m = 1e-4;
  constexpr std::size_t kMax = 12;
  std::vector<Vec3> places, corners;
  for (const PairStrike& strike : strikes_) places.push_back(strike.point->point_m);
  const ContactPoint& first = *strikes_.front().point;
  const Vec3 normal = (straight ? 1 : -1) * first.normal;  // into the body
  if (places.size() < 3 || side.corners_m.empty() || !(patch_area(places, normal) > kMin_m2)) return {};
  const Motion& motion = straight ? first.motions->of_body : first.motions->of_other;
  const Matrix3 turn = to_matrix(motion.rotation);
  double lowest_m = HUGE_VAL;
  for (const Vec3& corner : side.corners_m) {
    corners.push_back(motion.position_m + turn * corner);
    lowest_m = std::min(lowest_m, dot(normal, corners.back()));
  }
  std::erase_if(corners, [&](const Vec3& corner) { return dot(normal, corner) > lowest_m + kDepth_m; });
  if (corners.size() <= places.size()) return {};
  std::vector<double> distance(corners.size(), HUGE_VAL);
  std::vector<Vec3> chosen;
  for (std::size_t next = 0; chosen.size() < std::min(kMax, corners.size());) {
    chosen.push_back(corners[next]);
    for (std::size_t k = 0; k < corners.size(); ++k)
      distance[k] = std::min(distance[k], length(corners[k] - corners[next]));
    next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
  }
  return chosen;
}

// Asks the judge. Where the contact time is that of the whole pair, each point has the part of the mass that its
// impulse stands for, so that all its springs together bounce in that time.
std::optional<double> ContactSounds::break_share(BodyId body, BodyId other) const {
  const ContactSide &side = sides_.at(body), &striker = sides_.at(other);
  if (!side.breaks || !side.object || !judge_) return {};
  constexpr double kMinBounce = 0.05, kMinContact_s = 1e-5;
  const double bounce = std::clamp(combine(side.surface, striker.surface).restitution, kMinBounce, 1.0);
  std::vector<PairStrike> strikes = strikes_;
  std::ranges::stable_sort(strikes, {}, [](const PairStrike& s) { return -length(s.point->impulse_ns); });
  if (strikes.size() > contact::kMaxContacts) strikes.resize(contact::kMaxContacts);
  const double first_s = std::ranges::min_element(strikes, {}, &PairStrike::touched_s)->touched_s;
  BodyBlows blows{.frame = strikes_.front().frame, .strikes = {}, .meeting = {}};
  std::vector<PushedPlace> pushes;
  const Motion *of_body = nullptr, *of_striker = nullptr;
  for (const auto& [point, lasting_s, frame, touched_s, by_hertz] : strikes) {
    const bool straight = point->body == body;
    of_body = straight ? &point->motions->of_body : &point->motions->of_other;
    of_striker = straight ? &point->motions->of_other : &point->motions->of_body;
    const Vec3 normal = (straight ? 1 : -1) * point->normal, impulse_ns = (straight ? 1 : -1) * point->impulse_ns;
    blows.strikes.push_back(strike_of(*point, side, *of_body, impulse_ns, lasting_s));
    blows.pressed_ns += dot(impulse_ns, normal);
    const double mass_kg = by_hertz ? 1 / inverse_mass_of(sides_.at(point->body), sides_.at(point->other), *point)
                                    : dot(impulse_ns, normal) / ((1 + bounce) * point->approach_m_s);
    const double stiffness = hertz_stiffness(mass_kg, point->approach_m_s, std::max(lasting_s, kMinContact_s));
    blows.meeting.points.push_back({.point_m = blows.strikes.back().point_m,
                                    .normal = transpose(to_matrix(of_body->rotation)) * normal,
                                    .closing_m_s = point->approach_m_s,
                                    .gap_m = (touched_s - first_s) * point->approach_m_s,
                                    .law = {.stiffness = stiffness, .bounce = bounce}});
    pushes.push_back({point->point_m, normal});
  }
  if (const std::vector<Vec3> face = face_around(side, strikes_.front().point->body == body); !face.empty()) {
    const PushedPlace like = pushes.front();
    breaking::MeetingPoint point = blows.meeting.points.front();
    // Together, springs of a stated contact time are as stiff as those of the strikes.
    if (!strikes.front().by_hertz)
      point.law.stiffness *= static_cast<double>(pushes.size()) / static_cast<double>(face.size());
    double lowest_m = HUGE_VAL;
    for (const Vec3& at : face) lowest_m = std::min(lowest_m, dot(like.normal, at));
    pushes.clear();
    blows.meeting.points.clear();
    for (const Vec3& at : face) {
      double nearest_m = HUGE_VAL;
      for (const Vec3& other_at : face) {
        if (&other_at != &at) nearest_m = std::min(nearest_m, length(other_at - at));
      }
      blows.meeting.spacing_m = std::max(blows.meeting.spacing_m, nearest_m);
      point.point_m = to_object(*of_body, side, at);
      point.closing_m_s = dot(like.normal, of_striker->velocity_at(at) - of_body->velocity_at(at));
      point.gap_m = dot(like.normal, at) - lowest_m;
      blows.meeting.points.push_back(point);
      pushes.push_back({at, like.normal});
    }
  }
  for (const PushedPlace& at : pushes) {
    for (const PushedPlace& push : pushes)
      blows.meeting.other_per_kg.push_back(inverse_mass(striker, *of_striker, at, push));
  }
  return judge_(body, other, blows);
}

void ContactSounds::end_contacts(BodyId body, synth::Frame frame) {
  for (const ContactReport& report : lives_.end(body)) lasting_.add(report, sides_, frame, events_);
  ContactSide& side = sides_.at(body);
  resting_.side_changed(side);
  side.object.reset();
}

void ContactSounds::pass_on(BodyId other, BodyId gone, BodyId piece) {
  lives_.pass_on(std::minmax(other, gone), std::minmax(other, piece));
}

// The bodies' common mass flies at the first object that sounds, and its head is the other's surface, if that sounds,
// too. The spring between them is as stiff as makes rigid bodies touch for the contact time. False where there is none.
bool ContactSounds::strike_two_way(const ContactSide& body, const ContactSide& other, const ContactPoint& point,
                                   double contact_time_s, synth::Frame frame) {
  const bool straight = body.object.has_value();
  const ContactSide &struck = straight ? body : other, &head = straight ? other : body;
  const double inverse_mass = inverse_mass_of(body, other, point);
  if (!struck.object || !(inverse_mass > 0) || !(contact_time_s > 0)) return false;
  const auto in_frame_of = [&](bool of_body, Vec3 world) {
    return transpose(to_matrix((of_body ? point.motions->of_body : point.motions->of_other).rotation)) * world;
  };
  const Vec3 impulse_ns = (straight ? 1 : -1) * point.impulse_ns;
  const Vec3 way = (1 / length(impulse_ns)) * impulse_ns;
  constexpr double kMinBounce = 0.05;
  // Bodies that share an impact with others, or graze an edge, give less than they would alone.
  const double pushed_m_s = length(impulse_ns) * inverse_mass;
  const double speed = std::min(point.approach_m_s, pushed_m_s / (1 + kMinBounce));
  synth::verb::Collision hit;
  hit.point_m = to_object(straight ? point.motions->of_body : point.motions->of_other, struck, point.point_m);
  hit.impulse_ns = in_frame_of(straight, impulse_ns);
  hit.contact_time_s = contact_time_s;
  hit.direction = in_frame_of(straight, way);
  hit.speed_m_s = speed;
  hit.mass_kg = 1 / inverse_mass;
  hit.stiffness = hertz_stiffness(hit.mass_kg, speed, contact_time_s);
  hit.bounce = std::clamp(pushed_m_s / speed - 1, kMinBounce, 1.0);
  if (head.object && *head.object != *struck.object) {
    hit.other = *head.object;
    hit.other_point_m = to_object(straight ? point.motions->of_other : point.motions->of_body, head, point.point_m);
    hit.other_direction = in_frame_of(!straight, -1 * way);
  }
  events_.push({frame, *struck.object, hit});
  return true;
}

void ContactSounds::note_blow(BodyPair pair, std::span<const ContactPoint* const> points) {
  HeardContact blow{.time_s = latest_s_, .pair = pair};
  double weight = 0;
  for (const ContactPoint* point : points) {
    if (!is_impact(*point)) continue;
    const double size = length(point->impulse_ns);
    blow.push = blow.push + (point->body == pair.first ? 1 : -1) * point->impulse_ns;
    blow.point_m = blow.point_m + size * point->point_m;
    blow.speed_m_s = std::max(blow.speed_m_s, point->approach_m_s);
    weight += size;
  }
  blow.point_m = (1 / weight) * blow.point_m;
  heard_.push_back(blow);
}

// The impulses of all points move the body as a whole at once; the hardest point's contact time is the click's.
void ContactSounds::click(BodyPair pair, double share) {
  const PairStrike* hardest = nullptr;
  Vec3 on_first_ns;
  for (const PairStrike& strike : strikes_) {
    const ContactPoint& point = *strike.point;
    on_first_ns = on_first_ns + (point.body == pair.first ? share : -share) * point.impulse_ns;
    if (!hardest || length(point.impulse_ns) > length(hardest->point->impulse_ns)) hardest = &strike;
  }
  const ContactPoint& point = *hardest->point;
  synth::verb::Click click;
  click.contact_time_s = hardest->contact_time_s;
  const auto click_side = [&](const ContactSide& side, const Motion& motion, double sign) {
    if (!side.object || !side.mass) return;
    click.impulse_ns = sign * (transpose(to_matrix(motion.rotation)) * on_first_ns);
    events_.push({strikes_.back().frame, *side.object, click});
  };
  const double sign = point.body == pair.first ? 1 : -1;
  click_side(sides_.at(point.body), point.motions->of_body, sign);
  click_side(sides_.at(point.other), point.motions->of_other, -sign);
}

}  // namespace ringdown::scene

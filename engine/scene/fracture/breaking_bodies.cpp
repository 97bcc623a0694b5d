#include "engine/scene/fracture/breaking_bodies.h"

#include "engine/base/quote.h"
#include "engine/modal/fracture/strength.h"
#include "engine/modal/strike_map.h"
#include "engine/scene/hull.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

namespace ringdown::scene {
namespace {

// The search for contacts of two hulls takes a time that grows with their edges: with all corners of the 29 pieces of a
// tumbler, a step in which they land took 9 ms.
constexpr std::size_t kMaxCorners = 16;

// Chooses corners that are far from each other, where the piece counts as equally thick in all three directions of its
// principal axes: so a thin piece keeps both of its faces.
std::vector<Vec3> spread_corners(std::vector<Vec3> points, const modal::MassProperties& mass) {
  if (auto hull = convex_hull(points); hull) points = std::move(hull->points);
  if (points.size() <= kMaxCorners) return points;
  const Rotation to_axes = inverse(Rotation::from_xyzw(mass.orientation));
  const Vec3 i = mass.inertia_kg_m2;
  const auto thickness = [&](double twice) { return std::sqrt(std::max(twice, 1e-6 * (i.x + i.y + i.z))); };
  const Vec3 thick{thickness(i.y + i.z - i.x), thickness(i.x + i.z - i.y), thickness(i.x + i.y - i.z)};
  std::vector<Vec3> places;
  for (const Vec3& point : points) {
    const Vec3 along = rotated(to_axes, point - mass.center_of_mass_m);
    places.push_back({along.x / thick.x, along.y / thick.y, along.z / thick.z});
  }
  std::vector<double> distance(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) distance[k] = length(places[k]);
  std::vector<Vec3> chosen;
  while (chosen.size() < kMaxCorners) {
    const auto next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
    const bool first = chosen.empty();
    chosen.push_back(points[next]);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double way = length(places[k] - places[next]);
      distance[k] = first ? way : std::min(distance[k], way);
    }
  }
  return chosen;
}

// The description of a piece as a body: the hull of its bank in the size and material of the whole.
BodyDescription piece_description(const BodyDescription& whole, const modal::Bank& bank,
                                  const modal::MaterialScale& scale, const modal::MassProperties& mass) {
  BodyDescription piece;
  piece.mass = mass;
  piece.shape.type = ShapeType::convex;
  std::vector<Vec3> points;
  for (const modal::Vec3f& p : bank.positions) points.push_back(scale.size * Vec3{p[0], p[1], p[2]});
  piece.shape.mesh = std::make_shared<const ShapeMesh>(ShapeMesh{spread_corners(std::move(points), mass), {}});
  piece.gravity_factor = whole.gravity_factor;
  piece.filter = whole.filter;
  piece.surface = whole.surface;
  if (bank.material && !piece.surface.young_pa)
    piece.surface.young_pa = bank.material->youngs_modulus_pa * scale.stiffness;
  if (bank.material && !piece.surface.poisson) piece.surface.poisson = bank.material->poisson_ratio;
  return piece;
}

// Changes a motion by an impulse at a point of the world.
void push(Motion& motion, const RigidMass& mass, Vec3 point_m, Vec3 impulse_ns) {
  const Matrix3 turn = to_matrix(motion.rotation);
  const Vec3 moment = transpose(turn) * cross(point_m - motion.position_m, impulse_ns);
  motion.velocity_m_s = motion.velocity_m_s + (1 / mass.mass_kg) * impulse_ns;
  motion.spin_rad_s = motion.spin_rad_s + turn * (inverse(mass.inertia_kg_m2) * moment);
}

}  // namespace

std::string piece_name(const std::string& whole, const modal::Fracture& fracture, std::size_t pattern,
                       std::size_t piece) {
  for (std::size_t p = 0; p < pattern; ++p) piece += fracture.patterns[p].pieces.size();
  return whole + "." + std::to_string(piece);
}

std::size_t BreakingBodies::Pattern::body_count() const {
  return static_cast<std::size_t>(std::ranges::count_if(pieces, [](const auto& piece) { return piece != nullptr; }));
}

void BreakingBodies::Pattern::silence(synth::ObjectNumber object) {
  std::ranges::replace(objects, std::optional(object), std::nullopt);
  for (const std::shared_ptr<Pattern>& one : finer) {
    if (one) one->silence(object);
  }
}

BreakingBodies::BreakingBodies(SceneBodies& bodies, std::uint64_t seed, double sample_rate_hz)
    : scene_(bodies), seed_(seed), sample_rate_hz_(sample_rate_hz) {
  scene_.sounds.judge_by(
      [this](BodyId body, BodyId other, const BodyBlows& blows) { return judge(body, other, blows); });
}

Result<void> BreakingBodies::add(BodyId id, const Body& body) {
  const auto refuse = [&](const std::string& why) {
    return fail(ErrorKind::bad_input, "body " + quote(body.description.name) + " cannot break: " + why);
  };
  const SoundingObject& object = *scene_.store.find_object(body.description.object);
  const modal::MaterialScale scale = scene_.store.scale_of(object.name);
  if (object.bank->held) return refuse("its bank is held by supports");
  if (object.bank->nonlinear) return refuse("its modes exchange energy, which is not followed");
  const auto map = object.map ? object.map : std::make_shared<const modal::StrikeMap>(object.bank);
  auto state = breaking::Breakable::make(map, scale, sample_rate_hz_, 0);
  if (!state) return refuse(state.error().message);
  const modal::Fracture& fracture = state->fracture();
  Entry entry{.state = *state, .breaks = *body.description.breaks, .number = id, .strength_pa = {}, .patterns = {}};
  entry.strength_pa = strength_of(entry);
  if (!state->knows_stress() && entry.breaks.strength_pa)
    return refuse("its bank does not know the stress of its modes; bake it again, or give impulse_ns");
  if (!entry.strength_pa && !entry.breaks.impulse_ns) {
    return refuse(
        "its bank knows no strength; give breaks an impulse_ns, or bake it of a material that has a strength");
  }
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    auto pattern = pattern_of(body, object, *state, p);
    if (!pattern) return refuse(pattern.error().message);
    entry.patterns.push_back(std::move(*pattern));
  }
  nest(entry.patterns, *state);
  bodies_.insert_or_assign(id, std::move(entry));
  return {};
}

// Returns nothing if stress does not break the body.
std::optional<double> BreakingBodies::strength_of(const Entry& entry) const {
  if (!entry.state.knows_stress()) return {};
  if (entry.breaks.strength_pa) return entry.breaks.strength_pa;
  const modal::Fracture& fracture = entry.state.fracture();
  if (!fracture.strength || !(fracture.skin_m2 > 0)) return {};
  const double size = entry.state.material().size;
  return modal::drawn_strength_pa(*fracture.strength, size * size * fracture.skin_m2, seed_, entry.number);
}

// Makes the patterns by which pieces break again, from the finest on, because they contain each other.
void BreakingBodies::nest(std::vector<Pattern>& patterns, const breaking::Breakable& state) {
  for (std::size_t p = patterns.size() - 1; p-- > 0;) {
    Pattern& pattern = patterns[p];
    const Pattern& next = patterns[p + 1];
    for (std::size_t i = 0; i < pattern.finer.size(); ++i) {
      const auto& map = pattern.set->pieces()[i].map;
      if (!pattern.pieces[i] || !pattern.pieces[i]->description.breaks) continue;
      auto& set = finer_sets_[{pattern.set, i}];
      if (!set) set = std::make_shared<const breaking::PieceSet>(*map, state.material(), 0);
      Pattern& own = *(pattern.finer[i] = std::make_shared<Pattern>());
      own.set = set;
      for (const std::size_t k : modal::pieces_of_piece(state.fracture(), p, i)) {
        own.objects.push_back(next.objects[k]);
        own.pieces.push_back(next.pieces[k]);
        own.finer.push_back(next.finer[k]);
      }
    }
  }
}

Result<BreakingBodies::Pattern> BreakingBodies::pattern_of(const Body& body, const SoundingObject& object,
                                                           const breaking::Breakable& state, std::size_t number) const {
  Pattern pattern;
  pattern.set = number < object.pieces.size()
                    ? object.pieces[number]
                    : std::make_shared<const breaking::PieceSet>(*state.map(), state.material(), number);
  const modal::Fracture& fracture = state.fracture();
  for (std::size_t i = 0; i < pattern.set->pieces().size(); ++i) {
    const modal::MassProperties& mass = pattern.set->pieces()[i].mass;
    const SoundingObject* sounds = scene_.store.find_object(piece_name(object.name, fracture, number, i));
    pattern.objects.push_back(sounds ? std::optional(sounds->number) : std::nullopt);
    auto& piece = pattern.pieces.emplace_back();
    pattern.finer.emplace_back();
    if (mass.mass_kg < std::max(body.description.breaks->min_mass_kg, range::kMass_kg.low)) continue;
    BodyDescription description =
        piece_description(body.description, fracture.patterns[number].pieces[i].bank, state.material(), mass);
    description.name = piece_name(body.description.name, fracture, number, i);
    if (sounds) description.object = sounds->name;
    Result<Solid> solid = make_solid(description, nullptr);
    if (!solid) return fail(solid.error().kind, "its piece " + std::to_string(i) + ": " + solid.error().message);
    const auto& map = pattern.set->pieces()[i].map;
    if (map && map->bank().fracture) description.breaks = body.description.breaks;
    piece = std::make_shared<const PieceBody>(PieceBody{std::move(description), std::move(*solid)});
  }
  return pattern;
}

void BreakingBodies::silence(synth::ObjectNumber object) {
  for (auto& [id, entry] : bodies_) {
    for (Pattern& pattern : entry.patterns) pattern.silence(object);
  }
}

void BreakingBodies::set_sample_rate(double sample_rate_hz) {
  if (sample_rate_hz == sample_rate_hz_) return;
  sample_rate_hz_ = sample_rate_hz;
  for (auto& [id, entry] : bodies_) {
    entry.state = *breaking::Breakable::make(entry.state.map(), entry.state.material(), sample_rate_hz, 0);
  }
}

std::optional<double> BreakingBodies::judge(BodyId body, BodyId other, const BodyBlows& blows) {
  const auto found = bodies_.find(body);
  if (found == bodies_.end()) return {};
  Entry& entry = found->second;
  breaking::Breakable& state = entry.state;
  const breaking::Course course = state.course_of(blows.meeting, blows.frame, entry.strength_pa);
  const auto goes_on = [&]() -> std::optional<double> {
    state.follow(course);
    return {};
  };
  Vec3 impulse_ns;
  for (const synth::verb::Strike& strike : blows.strikes) impulse_ns = impulse_ns + strike.impulse_ns;
  const bool by_impulse = entry.breaks.impulse_ns && length(impulse_ns) >= *entry.breaks.impulse_ns;
  if (!by_impulse && !course.strained_s) return goes_on();

  std::size_t bodies_to_come = scene_.store.bodies().size();
  for (const Broken& before : broken_) bodies_to_come += before.entry.patterns[before.pattern].body_count() - 1;
  std::vector<std::size_t> levels = state.levels_at(blows.strikes.front().point_m);
  std::erase_if(
      levels, [&](std::size_t level) { return bodies_to_come - 1 + entry.patterns[level].body_count() > kMaxBodies; });
  if (levels.empty()) {
    if (!std::exchange(entry.crowded, true)) {
      crowded_.push_back("body " + quote(scene_.store.bodies().at(body).description.name) +
                         " stays whole, because the scene has no room for its pieces");
    }
    return goes_on();
  }
  const double factor = entry.breaks.crack_energy_factor / modal::kFractureEnergyFactor;
  const double when_s =
      by_impulse ? std::min(course.hardest_s, course.strained_s.value_or(course.hardest_s)) : *course.strained_s;
  breaking::Breakable::Moment moment = state.moment_of(blows.meeting, blows.frame, when_s);
  const double energy_j = modal::modal_energy(moment.state).total_j();
  const std::size_t level = factor > 0 ? state.affordable(levels, energy_j / factor) : levels.back();
  Pattern& pattern = entry.patterns[level];
  const synth::ObjectNumber object = *scene_.store.bodies().at(body).object;
  breaking::Shattered shattered = state.shatter(*pattern.set, {.blow = blows.strikes.front(),
                                                               .frame = blows.frame,
                                                               .motion = moment.state,
                                                               .crack_energy_j = factor * state.crack_cost_j(level),
                                                               .rest = breaking::RestOfBlow::to_striker,
                                                               .body = object,
                                                               .pieces = pattern.objects});
  const bool at_once = blows.strikes.front().contact_time_s <= 0;  // an ideal impulse
  const double share = at_once || !(blows.pressed_ns > 0) ? 1 : std::min(moment.impulse_ns / blows.pressed_ns, 1.0);
  broken_.push_back({body, other, object, blows.frame, std::move(entry), level, share, std::move(moment.state),
                     std::move(shattered)});
  bodies_.erase(found);
  return share;
}

std::vector<synth::ObjectNumber> BreakingBodies::replace_broken(std::span<const ContactPoint> points,
                                                                std::vector<synth::Event>& events,
                                                                std::vector<std::string>& notices) {
  std::vector<synth::ObjectNumber> gone;
  for (std::string& sentence : std::exchange(crowded_, {})) notices.push_back(std::move(sentence));
  if (broken_.empty()) return gone;
  const std::vector<Broken> all = std::exchange(broken_, {});
  std::set<BodyId> taken_back;
  for (const Broken& broken : all) {
    if (!taken_back.contains(broken.body)) take_back(broken, points, taken_back);
  }
  for (const Broken& broken : all) {
    events.insert(events.end(), broken.shattered.events.begin(), broken.shattered.events.end());
    replace(broken, notices);
    gone.push_back(broken.object);
  }
  return gone;
}

// Takes back what the blow would have done after the peak of its force: from the body, from its striker, and from all
// bodies that touch these in the part. A striker that lies on the floor got its impulse from there.
void BreakingBodies::take_back(const Broken& broken, std::span<const ContactPoint> points, std::set<BodyId>& taken) {
  auto& bodies = scene_.store.bodies();
  const auto moves = [&](BodyId id) {
    const auto found = bodies.find(id);
    return found != bodies.end() && !found->second.description.fixed;
  };
  std::set<BodyId> touching{broken.body};
  for (bool grows = true; grows;) {
    grows = false;
    for (const ContactPoint& point : points) {
      const auto joins = [&](BodyId one, BodyId other) {
        return touching.contains(one) && moves(other) && touching.insert(other).second;
      };
      grows = joins(point.body, point.other) || joins(point.other, point.body) || grows;
    }
  }
  for (const ContactPoint& point : points) {
    const auto change = [&](BodyId id, double way) {
      if (!touching.contains(id)) return;
      Body& body = bodies.at(id);
      push(body.motion, body.mass, point.point_m, (way * (1 - broken.share)) * point.impulse_ns);
    };
    change(point.body, -1);
    change(point.other, 1);
  }
  for (const BodyId id : touching) scene_.simulation.set_motion(id, bodies.at(id).motion);
  taken.insert(touching.begin(), touching.end());
}

void BreakingBodies::replace(const Broken& broken, std::vector<std::string>& notices) {
  const auto found = scene_.store.bodies().find(broken.body);
  if (found == scene_.store.bodies().end()) return;  // it left the scene in the same step
  const Body whole = found->second;
  const Pattern& pattern = broken.entry.patterns[broken.pattern];

  const Matrix3 turn = to_matrix(whole.motion.rotation);
  std::vector<BodyId> siblings;
  std::optional<BodyId> under;
  for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
    if (!pattern.pieces[i]) continue;
    const auto& [description, solid] = *pattern.pieces[i];
    // The rigid motion of the body goes on; that of the state is the blow's alone, and is in the body's already.
    const modal::PieceMotion& moved = broken.shattered.broken.pieces[i];
    const Vec3 arm = solid.mass.center_m - whole.mass.center_m;
    const Vec3 velocity = moved.velocity_m_s - broken.peak.velocity_m_s - cross(broken.peak.spin_rad_s, arm);
    const Vec3 spin = moved.spin_rad_s - broken.peak.spin_rad_s;
    Motion motion = whole.motion;
    motion.position_m = whole.motion.position_m + turn * arm;
    motion.velocity_m_s = whole.motion.velocity_at(motion.position_m) + turn * velocity;
    motion.spin_rad_s = whole.motion.spin_rad_s + turn * spin;
    const BodyId id = scene_.store.add_moving(description, solid, motion);
    scene_.put(id, scene_.store.bodies().at(id), solid);
    siblings.push_back(id);
    if (i == broken.shattered.under) under = id;
    if (pattern.finer[i]) follow_piece(broken, i, id);
  }
  scene_.simulation.keep_from_touching(siblings, broken.body);
  scene_.remove(broken.body);
  if (under) scene_.sounds.pass_on(broken.other, broken.body, *under);
  notices.push_back("body " + quote(whole.description.name) + " broke into " + std::to_string(pattern.pieces.size()) +
                    " pieces");
}

// Lets a piece break again. It rings already.
void BreakingBodies::follow_piece(const Broken& broken, std::size_t piece, BodyId id) {
  const Pattern& pattern = broken.entry.patterns[broken.pattern];
  const auto object = pattern.objects[piece];
  auto state = breaking::Breakable::make(pattern.set->pieces()[piece].map, broken.entry.state.material(),
                                         sample_rate_hz_, broken.frame);
  if (!object || !state) return;
  for (const synth::Event& event : broken.shattered.events) {
    if (event.object == *object) state->follow(event);
  }
  const std::uint64_t number = ((broken.entry.number + 1) << 11U) + piece;
  Entry entry{.state = *state, .breaks = broken.entry.breaks, .number = number, .strength_pa = {}, .patterns = {}};
  entry.strength_pa = strength_of(entry);
  if (!entry.strength_pa && !entry.breaks.impulse_ns) return;
  entry.patterns.push_back(*pattern.finer[piece]);
  bodies_.insert_or_assign(id, std::move(entry));
}

}  // namespace ringdown::scene

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

// The blows of one pair, as a body's vibration receives them: the hardest one, whose force is followed in time, and the
// others, which count as whole blows before it.
struct Blows {
  explicit Blows(std::span<const BodyBlow> blows) : all(blows.begin(), blows.end()) {
    const auto hardness = [](const BodyBlow& blow) { return length(blow.strike.impulse_ns); };
    std::ranges::iter_swap(all.begin(), std::ranges::max_element(all, {}, hardness));
  }
  std::vector<BodyBlow> all;  // the hardest first
  [[nodiscard]] const BodyBlow& hardest() const { return all.front(); }
  void let_follow_others(breaking::Breakable& state) const {
    for (const BodyBlow& blow : std::span(all).subspan(1)) state.follow({.frame = blow.frame, .verb = blow.strike});
  }
};

// The energy that blows have put into the modes of a body at the peak of the hardest one's force.
double energy_of(const Blows& blows, const breaking::Breakable& before) {
  breaking::Breakable after = before, unstruck = before;
  blows.let_follow_others(after);
  modal::ModalState change = after.at_peak(blows.hardest().strike, blows.hardest().frame);
  const modal::ModalState& rest = unstruck.advance_to(blows.hardest().frame);
  for (std::size_t m = 0; m < change.amplitudes.size(); ++m) change.amplitudes[m] -= rest.amplitudes[m];
  return modal::modal_energy(change).total_j();
}

// Hertz's contact time is that of bodies which give way at the contact only. A body that bends there is touched for
// longer, or the blow would give its modes more energy than the approach has. Contact times are therefore made as much
// longer as that energy asks for. For one mode that is much faster than the blow this is the time in which the
// mode's stiffness turns the striker back.
Blows with_bending(const Blows& blows, const breaking::Breakable& before) {
  constexpr double kShortest_s = 1e-5, kMaxFactor = 1e4;
  double available_j = 0;
  for (const BodyBlow& blow : blows.all) available_j += blow.energy_j;
  const auto lengthened = [&](double factor) {
    Blows longer = blows;
    for (BodyBlow& blow : longer.all)
      blow.strike.contact_time_s = factor * std::max(blow.strike.contact_time_s, kShortest_s);
    return longer;
  };
  if (energy_of(blows, before) <= available_j) return blows;
  double low = 1, high = kMaxFactor;
  while (high > 1.02 * low) {
    const double factor = std::sqrt(low * high);
    (energy_of(lengthened(factor), before) > available_j ? low : high) = factor;
  }
  return lengthened(high);
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
  return static_cast<std::size_t>(std::ranges::count_if(pieces, [](const auto& piece) { return piece.has_value(); }));
}

BreakingBodies::BreakingBodies(SceneBodies& bodies, std::uint64_t seed, double sample_rate_hz)
    : scene_(bodies), seed_(seed), sample_rate_hz_(sample_rate_hz) {
  scene_.sounds.judge_by(
      [this](BodyId body, BodyId other, std::span<const BodyBlow> blows) { return judge(body, other, blows); });
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
  Entry entry{.state = *state, .breaks = *body.description.breaks, .strength_pa = {}, .patterns = {}};
  if (!fracture.stress.positions.empty()) {
    entry.strength_pa = entry.breaks.strength_pa;
    if (!entry.strength_pa && fracture.strength && fracture.skin_m2 > 0)
      entry.strength_pa =
          modal::drawn_strength_pa(*fracture.strength, scale.size * scale.size * fracture.skin_m2, seed_, id);
  } else if (entry.breaks.strength_pa) {
    return refuse("its bank does not know the stress of its modes; bake it again, or give impulse_ns");
  }
  if (!entry.strength_pa && !entry.breaks.impulse_ns) {
    return refuse(
        "its bank knows no strength; give breaks an impulse_ns, or bake it of a material that has a strength");
  }
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    auto pattern = pattern_of(body, object, *state, p);
    if (!pattern) return refuse(pattern.error().message);
    entry.patterns.push_back(std::move(*pattern));
  }
  bodies_.insert_or_assign(id, std::move(entry));
  return {};
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
    if (mass.mass_kg < std::max(body.description.breaks->min_mass_kg, range::kMass_kg.low)) continue;
    BodyDescription description =
        piece_description(body.description, fracture.patterns[number].pieces[i].bank, state.material(), mass);
    description.name = piece_name(body.description.name, fracture, number, i);
    if (sounds) description.object = sounds->name;
    Result<Solid> solid = make_solid(description, nullptr);
    if (!solid) return fail(solid.error().kind, "its piece " + std::to_string(i) + ": " + solid.error().message);
    piece = {std::move(description), std::move(*solid)};
  }
  return pattern;
}

void BreakingBodies::silence(synth::ObjectNumber object) {
  for (auto& [id, entry] : bodies_) {
    for (Pattern& pattern : entry.patterns) std::ranges::replace(pattern.objects, std::optional(object), std::nullopt);
  }
}

void BreakingBodies::set_sample_rate(double sample_rate_hz) {
  if (sample_rate_hz == sample_rate_hz_) return;
  sample_rate_hz_ = sample_rate_hz;
  for (auto& [id, entry] : bodies_) {
    entry.state = *breaking::Breakable::make(entry.state.map(), entry.state.material(), sample_rate_hz, 0);
  }
}

bool BreakingBodies::judge(BodyId body, BodyId other, std::span<const BodyBlow> blows) {
  const auto found = bodies_.find(body);
  if (found == bodies_.end()) return false;
  Entry& entry = found->second;
  const Blows limited = with_bending(Blows(blows), entry.state);
  const BodyBlow& hardest = limited.hardest();
  breaking::Breakable state = entry.state;
  limited.let_follow_others(state);
  Vec3 impulse_ns;
  for (const BodyBlow& blow : blows) impulse_ns = impulse_ns + blow.strike.impulse_ns;
  const bool breaks = (entry.breaks.impulse_ns && length(impulse_ns) >= *entry.breaks.impulse_ns) ||
                      (entry.strength_pa && state.exceeds(hardest.strike, hardest.frame, *entry.strength_pa));
  const auto goes_on = [&] {
    for (const BodyBlow& blow : blows) entry.state.follow({.frame = blow.frame, .verb = blow.strike});
    return false;
  };
  if (!breaks) return goes_on();

  std::size_t bodies_to_come = scene_.store.bodies().size();
  for (const Broken& before : broken_) bodies_to_come += before.entry.patterns[before.pattern].body_count() - 1;
  std::vector<std::size_t> levels = state.levels_at(hardest.strike.point_m);
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
  modal::ModalState peak = state.at_peak(hardest.strike, hardest.frame);
  const double energy_j = modal::modal_energy(peak).total_j();
  const std::size_t level = factor > 0 ? state.affordable(levels, energy_j / factor) : levels.back();
  Pattern& pattern = entry.patterns[level];
  const synth::ObjectNumber object = *scene_.store.bodies().at(body).object;
  breaking::Shattered shattered = state.shatter(*pattern.set, {.blow = hardest.strike,
                                                               .frame = hardest.frame,
                                                               .crack_energy_j = factor * state.crack_cost_j(level),
                                                               .rest = breaking::RestOfBlow::to_striker,
                                                               .body = object,
                                                               .pieces = pattern.objects});
  const double share = share_until_peak(blows.front().strike.contact_time_s);
  broken_.push_back({body, other, std::move(entry), level, share, std::move(peak), std::move(shattered)});
  bodies_.erase(found);
  return true;
}

std::vector<BodyId> BreakingBodies::replace_broken(std::span<const ContactPoint> points,
                                                   std::vector<synth::Event>& events,
                                                   std::vector<std::string>& notices) {
  std::vector<BodyId> gone;
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
    gone.push_back(broken.body);
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
  scene_.remove(broken.body);

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
  }
  scene_.simulation.keep_from_touching(siblings);
  if (under) scene_.sounds.pass_on(broken.other, broken.body, *under);
  notices.push_back("body " + quote(whole.description.name) + " broke into " + std::to_string(pattern.pieces.size()) +
                    " pieces");
}

}  // namespace ringdown::scene

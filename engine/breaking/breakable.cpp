#include "engine/breaking/breakable.h"

#include "engine/modal/damping.h"
#include "engine/modal/fracture/peak_stress.h"
#include "engine/modal/fracture/strength.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

namespace ringdown::breaking {
namespace {

using synth::Event;
using synth::Frame;
using synth::verb::Strike;

// Points as near to a blow do not count for strength. A point force has no finite stress under itself; from 3 cm on,
// the stress of a glass pane converges with the modes below 20 kHz. Points that stand for a line of contact act as that
// line from one spacing on, where stress does converge.
constexpr double kSparedRadius_m = 0.03;

// Velocities [J^1/2] that an impulse gives the modes of a bank in a material.
std::vector<double> modal_impulse(const modal::StrikeMap& map, const modal::MaterialScale& material,
                                  const Vec3& point_m, const Vec3& impulse_ns) {
  std::vector<double> impulses(map.bank().mode_count());
  map.excite((1 / material.size) * point_m, impulse_ns, impulses);
  for (double& impulse : impulses) impulse *= modal::shape_factor(material);
  return impulses;
}

bool is_solid(const std::optional<modal::MassProperties>& mass) {
  const Vec3 inertia = mass ? mass->inertia_kg_m2 : Vec3();
  return mass && mass->mass_kg > 0 && inertia.x > 0 && inertia.y > 0 && inertia.z > 0;
}

modal::Blow blow_of(const Strike& strike, std::span<const double> impulse) {
  return {impulse, strike.point_m, strike.impulse_ns, strike.contact_time_s};
}

}  // namespace

Breakable::Breakable(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material,
                     double sample_rate_hz, Frame present, modal::ModalState state)
    : map_(std::move(map)),
      material_(material),
      rate_hz_(sample_rate_hz),
      present_(present),
      state_(std::move(state)) {}

Result<void> Breakable::check(const modal::Bank& bank) {
  if (bank.fracture && is_solid(bank.mass)) return {};
  return fail(ErrorKind::bad_input, "its bank has no pieces; bake it with [shatter] in its object file");
}

Result<Breakable> Breakable::make(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material,
                                  double sample_rate_hz, Frame present) {
  const modal::Bank& bank = map->bank();
  if (auto good = check(bank); !good) return fail(good);
  std::vector<modal::DampedMode> modes = modes_of(bank, material);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (modes[m].frequency_hz == 0 && bank.frequency_hz[m] > 0)
      return fail(ErrorKind::refused, "in its material, some of its modes do not ring");
  }
  modal::ModalState state = modal::at_rest(std::move(modes), rescale(*bank.mass, material));
  return Breakable(std::move(map), material, sample_rate_hz, present, std::move(state));
}

// Adds an event to a state of the body.
struct Breakable::Excited {
  Breakable& body;
  modal::ModalState& state;

  void add(const std::vector<double>& impulse, double contact_time_s) const {
    add_blow(state, {.modal_impulse = impulse, .contact_time_s = contact_time_s});
  }
  void operator()(const Strike& strike) const {
    add(modal_impulse(*body.map_, body.material_, strike.point_m, strike.impulse_ns), strike.contact_time_s);
  }
  void operator()(const synth::verb::StrikeVertex& strike) const {
    if (strike.vertex >= body.map_->bank().point_count()) return;
    std::vector<double> impulse(body.map_->bank().mode_count());
    body.map_->excite_vertex(strike.vertex, strike.impulse_ns, impulse);
    for (double& one : impulse) one *= modal::shape_factor(body.material_);
    add(impulse, strike.contact_time_s);
  }
  void operator()(const synth::verb::Impart& impart) const {
    const auto& by_frequency = body.map_->by_frequency();
    if (impart.mode >= by_frequency.size()) return;
    const std::size_t m = by_frequency[impart.mode];
    const double omega = modal::hz_to_rad_per_s(state.modes[m].frequency_hz);
    state.amplitudes[m] += std::polar(impart.velocity / omega, impart.phase_rad - 0.5 * std::numbers::pi);
  }
  void operator()(const synth::verb::Pose& pose) const { body.pose_ = pose; }
  void operator()(const synth::verb::Choke&) const { end(); }
  void operator()(const synth::verb::Clear&) const { end(); }
  void operator()(const auto&) const {}

 private:
  void end() const { std::ranges::fill(state.amplitudes, 0.0); }
};

void Breakable::follow(const Event& event) {
  if (event.frame >= present_) {
    advance_to(event.frame);
    return visit(Excited{*this, state_}, event.verb);
  }
  // An event that another one of a later frame has overtaken is moved on, because a state that is moved back grows
  // without bound where modes decay fast.
  modal::ModalState late = modal::at_rest(state_.modes, state_.mass);
  visit(Excited{*this, late}, event.verb);
  advance(late, seconds(present_ - event.frame));
  for (std::size_t m = 0; m < late.amplitudes.size(); ++m) state_.amplitudes[m] += late.amplitudes[m];
}

const modal::ModalState& Breakable::advance_to(Frame frame) {
  if (frame > present_) {
    advance(state_, seconds(frame - present_));
    present_ = frame;
  }
  state_.velocity_m_s = state_.spin_rad_s = {};
  return state_;
}

modal::ModalState Breakable::at_peak(const Strike& blow, Frame frame) {
  modal::ModalState state = advance_to(frame);
  const std::vector<double> impulse = modal_impulse(*map_, material_, blow.point_m, blow.impulse_ns);
  add_begun_blow(state, blow_of(blow, impulse), 0.5 * blow.contact_time_s);
  return state;
}

Course Breakable::course_of(const Meeting& meeting, Frame frame, std::optional<double> strength_pa) {
  constexpr double kAfter_s = 3e-3, kSpacing_s = 1e-5;
  Collision collision(*map_, material_, advance_to(frame), meeting);
  const modal::StressTable& baked = fracture().stress;
  const bool searches = strength_pa && knows_stress();
  const double limit_pa = searches ? *strength_pa / modal::stress_factor(material_) : 0;
  modal::MotionSamples samples;
  // Keeps an instant if the bound on the stress at that instant reaches the limit.
  const auto sample = [&](const modal::ModalState& state, double time_s) {
    double bound_pa = 0;
    for (std::size_t m = 0; m < state.amplitudes.size(); ++m)
      bound_pa += std::abs(state.amplitudes[m].real()) * static_cast<double>(baked.largest[m]);
    if (bound_pa < limit_pa) return;
    samples.times_s.push_back(time_s);
    for (const std::complex<double>& a : state.amplitudes) samples.coordinates.push_back(static_cast<float>(a.real()));
  };
  Course course;
  double largest_n = 0, sampled_s = 0;
  while (!collision.is_over()) {
    collision.step();
    if (collision.force_n() > largest_n) {
      largest_n = collision.force_n();
      course.hardest_s = collision.time_s();
    }
    if (!searches || collision.time_s() < sampled_s + kSpacing_s) continue;
    sampled_s = collision.time_s();
    sample(collision.state(), sampled_s);
  }
  course.impulse_ns = collision.impulse_ns();
  course.end_s = collision.time_s();
  course.end = collision.state();
  if (!searches) return course;
  modal::ModalState after = course.end;
  if (modal::stress_bound_pa(baked, after, nullptr) >= limit_pa) {
    for (double time_s = course.end_s + kSpacing_s; time_s < course.end_s + kAfter_s; time_s += kSpacing_s) {
      advance(after, kSpacing_s);
      sample(after, time_s);
    }
  }
  std::vector<Vec3> spared_m;
  for (const MeetingPoint& point : meeting.points) spared_m.push_back((1 / material_.size) * point.point_m);
  const double spared = meeting.spacing_m > 0 ? std::min(meeting.spacing_m, kSparedRadius_m) : kSparedRadius_m;
  if (const auto strained = modal::first_reaching(baked, samples, limit_pa, spared_m, spared / material_.size)) {
    course.strained_s = strained->time_s;
  }
  return course;
}

Breakable::Moment Breakable::moment_of(const Meeting& meeting, Frame frame, double time_s) {
  Collision collision(*map_, material_, advance_to(frame), meeting);
  while (!collision.is_over() && collision.time_s() < time_s) collision.step();
  Moment moment{collision.state(), collision.impulse_ns()};
  if (time_s > collision.time_s()) advance(moment.state, time_s - collision.time_s());
  return moment;
}

void Breakable::follow(const Course& course) {
  const auto lasting = static_cast<Frame>(std::ceil(course.end_s * rate_hz_));
  state_ = course.end;
  advance(state_, seconds(lasting) - course.end_s);
  present_ += lasting;
}

double Breakable::stress_pa(const Strike& blow, Frame frame, double above_pa) {
  if (!knows_stress()) return 0;
  const modal::StressTable& baked = fracture().stress;
  const double factor = modal::stress_factor(material_);
  const std::vector<double> impulse = modal_impulse(*map_, material_, blow.point_m, blow.impulse_ns);
  const modal::Blow whole = blow_of(blow, impulse);
  // The force begins half of its duration before `frame`.
  const auto begin = frame - static_cast<Frame>(std::llround(0.5 * blow.contact_time_s * rate_hz_));
  const modal::ModalState& state = advance_to(begin);
  const double bound_pa = factor * modal::stress_bound_pa(baked, state, &whole);
  if (bound_pa < above_pa) return bound_pa;
  const modal::StressSearch search{.spared_m = (1 / material_.size) * blow.point_m,
                                   .spared_radius_m = kSparedRadius_m / material_.size};
  return factor * modal::peak_stress(baked, state, &whole, search).stress_pa;
}

std::vector<std::size_t> Breakable::levels_at(const Vec3& point_m) const {
  const std::vector<modal::BreakPattern>& patterns = fracture().patterns;
  const Vec3 baked_m = (1 / material_.size) * point_m;
  const auto distance = [&](const modal::BreakPattern& pattern) { return length(pattern.at_m - baked_m); };
  const Vec3 at_m = std::ranges::min_element(patterns, {}, distance)->at_m;
  std::vector<std::size_t> levels;
  for (std::size_t p = 0; p < patterns.size(); ++p) {
    if (patterns[p].at_m == at_m) levels.push_back(p);
  }
  return levels;
}

std::size_t Breakable::affordable(std::span<const std::size_t> levels, double available_j) const {
  assert(!levels.empty());
  std::vector<double> areas_m2;
  for (const std::size_t pattern : levels)
    areas_m2.push_back(material_.size * material_.size * fracture().patterns[pattern].crack_area_m2);
  return levels[modal::finest_affordable(areas_m2, fracture().crack_energy_j_m2, available_j).value_or(0)];
}

double Breakable::crack_cost_j(std::size_t pattern) const {
  return modal::crack_cost_j(material_.size * material_.size * fracture().patterns[pattern].crack_area_m2,
                             fracture().crack_energy_j_m2);
}

Shattered Breakable::shatter(const PieceSet& pieces, const Break& breaks) {
  assert(breaks.pieces.size() == pieces.pieces().size());
  const modal::ModalState state = breaks.motion ? *breaks.motion : at_peak(breaks.blow, breaks.frame);
  const double paid_j = std::min(breaks.crack_energy_j, kMaxCrackShare * modal::modal_energy(state).total_j());
  Shattered shattered{
      .broken = pieces.breaking()(state, paid_j), .under = pieces.nearest(breaks.blow.point_m), .events = {}};
  for (std::size_t i = 0; i < breaks.pieces.size(); ++i) {
    if (!breaks.pieces[i]) continue;
    append_piece(pieces.pieces()[i], shattered.broken.pieces[i], i == shattered.under, breaks, *breaks.pieces[i],
                 shattered.events);
  }
  shattered.events.push_back({breaks.frame, breaks.body, synth::verb::Choke{pieces.breaking().crack_time_s()}});
  return shattered;
}

// Appends the events that set a piece going, at the first frame after the crack has reached it.
void Breakable::append_piece(const BodyPiece& piece, const modal::PieceMotion& motion, bool under, const Break& breaks,
                             synth::ObjectNumber number, std::vector<Event>& events) const {
  if (!piece.map || piece.modes.size() != piece.map->bank().mode_count()) return;
  const Frame begin = breaks.frame + static_cast<Frame>(std::ceil(piece.delay_s * rate_hz_));
  modal::ModalState state = modal::at_rest(piece.modes, piece.mass);
  if (under && breaks.rest == RestOfBlow::to_piece) {
    const Strike& blow = breaks.blow;
    const std::vector<double> impulse = modal_impulse(*piece.map, material_, blow.point_m, blow.impulse_ns);
    add_rest_of_blow(state, blow_of(blow, impulse), 0.5 * blow.contact_time_s);
    advance(state, piece.delay_s);
  }
  for (std::size_t m = 0; m < state.modes.size(); ++m) state.amplitudes[m] += motion.amplitudes[m];
  advance(state, seconds(begin - breaks.frame) - piece.delay_s);
  if (pose_) events.push_back({begin, number, *pose_});
  for (std::uint32_t m = 0; m < state.modes.size(); ++m) {
    const double omega = modal::hz_to_rad_per_s(state.modes[m].frequency_hz);
    events.push_back({begin, number,
                      synth::verb::Impart{piece.map->rank(m), omega * std::abs(state.amplitudes[m]),
                                          std::arg(state.amplitudes[m]) + 0.5 * std::numbers::pi}});
  }
}

}  // namespace ringdown::breaking

#include "server/session/breakage.h"

#include "engine/modal/scaled_bank.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace ringdown::session {
namespace {

using protocol::ObjectRef;
using synth::Event;
using synth::Frame;

constexpr double kCrackSpeed_m_s = 1500;  // of fast cracks in glass, about half of the speed of Rayleigh waves

std::vector<modal::DampedMode> modes_of(const modal::Bank& bank) {
  std::vector<modal::DampedMode> modes(bank.mode_count());
  for (std::size_t m = 0; m < modes.size(); ++m) modes[m] = {bank.frequency_hz[m], bank.decay_per_s[m]};
  return modes;
}

std::shared_ptr<const modal::Breaking> breaking_of(const modal::Bank& body, const modal::BreakPattern& pattern) {
  std::vector<modal::Piece> pieces;
  double crack_m = 0;
  for (const modal::PieceBank& piece : pattern.pieces) {
    const std::size_t rows = modal::kRigidMotions + piece.bank.mode_count();
    pieces.push_back({.mass = *piece.bank.mass,
                      .modes = modes_of(piece.bank),
                      .handover = {rows, piece.handover.size() / rows, piece.handover},
                      .delay_s = piece.near_m / kCrackSpeed_m_s});
    crack_m += (piece.far_m - piece.near_m) / static_cast<double>(pattern.pieces.size());
  }
  return std::make_shared<const modal::Breaking>(modes_of(body), *body.mass, pieces, crack_m / kCrackSpeed_m_s);
}

std::size_t nearest_pattern(const modal::Fracture& fracture, const Vec3& point_m) {
  const auto distance = [&](const modal::BreakPattern& pattern) { return length(pattern.at_m - point_m); };
  // Of patterns of one place, the last has most pieces.
  std::size_t best = 0;
  for (std::size_t p = 1; p < fracture.patterns.size(); ++p) {
    if (distance(fracture.patterns[p]) <= distance(fracture.patterns[best])) best = p;
  }
  return best;
}

double distance_to(const modal::Bank& bank, const Vec3& point_m) {
  double least = HUGE_VAL;
  for (const modal::Vec3f& p : bank.positions) least = std::min(least, length(Vec3{p[0], p[1], p[2]} - point_m));
  return least;
}

// Velocities [J^1/2] that an impulse gives the modes of an object's bank in its material.
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

tl::unexpected<Error> refuse(const std::string& sentence) { return fail(ErrorKind::refused, sentence); }

tl::unexpected<Error> cannot_break(const std::string& name) {
  return fail(ErrorKind::bad_input,
              "\"" + name + "\" cannot break: its bank has no pieces; bake it with [shatter] in its object file");
}

}  // namespace

Result<std::size_t> Breakage::arm(const ObjectRef& ref, std::optional<std::size_t> pattern,
                                  const std::optional<Vec3>& point_m) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found.error());
  const ObjectState& object = **found;
  const modal::Bank& bank = object.map->bank();
  if (!bank.fracture || !is_solid(bank.mass)) return cannot_break(object.name);
  const modal::Bank body = object.material == modal::MaterialScale() ? bank : modal::scaled(bank, object.material);
  if (body.mode_count() < bank.mode_count())
    return refuse("\"" + object.name + "\" cannot break in this material, in which some of its modes do not ring");
  const std::size_t chosen =
      pattern ? *pattern : nearest_pattern(*body.fracture, point_m.value_or(body.fracture->patterns[0].at_m));
  if (chosen >= body.fracture->patterns.size()) {
    return fail(ErrorKind::bad_input, "there is no pattern " + std::to_string(chosen) + ": \"" + object.name +
                                          "\" has " + std::to_string(body.fracture->patterns.size()) +
                                          ", which are numbered from 0");
  }
  std::optional<Armed> former;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(object.number);
    if (known != armed_.end()) {
      if (known->second.broken) return refuse("\"" + object.name + "\" is broken; /object/" + object.name + "/mend it");
      if (known->second.pattern == chosen) return known->second.pieces.size();
      former = std::move(known->second);
      armed_.erase(known);
    }
  }
  if (former) free_pieces(*former);

  const modal::BreakPattern& whole = bank.fracture->patterns[chosen];
  const modal::BreakPattern& scaled = body.fracture->patterns[chosen];
  Armed armed{.name = object.name,
              .map = object.map,
              .material = object.material,
              .pattern = chosen,
              .breaking = breaking_of(body, scaled),
              .state = modal::at_rest(modes_of(body), *body.mass),
              .present = rack_.mixer().counters().frames.load(std::memory_order_relaxed)};
  for (std::size_t i = 0; i < whole.pieces.size(); ++i) {
    PieceReport& piece = armed.pieces.emplace_back();
    piece.name = object.name + "." + std::to_string(i);
    piece.mass = *scaled.pieces[i].bank.mass;
    if (whole.pieces[i].bank.mode_count() == 0) continue;
    const auto loaded = [&]() -> Result<synth::ObjectNumber> {
      if (rack_.find({.name = piece.name})) return refuse("an object \"" + piece.name + "\" exists already");
      modal::Bank own = whole.pieces[i].bank;
      own.gain = bank.gain;
      const modal::BankPath path{modal::split_bank_path(object.bank).file, {whole.pieces[i].model}};
      auto number = rack_.add(
          piece.name, modal::bank_path(path),
          {.map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(own))),
           .bytes = object.bank_bytes,
           .content = object.bank_content});
      if (!number) return number;
      piece.number = *number;
      if (object.material != modal::MaterialScale()) {
        if (auto set = rack_.set_material({.number = *number}, object.material); !set) return fail(set.error());
      }
      if (!object.group.empty()) {
        if (auto set = rack_.set_group({.number = *number}, object.group); !set) return fail(set.error());
      }
      return number;
    }();
    if (loaded) continue;
    free_pieces(armed);
    return fail(loaded.error().kind, "\"" + object.name + "\" cannot break: " + loaded.error().message);
  }
  const std::size_t count = armed.pieces.size();
  const std::scoped_lock lock(mutex_);
  armed_.insert_or_assign(object.number, std::move(armed));
  return count;
}

void Breakage::free_pieces(const Armed& armed) {
  for (const PieceReport& piece : armed.pieces) {
    if (piece.number) static_cast<void>(rack_.free({.number = *piece.number}));
  }
}

Result<void> Breakage::check(const protocol::BreakObject& request) const {
  const auto found = rack_.find(request.object);
  if (!found) return fail(found.error());
  const ObjectState& object = **found;
  if (!object.map->bank().fracture || !is_solid(object.map->bank().mass)) return cannot_break(object.name);
  if (auto whole = check_whole(object.number); !whole) return whole;
  return check_point(request.point_m, object);
}

Result<std::size_t> Breakage::break_object(const protocol::BreakObject& request, Frame frame) {
  if (auto good = check(request); !good) return fail(good.error());
  const std::optional<std::size_t> pattern =
      request.pattern < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(request.pattern));
  const synth::ObjectNumber number = (*rack_.find(request.object))->number;
  const bool is_armed = [&] {
    const std::scoped_lock lock(mutex_);
    return armed_.contains(number) && !pattern;
  }();
  if (!is_armed) {
    if (auto armed = arm({.number = number}, pattern, request.point_m); !armed) return armed;
  }
  rack_.observers().report_events();
  std::vector<Event> events;
  std::size_t count = 0;
  {
    const std::scoped_lock lock(mutex_);
    Armed& armed = armed_.at(number);
    const double half_s = 0.5 * request.contact_time_s;
    const modal::Blow blow{.modal_impulse = {},
                           .point_m = request.point_m,
                           .impulse_ns = request.impulse_ns,
                           .contact_time_s = request.contact_time_s};
    advance_to(armed, frame);
    armed.state.velocity_m_s = armed.state.spin_rad_s = {};
    const std::vector<double> impulse = modal_impulse(*armed.map, armed.material, blow.point_m, blow.impulse_ns);
    modal::Blow on_body = blow;
    on_body.modal_impulse = impulse;
    add_begun_blow(armed.state, on_body, half_s);
    const modal::Broken broken = (*armed.breaking)(armed.state, 0);
    for (std::size_t i = 0; i < armed.pieces.size(); ++i) {
      armed.pieces[i].velocity_m_s = broken.pieces[i].velocity_m_s;
      armed.pieces[i].spin_rad_s = broken.pieces[i].spin_rad_s;
    }
    events = pieces_events(armed, broken, request, frame);
    events.push_back({frame, number, synth::verb::Choke{armed.breaking->crack_time_s()}});
    armed.broken = true;
    ++broken_;
    count = armed.pieces.size();
  }
  std::size_t lost = 0;
  for (const Event& event : events) lost += rack_.push(synth::Producer::worker, event) ? 0 : 1;
  if (lost > 0) rack_.warn(std::to_string(lost) + " modes of pieces were lost, because too many events were waiting");
  return count;
}

// The events that set the pieces going: the motion from the body, the rest of the blow for the nearest piece, and how
// the body was heard.
std::vector<Event> Breakage::pieces_events(const Armed& armed, const modal::Broken& broken,
                                           const protocol::BreakObject& request, Frame frame) const {
  const modal::BreakPattern& pattern = armed.map->bank().fracture->patterns[armed.pattern];
  const Vec3 point_m = (1 / armed.material.size) * request.point_m;
  const auto distance = [&](const modal::PieceBank& piece) { return distance_to(piece.bank, point_m); };
  const auto under = std::ranges::min_element(pattern.pieces, {}, distance) - pattern.pieces.begin();
  const auto body = rack_.find({.name = armed.name});
  const double rate_hz = rack_.mixer().sample_rate_hz(), half_s = 0.5 * request.contact_time_s;
  std::vector<Event> events;
  for (std::size_t i = 0; i < armed.pieces.size(); ++i) {
    if (!armed.pieces[i].number) continue;
    const auto piece = rack_.find({.number = armed.pieces[i].number});
    if (!piece) continue;  // somebody freed it
    const synth::ObjectNumber number = (*piece)->number;
    const modal::StrikeMap& map = *(*piece)->map;
    const double after_s = pattern.pieces[i].near_m * armed.material.size / kCrackSpeed_m_s;
    const Frame begin = frame + static_cast<Frame>(std::ceil(after_s * rate_hz));
    modal::ModalState state = modal::at_rest(modes_of(modal::scaled(map.bank(), armed.material)), armed.pieces[i].mass);
    if (state.modes.size() != map.bank().mode_count()) continue;
    if (static_cast<std::ptrdiff_t>(i) == under) {
      const std::vector<double> impulse = modal_impulse(map, armed.material, request.point_m, request.impulse_ns);
      add_rest_of_blow(state, {impulse, request.point_m, request.impulse_ns, request.contact_time_s}, half_s);
      advance(state, after_s);
    }
    for (std::size_t m = 0; m < state.modes.size(); ++m) state.amplitudes[m] += broken.pieces[i].amplitudes[m];
    advance(state, seconds(begin - frame) - after_s);
    if (body && (*body)->gain != 1) events.push_back({begin, number, synth::verb::Gain{(*body)->gain}});
    if (body && (*body)->pan != 0) events.push_back({begin, number, synth::verb::Pan{(*body)->pan}});
    if (armed.pose) events.push_back({begin, number, *armed.pose});
    for (std::uint32_t m = 0; m < state.modes.size(); ++m) {
      const double omega = modal::hz_to_rad_per_s(state.modes[m].frequency_hz);
      events.push_back({begin, number,
                        synth::verb::Impart{map.rank(m), omega * std::abs(state.amplitudes[m]),
                                            std::arg(state.amplitudes[m]) + 0.5 * std::numbers::pi}});
    }
  }
  return events;
}

Result<void> Breakage::mend(const ObjectRef& ref) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found.error());
  std::optional<Armed> armed;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find((*found)->number);
    if (known == armed_.end())
      return fail(ErrorKind::bad_input, "\"" + (*found)->name + "\" is whole, and has no pieces to free");
    armed = std::move(known->second);
    armed_.erase(known);
    if (armed->broken) --broken_;
  }
  free_pieces(*armed);
  return {};
}

Result<Breakage::Report> Breakage::report(const ObjectRef& ref) const {
  const auto found = rack_.find(ref);
  if (!found) return fail(found.error());
  const auto& fracture = (*found)->map->bank().fracture;
  if (!fracture) return cannot_break((*found)->name);
  Report report{.patterns = fracture->patterns.size()};
  const std::scoped_lock lock(mutex_);
  if (const auto known = armed_.find((*found)->number); known != armed_.end()) {
    report.pattern = known->second.pattern;
    report.broken = known->second.broken;
    report.pieces = known->second.pieces;
  }
  return report;
}

bool Breakage::is_piece(synth::ObjectNumber object) const {
  const std::scoped_lock lock(mutex_);
  return std::ranges::any_of(armed_, [object](const auto& known) {
    return std::ranges::any_of(known.second.pieces, [object](const PieceReport& p) { return p.number == object; });
  });
}

Result<void> Breakage::check_whole(synth::ObjectNumber object) const {
  if (broken_ == 0) return {};
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find(object);
  if (known == armed_.end() || !known->second.broken) return {};
  const std::string& name = known->second.name;
  return refuse("\"" + name + "\" is broken; strike its pieces, " + name + ".0 and so on, or /object/" + name +
                "/mend it");
}

void Breakage::advance_to(Armed& armed, Frame frame) const {
  if (frame <= armed.present) return;
  advance(armed.state, seconds(frame - armed.present));
  armed.present = frame;
}

// Adds an event to a state of an armed object.
struct Breakage::Excited {
  Armed& armed;
  modal::ModalState& state;

  void add(const std::vector<double>& impulse, double contact_time_s) const {
    add_blow(state, {.modal_impulse = impulse, .contact_time_s = contact_time_s});
  }
  void operator()(const synth::verb::Strike& strike) const {
    add(modal_impulse(*armed.map, armed.material, strike.point_m, strike.impulse_ns), strike.contact_time_s);
  }
  void operator()(const synth::verb::StrikeVertex& strike) const {
    if (strike.vertex >= armed.map->bank().point_count()) return;
    std::vector<double> impulse(armed.map->bank().mode_count());
    armed.map->excite_vertex(strike.vertex, strike.impulse_ns, impulse);
    for (double& one : impulse) one *= modal::shape_factor(armed.material);
    add(impulse, strike.contact_time_s);
  }
  void operator()(const synth::verb::Impart& impart) const {
    const auto& by_frequency = armed.map->by_frequency();
    if (impart.mode >= by_frequency.size()) return;
    const std::size_t m = by_frequency[impart.mode];
    const double omega = modal::hz_to_rad_per_s(state.modes[m].frequency_hz);
    state.amplitudes[m] += std::polar(impart.velocity / omega, impart.phase_rad - 0.5 * std::numbers::pi);
  }
  void operator()(const synth::verb::Pose& pose) const { armed.pose = pose; }
  void operator()(const synth::verb::Choke&) const { end(); }
  void operator()(const synth::verb::Clear&) const { end(); }
  void operator()(const auto&) const {}

 private:
  void end() const { std::ranges::fill(state.amplitudes, 0.0); }
};

void Breakage::played(const Event& event) {
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find(event.object);
  if (known == armed_.end() || known->second.broken || is_of_listener(event)) return;
  Armed& armed = known->second;
  if (event.frame >= armed.present) {
    advance_to(armed, event.frame);
    return visit(Excited{armed, armed.state}, event.verb);
  }
  // An event that another one of a later frame has overtaken is moved on, because a state that is moved back grows
  // without bound where modes decay fast.
  modal::ModalState late = modal::at_rest(armed.state.modes, armed.state.mass);
  visit(Excited{armed, late}, event.verb);
  advance(late, seconds(armed.present - event.frame));
  for (std::size_t m = 0; m < late.amplitudes.size(); ++m) armed.state.amplitudes[m] += late.amplitudes[m];
}

// An object with another bank, material or name is armed anew when it breaks.
void Breakage::changed(const ObjectState* before, const ObjectState* after, Frame /*at*/) {
  if (!before) return;
  std::optional<Armed> gone;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(before->number);
    if (known == armed_.end()) return;
    if (after && after->map == known->second.map && after->material == known->second.material) return;
    if (after && known->second.broken && after->map == known->second.map) return;
    gone = std::move(known->second);
    armed_.erase(known);
    if (gone->broken) --broken_;
  }
  free_pieces(*gone);
}

}  // namespace ringdown::session

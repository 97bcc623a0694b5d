#include "server/session/breakage.h"

#include "engine/modal/fracture/modal_state.h"
#include "engine/modal/material_scale.h"
#include "engine/synth/events/verbs.h"

#include <algorithm>
#include <utility>

namespace ringdown::session {
namespace {

using breaking::Breakable;
using breaking::PieceSet;
using protocol::ObjectRef;
using synth::Event;
using synth::Frame;
using synth::verb::Strike;

tl::unexpected<Error> refuse(const std::string& sentence) { return fail(ErrorKind::refused, sentence); }

tl::unexpected<Error> cannot_break(const std::string& name, const Error& why) {
  return fail(why.kind, "\"{}\" cannot break: {}", name, why.message);
}

tl::unexpected<Error> is_broken(const std::string& name) { return refuse("\"" + name + "\" is broken; mend it first"); }

Result<void> check_pattern(const ObjectState& object, std::size_t pattern) {
  const std::size_t patterns = object.map->bank().fracture->patterns.size();
  if (pattern < patterns) return {};
  return fail(ErrorKind::bad_input, "there is no pattern {}: \"{}\" has {}, which are numbered from 0", pattern,
              object.name, patterns);
}

std::string piece_name(const ObjectState& object, std::size_t piece) { return formatted("{}.{}", object.name, piece); }

Strike blow_of(const protocol::BreakObject& request) {
  return {request.point_m, request.impulse_ns, request.contact_time_s};
}

}  // namespace

Result<std::size_t> Breakage::arm(const ObjectRef& ref, std::optional<std::size_t> pattern) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found);
  const ObjectState& object = **found;
  if (auto followed = follow(object); !followed) return fail(followed);
  return load_pieces(
      object, pattern ? *pattern : [&] {
        const std::scoped_lock lock(mutex_);
        const Breakable& body = armed_.at(object.number).body;
        return body.levels_at(object.material.size * body.fracture().patterns[0].at_m).back();
      }());
}

// Begins to follow an object's motion, unless it is followed already.
Result<void> Breakage::follow(const ObjectState& object) {
  const std::scoped_lock lock(mutex_);
  if (const auto known = armed_.find(object.number); known != armed_.end())
    return known->second.broken ? Result<void>(is_broken(object.name)) : Result<void>();
  auto body = Breakable::make(object.map, object.material, rack_.mixer().sample_rate_hz(),
                              rack_.mixer().counters().frames.load(std::memory_order_relaxed));
  if (!body) return cannot_break(object.name, body.error());
  armed_.emplace(object.number, Armed{.body = *std::move(body), .set = {}, .object = {.name = object.name}});
  ++followed_;
  return {};
}

// Takes an object out of those that are followed. The mutex must be held.
void Breakage::forget(ArmedObjects::iterator armed) {
  --followed_;
  if (armed->second.broken) --broken_;
  if (armed->second.strength_pa > 0) --strong_;
  armed_.erase(armed);
}

// Loads the pieces of a followed object, in place of those of another pattern. The object is no longer followed if it
// has no pieces then. Returns the number of pieces.
Result<std::size_t> Breakage::load_pieces(const ObjectState& object, std::size_t pattern) {
  const auto good = check_pattern(object, pattern);
  std::vector<PieceReport> former;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(object.number);
    Armed& armed = known->second;
    if (!good && !armed.set) forget(known);
    if (!good) return fail(good);
    if (armed.set && armed.set->pattern() == pattern) return armed.object.pieces.size();
    armed.set.reset();
    former = std::exchange(armed.object.pieces, {});
  }
  free_pieces(former);
  const auto set = set_for(object, pattern);
  std::vector<PieceReport> pieces;
  for (const breaking::BodyPiece& piece : set->pieces()) {
    PieceReport& report = pieces.emplace_back();
    report.name = piece_name(object, pieces.size() - 1);
    report.mass = piece.mass;
    if (!piece.map) continue;
    const auto loaded = load_piece(object, piece, report.name);
    if (!loaded) {
      free_pieces(pieces);
      const std::scoped_lock lock(mutex_);
      forget(armed_.find(object.number));
      return cannot_break(object.name, loaded.error());
    }
    report.number = *loaded;
  }
  const std::scoped_lock lock(mutex_);
  Armed& armed = armed_.at(object.number);
  armed.set = set;
  armed.object.pattern = pattern;
  armed.object.pieces = std::move(pieces);
  return armed.object.pieces.size();
}

// Returns the pieces of an object in a pattern; objects that are alike share them.
std::shared_ptr<const PieceSet> Breakage::set_for(const ObjectState& object, std::size_t pattern) const {
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [number, armed] : armed_) {
      if (armed.set && armed.set->pattern() == pattern && armed.body.map() == object.map &&
          armed.body.material() == object.material)
        return armed.set;
    }
  }
  return std::make_shared<const PieceSet>(*object.map, object.material, pattern);
}

Result<synth::ObjectNumber> Breakage::load_piece(const ObjectState& object, const breaking::BodyPiece& piece,
                                                 const std::string& name) {
  if (rack_.find({.name = name})) return refuse("an object \"" + name + "\" exists already");
  const modal::BankPath path{modal::split_bank_path(object.bank).file, {piece.model}};
  const auto number = rack_.add(name, modal::bank_path(path),
                                {.map = piece.map, .bytes = object.bank_bytes, .content = object.bank_content});
  if (!number) return number;
  const auto finished = [&]() -> Result<void> {
    if (object.material != modal::MaterialScale()) {
      if (auto set = rack_.set_material({.number = *number}, object.material); !set) return set;
    }
    if (object.group.empty()) return {};
    return rack_.set_group({.number = *number}, object.group);
  }();
  if (finished) return number;
  static_cast<void>(rack_.free({.number = *number}));
  return fail(finished);
}

void Breakage::free_pieces(const std::vector<PieceReport>& pieces) {
  for (const PieceReport& piece : pieces) {
    if (piece.number) static_cast<void>(rack_.free({.number = *piece.number}));
  }
}

Result<void> Breakage::check(const protocol::BreakObject& request) const {
  const auto found = rack_.find(request.object);
  if (!found) return fail(found);
  const ObjectState& object = **found;
  if (auto good = Breakable::check(object.map->bank()); !good) return cannot_break(object.name, good.error());
  if (auto whole = check_whole(object.number); !whole) return whole;
  if (request.pattern >= 0) {
    if (auto good = check_pattern(object, static_cast<std::size_t>(request.pattern)); !good) return good;
  }
  return check_point(request.point_m, object);
}

Result<Breakage::Outcome> Breakage::break_object(const protocol::BreakObject& request, Frame frame) {
  if (auto good = check(request); !good) return fail(good);
  const ObjectSnapshot object = *rack_.find(request.object);
  if (auto followed = follow(*object); !followed) return fail(followed);
  const std::optional<std::size_t> pattern = [&]() -> std::optional<std::size_t> {
    if (request.pattern >= 0) return static_cast<std::size_t>(request.pattern);
    const std::scoped_lock lock(mutex_);
    Armed& armed = armed_.at(object->number);
    if (armed.set) return std::nullopt;
    const double available_j = modal::modal_energy(armed.body.at_peak(blow_of(request), frame)).total_j();
    return armed.body.affordable(armed.body.levels_at(request.point_m), available_j);
  }();
  if (pattern) {
    if (auto loaded = load_pieces(*object, *pattern); !loaded) return fail(loaded);
  }
  return break_armed(request, frame, synth::Producer::worker);
}

Result<Breakage::Outcome> Breakage::break_armed(const protocol::BreakObject& request, Frame frame,
                                                synth::Producer producer) {
  if (auto good = check(request); !good) return fail(good);
  const ObjectSnapshot object = *rack_.find(request.object);
  rack_.observers().report_events();
  frame = std::max(frame, rack_.mixer().counters().frames.load(std::memory_order_relaxed));
  std::vector<Event> events;
  BrokenObject broken;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(object->number);
    if (known == armed_.end() || !known->second.set)
      return refuse("\"" + object->name + "\" is not armed, so its pieces are not there; arm it first");
    Armed& armed = known->second;
    if (armed.broken) return is_broken(object->name);
    events = shatter(armed, *object, request, frame);
    armed.broken = true;
    ++broken_;
    broken = armed.object;
  }
  Outcome outcome{.pieces = broken.pieces.size()};
  for (const Event& event : events) outcome.lost += rack_.push(producer, event) ? 0 : 1;
  rack_.observers().report_broken(broken);
  return outcome;
}

// Returns the events that set the pieces going as the body was heard, and notes how the pieces fly.
std::vector<Event> Breakage::shatter(Armed& armed, const ObjectState& object, const protocol::BreakObject& request,
                                     Frame frame) {
  std::vector<std::optional<synth::ObjectNumber>> numbers;
  std::vector<Event> events;
  std::vector<PieceReport>& reports = armed.object.pieces;
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const auto piece =
        reports[i].number ? rack_.find({.number = reports[i].number}) : Result<ObjectSnapshot>(ObjectSnapshot());
    // A piece that somebody has freed, or given another bank, is left alone.
    const bool is_own = piece && *piece && (*piece)->map == armed.set->pieces()[i].map;
    numbers.push_back(is_own ? reports[i].number : std::nullopt);
    if (!is_own) continue;
    if (object.gain != 1) events.push_back({frame, *numbers.back(), synth::verb::Gain{object.gain}});
    if (object.pan != 0) events.push_back({frame, *numbers.back(), synth::verb::Pan{object.pan}});
  }
  armed.body.set_sample_rate(rack_.mixer().sample_rate_hz());
  const breaking::Shattered shattered =
      armed.body.shatter(*armed.set, {.blow = blow_of(request),
                                      .frame = frame,
                                      .crack_energy_j = armed.body.crack_cost_j(armed.set->pattern()),
                                      .body = object.number,
                                      .pieces = numbers});
  for (std::size_t i = 0; i < reports.size(); ++i) {
    reports[i].velocity_m_s = shattered.broken.pieces[i].velocity_m_s;
    reports[i].spin_rad_s = shattered.broken.pieces[i].spin_rad_s;
  }
  events.insert(events.end(), shattered.events.begin(), shattered.events.end());
  return events;
}

Result<void> Breakage::mend(const ObjectRef& ref) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found);
  std::vector<PieceReport> pieces;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find((*found)->number);
    if (known == armed_.end())
      return fail(ErrorKind::bad_input, "\"" + (*found)->name + "\" is whole, and has no pieces to free");
    pieces = std::move(known->second.object.pieces);
    forget(known);
  }
  free_pieces(pieces);
  return {};
}

Result<void> Breakage::set_strength(const ObjectRef& ref, double strength_pa) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found);
  const modal::Bank& bank = (*found)->map->bank();
  if (strength_pa > 0 && bank.fracture && bank.fracture->stress.positions.empty()) {
    return refuse("\"" + (*found)->name +
                  "\" cannot break by itself: its bank does not say how blows strain it; bake it again");
  }
  if (auto armed = arm(ref); strength_pa > 0 && !armed) return fail(armed);
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find((*found)->number);
  if (known == armed_.end()) return {};
  strong_ += static_cast<int>(strength_pa > 0) - static_cast<int>(known->second.strength_pa > 0);
  known->second.strength_pa = strength_pa;
  return {};
}

std::optional<Breakage::Outcome> Breakage::break_by(const Event& event, synth::Producer producer) {
  if (strong_ == 0) return std::nullopt;
  const auto blow = [&]() -> std::optional<Strike> {
    if (const auto* strike = event.verb.get_if<Strike>()) return *strike;
    const auto* strike = event.verb.get_if<synth::verb::StrikeVertex>();
    const auto object = strike ? rack_.find({.number = event.object}) : Result<ObjectSnapshot>(ObjectSnapshot());
    if (!object || !*object || strike->vertex >= (*object)->map->bank().point_count()) return std::nullopt;
    const modal::Vec3f& p = (*object)->map->bank().positions[strike->vertex];
    return Strike{(*object)->material.size * Vec3{p[0], p[1], p[2]}, strike->impulse_ns, strike->contact_time_s};
  }();
  if (!blow) return std::nullopt;
  rack_.observers().report_events();
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(event.object);
    if (known == armed_.end() || known->second.strength_pa == 0 || known->second.broken || !known->second.set)
      return std::nullopt;
    if (!known->second.body.exceeds(*blow, event.frame, known->second.strength_pa)) return std::nullopt;
  }
  const auto done = break_armed({{.number = event.object}, blow->point_m, blow->impulse_ns, blow->contact_time_s},
                                event.frame, producer);
  return done ? std::optional(*done) : std::nullopt;
}

Result<double> Breakage::stress_pa(const ObjectRef& ref, const Strike& blow, Frame frame) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found);
  if (auto good = check_point(blow.point_m, **found); !good) return fail(good);
  rack_.observers().report_events();
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find((*found)->number);
  if (known == armed_.end()) return refuse("\"" + (*found)->name + "\" is not armed, so its motion is not followed");
  if (known->second.broken) return is_broken((*found)->name);
  return known->second.body.stress_pa(blow, frame);
}

Result<Breakage::Report> Breakage::report(const ObjectRef& ref, std::optional<std::size_t> pattern) const {
  const auto found = rack_.find(ref);
  if (!found) return fail(found);
  const ObjectState& object = **found;
  const modal::Bank& bank = object.map->bank();
  if (auto good = Breakable::check(bank); !good) return cannot_break(object.name, good.error());
  if (pattern) {
    if (auto good = check_pattern(object, *pattern); !good) return fail(good);
  }
  Report report;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = armed_.find(object.number); known != armed_.end() && known->second.set) {
      static_cast<BrokenObject&>(report) = known->second.object;
      report.armed = true;
      report.broken = known->second.broken;
      report.strength_pa = known->second.strength_pa;
    }
  }
  report.name = object.name;
  if (!pattern || (report.armed && report.pattern == *pattern)) return report;
  report.pattern = *pattern;
  report.armed = report.broken = false;
  report.pieces.clear();
  for (const modal::PieceBank& piece : bank.fracture->patterns[*pattern].pieces) {
    report.pieces.push_back({.name = piece_name(object, report.pieces.size()),
                             .number = {},
                             .mass = rescale(*piece.bank.mass, object.material)});
  }
  return report;
}

bool Breakage::is_piece(synth::ObjectNumber object) const {
  const std::scoped_lock lock(mutex_);
  return std::ranges::any_of(armed_, [object](const auto& known) {
    return std::ranges::any_of(known.second.object.pieces,
                               [object](const PieceReport& p) { return p.number == object; });
  });
}

Result<void> Breakage::check_whole(synth::ObjectNumber object) const {
  if (broken_ == 0) return {};
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find(object);
  if (known == armed_.end() || !known->second.broken) return {};
  const std::string& name = known->second.object.name;
  return refuse("\"" + name + "\" is broken; strike its pieces, " + name + ".0 and so on, or mend it");
}

void Breakage::played(const Event& event) {
  if (is_of_listener(event)) return;
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find(event.object);
  if (known == armed_.end() || known->second.broken) return;
  known->second.body.set_sample_rate(rack_.mixer().sample_rate_hz());
  known->second.body.follow(event);
}

// An object with another bank, material or name is armed anew when it breaks.
void Breakage::changed(const ObjectState* before, const ObjectState* after, Frame /*at*/) {
  if (!before) return;
  std::vector<PieceReport> pieces;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(before->number);
    if (known == armed_.end()) return;
    const Armed& armed = known->second;
    if (after && after->map == armed.body.map() && (armed.broken || after->material == armed.body.material())) return;
    pieces = std::move(known->second.object.pieces);
    forget(known);
  }
  free_pieces(pieces);
}

}  // namespace ringdown::session

#include "server/session/breakage.h"

#include "engine/modal/bank.h"
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

tl::unexpected<Error> refuse(const std::string& sentence) { return fail(ErrorKind::refused, sentence); }

tl::unexpected<Error> cannot_break(const std::string& name, const Error& why) {
  return fail(why.kind, "\"" + name + "\" cannot break: " + why.message);
}

tl::unexpected<Error> is_broken(const std::string& name) {
  return refuse("\"" + name + "\" is broken; /object/" + name + "/mend it");
}

synth::verb::Strike blow_of(const protocol::BreakObject& request) {
  return {request.point_m, request.impulse_ns, request.contact_time_s};
}

}  // namespace

Result<std::size_t> Breakage::arm(const ObjectRef& ref, std::optional<std::size_t> pattern) {
  const auto found = rack_.find(ref);
  if (!found) return fail(found.error());
  const ObjectState& object = **found;
  if (auto followed = follow(object); !followed) return fail(followed.error());
  if (pattern) return load_pieces(object, *pattern, true);
  const modal::Fracture& fracture = *object.map->bank().fracture;
  const std::size_t finest = [&] {
    const std::scoped_lock lock(mutex_);
    return armed_.at(object.number).body.levels_at(object.material.size * fracture.patterns[0].at_m).back();
  }();
  return load_pieces(object, finest, false);
}

// Begins to follow an object's motion, unless it is followed already.
Result<void> Breakage::follow(const ObjectState& object) {
  const std::scoped_lock lock(mutex_);
  if (const auto known = armed_.find(object.number); known != armed_.end())
    return known->second.broken ? Result<void>(is_broken(object.name)) : Result<void>();
  auto body = Breakable::make(object.map, object.material, rack_.mixer().sample_rate_hz(),
                              rack_.mixer().counters().frames.load(std::memory_order_relaxed));
  if (!body) return cannot_break(object.name, body.error());
  armed_.emplace(object.number, Armed{.name = object.name, .body = *std::move(body)});
  return {};
}

// Loads the pieces of a followed object, in place of those of another pattern. The object is no longer followed if that
// fails. Returns the number of pieces.
Result<std::size_t> Breakage::load_pieces(const ObjectState& object, std::size_t pattern, bool is_told) {
  const auto give_up = [&] {
    const std::scoped_lock lock(mutex_);
    armed_.erase(object.number);
  };
  std::vector<PieceReport> former;
  {
    const std::scoped_lock lock(mutex_);
    Armed& armed = armed_.at(object.number);
    if (armed.set && armed.set->pattern() == pattern) {
      armed.is_told = armed.is_told || is_told;
      return armed.pieces.size();
    }
    armed.set.reset();
    former = std::move(armed.pieces);
    armed.pieces.clear();
  }
  free_pieces(former);
  const std::size_t patterns = object.map->bank().fracture->patterns.size();
  if (pattern >= patterns) {
    give_up();
    return fail(ErrorKind::bad_input, "there is no pattern " + std::to_string(pattern) + ": \"" + object.name +
                                          "\" has " + std::to_string(patterns) + ", which are numbered from 0");
  }
  const auto set = std::make_shared<const PieceSet>(*object.map, object.material, pattern);
  std::vector<PieceReport> pieces;
  for (const breaking::BodyPiece& piece : set->pieces()) {
    PieceReport& report = pieces.emplace_back();
    report.name = object.name + "." + std::to_string(pieces.size() - 1);
    report.mass = piece.mass;
    if (!piece.map) continue;
    const auto loaded = load_piece(object, piece, report.name);
    if (!loaded) {
      free_pieces(pieces);
      give_up();
      return cannot_break(object.name, loaded.error());
    }
    report.number = *loaded;
  }
  const std::scoped_lock lock(mutex_);
  Armed& armed = armed_.at(object.number);
  armed.set = set;
  armed.pieces = std::move(pieces);
  armed.is_told = is_told;
  return armed.pieces.size();
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
  return fail(finished.error());
}

void Breakage::free_pieces(const std::vector<PieceReport>& pieces) {
  for (const PieceReport& piece : pieces) {
    if (piece.number) static_cast<void>(rack_.free({.number = *piece.number}));
  }
}

Result<void> Breakage::check(const protocol::BreakObject& request) const {
  const auto found = rack_.find(request.object);
  if (!found) return fail(found.error());
  const ObjectState& object = **found;
  if (auto good = Breakable::check(object.map->bank()); !good) return cannot_break(object.name, good.error());
  if (auto whole = check_whole(object.number); !whole) return whole;
  return check_point(request.point_m, object);
}

Result<std::size_t> Breakage::break_object(const protocol::BreakObject& request, Frame frame) {
  if (auto good = check(request); !good) return fail(good.error());
  const ObjectSnapshot object = *rack_.find(request.object);
  if (auto followed = follow(*object); !followed) return fail(followed.error());
  rack_.observers().report_events();
  bool is_told = request.pattern >= 0;
  const std::size_t pattern = [&] {
    if (is_told) return static_cast<std::size_t>(request.pattern);
    const std::scoped_lock lock(mutex_);
    Armed& armed = armed_.at(object->number);
    if (armed.set && armed.is_told) {
      is_told = true;
      return armed.set->pattern();
    }
    const Breakable& body = armed.body;
    const Vec3 place_m =
        armed.set ? body.material().size * body.fracture().patterns[armed.set->pattern()].at_m : request.point_m;
    const modal::ModalState state = armed.body.at_peak(blow_of(request), frame);
    return body.affordable(body.levels_at(place_m), modal::modal_energy(state).total_j());
  }();
  const auto count = load_pieces(*object, pattern, is_told);
  if (!count) return count;
  std::vector<Event> events;
  {
    const std::scoped_lock lock(mutex_);
    events = shatter(armed_.at(object->number), *object, request, frame);
    ++broken_;
  }
  std::size_t lost = 0;
  for (const Event& event : events) lost += rack_.push(synth::Producer::worker, event) ? 0 : 1;
  if (lost > 0) rack_.warn(std::to_string(lost) + " modes of pieces were lost, because too many events were waiting");
  return count;
}

// Returns the events that set the pieces going as the body was heard, and notes how the pieces fly.
std::vector<Event> Breakage::shatter(Armed& armed, const ObjectState& object, const protocol::BreakObject& request,
                                     Frame frame) {
  std::vector<std::optional<synth::ObjectNumber>> numbers;
  std::vector<Event> events;
  for (std::size_t i = 0; i < armed.pieces.size(); ++i) {
    const auto piece = armed.pieces[i].number ? rack_.find({.number = armed.pieces[i].number})
                                              : Result<ObjectSnapshot>(ObjectSnapshot());
    // A piece that somebody has freed, or given another bank, is left alone.
    const bool is_own = piece && *piece && (*piece)->map == armed.set->pieces()[i].map;
    numbers.push_back(is_own ? armed.pieces[i].number : std::nullopt);
    if (!is_own) continue;
    if (object.gain != 1) events.push_back({frame, *numbers.back(), synth::verb::Gain{object.gain}});
    if (object.pan != 0) events.push_back({frame, *numbers.back(), synth::verb::Pan{object.pan}});
  }
  const breaking::Shattered shattered =
      armed.body.shatter(*armed.set, {.blow = blow_of(request),
                                      .frame = frame,
                                      .crack_energy_j = armed.body.crack_cost_j(armed.set->pattern()),
                                      .body = object.number,
                                      .pieces = numbers});
  for (std::size_t i = 0; i < armed.pieces.size(); ++i) {
    armed.pieces[i].velocity_m_s = shattered.broken.pieces[i].velocity_m_s;
    armed.pieces[i].spin_rad_s = shattered.broken.pieces[i].spin_rad_s;
  }
  armed.broken = true;
  events.insert(events.end(), shattered.events.begin(), shattered.events.end());
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
  free_pieces(armed->pieces);
  return {};
}

Result<Breakage::Report> Breakage::report(const ObjectRef& ref) const {
  const auto found = rack_.find(ref);
  if (!found) return fail(found.error());
  if (auto good = Breakable::check((*found)->map->bank()); !good) return cannot_break((*found)->name, good.error());
  Report report{.patterns = (*found)->map->bank().fracture->patterns.size()};
  const std::scoped_lock lock(mutex_);
  if (const auto known = armed_.find((*found)->number); known != armed_.end() && known->second.set) {
    report.pattern = known->second.set->pattern();
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

void Breakage::played(const Event& event) {
  if (is_of_listener(event)) return;
  const std::scoped_lock lock(mutex_);
  const auto known = armed_.find(event.object);
  if (known != armed_.end() && !known->second.broken) known->second.body.follow(event);
}

// An object with another bank, material or name is armed anew when it breaks.
void Breakage::changed(const ObjectState* before, const ObjectState* after, Frame /*at*/) {
  if (!before) return;
  std::optional<Armed> gone;
  {
    const std::scoped_lock lock(mutex_);
    const auto known = armed_.find(before->number);
    if (known == armed_.end()) return;
    const Armed& armed = known->second;
    if (after && after->map == armed.body.map() && (armed.broken || after->material == armed.body.material())) return;
    gone = std::move(known->second);
    armed_.erase(known);
    if (gone->broken) --broken_;
  }
  free_pieces(gone->pieces);
}

}  // namespace ringdown::session

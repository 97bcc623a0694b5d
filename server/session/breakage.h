// Objects that break into pieces, which are objects of their own. [worker, unless noted]
//
//   breakage.arm({.name = "glass"}, 0);               // loads glass.0, glass.1 ... as silent objects
//   breakage.break_object(request, frame);            // the glass stops, and its pieces go on with its motion
//   breakage.mend({.name = "glass"});                 // the pieces go, and the glass can be struck again
//
// While an object is armed, its motion is followed by the events that the mixer has taken (engine/breaking/breakable.h,
// which also says what is left out).
#pragma once

#include "engine/base/result.h"
#include "engine/breaking/breakable.h"
#include "engine/breaking/piece_set.h"
#include "engine/synth/events/event.h"
#include "protocol/request.h"
#include "server/session/broken_object.h"
#include "server/session/observers.h"
#include "server/session/rack.h"

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::session {

class Breakage final : public Observer {
 public:
  // Observes `rack`, which must be empty and outlive it.
  explicit Breakage(Rack& rack) : rack_(rack) { rack.observers().add(*this); }
  ~Breakage() override { rack_.observers().remove(*this); }
  Breakage(const Breakage&) = delete;
  Breakage& operator=(const Breakage&) = delete;

  // Loads the pieces of a pattern, NAME.0, NAME.1 ..., those that ring, with material and group of the object.
  // Returns the number of the pattern's pieces. Without a pattern, the finest of the first one's place. Nothing changes
  // if the pieces are there already; those of another pattern are freed. Refused if the object has no pieces, if one of
  // the names is taken, or if there is no room.
  Result<std::size_t> arm(const protocol::ObjectRef& object, std::optional<std::size_t> pattern = {});

  // Fails if break_object() would, but for lack of room.
  [[nodiscard]] Result<void> check(const protocol::BreakObject& request) const;

  // The result of a break: the number of pieces, and of their modes that found no room in the mixer's queue.
  struct Outcome {
    std::size_t pieces = 0, lost = 0;
  };

  // Breaks the object at `frame`, the peak of a blow. The pieces take over the object's motion when the crack reaches
  // them; the piece under the blow receives the second half of it. An object that is not armed is armed first: with the
  // finest pattern of the nearest place whose crack the vibration can pay for, if the request names none. Refused for
  // an object that is broken already.
  Result<Outcome> break_object(const protocol::BreakObject& request, synth::Frame frame);

  // Breaks an armed object into the pieces that are there, at once if `frame` has passed; the request's pattern does
  // not count. Refused for an object that is not armed, or broken. Allocates; loads nothing. [the producer's thread]
  Result<Outcome> break_armed(const protocol::BreakObject& request, synth::Frame frame, synth::Producer producer);

  // Frees the pieces. Refused for an object that has none.
  Result<void> mend(const protocol::ObjectRef& object);

  // Arms the object if need be, and lets blows break it that strain its skin to this strength [Pa]; 0: none does.
  // Refused above 0 if the object's bank knows no stress.
  Result<void> set_strength(const protocol::ObjectRef& object, double strength_pa);

  // Breaks the event's object, in place of the event, if the event is a blow that exceeds the object's strength. [the
  // producer's thread]
  std::optional<Outcome> break_by(const synth::Event& event, synth::Producer producer);

  // The stress that a blow would cause in an armed object (Breakable::stress_pa()). [any but audio]
  [[nodiscard]] Result<double> stress_pa(const protocol::ObjectRef& object, const synth::verb::Strike& blow,
                                         synth::Frame frame);

  // An armed or broken object and its pieces, or those of another pattern, which are then not loaded.
  struct Report : BrokenObject {
    bool armed = false, broken = false;
    double strength_pa = 0;
  };
  [[nodiscard]] Result<Report> report(const protocol::ObjectRef& object, std::optional<std::size_t> pattern = {}) const;

  // Returns true if the object is a piece of another one. [any but audio]
  [[nodiscard]] bool is_piece(synth::ObjectNumber object) const;

  // Refuses blows on a broken object. [any but audio]
  [[nodiscard]] Result<void> check_whole(synth::ObjectNumber object) const;

  [[nodiscard]] bool needs_events() const override { return followed_ > 0; }
  void played(const synth::Event& event) override;
  void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) override;

 private:
  struct Armed {
    breaking::Breakable body;
    std::shared_ptr<const breaking::PieceSet> set;  // null until its pieces are loaded
    BrokenObject object;                            // the pieces are those of the set
    double strength_pa = 0;
    bool broken = false;
  };
  using ArmedObjects = std::map<synth::ObjectNumber, Armed>;

  [[nodiscard]] Result<void> follow(const ObjectState& object);
  [[nodiscard]] Result<std::size_t> load_pieces(const ObjectState& object, std::size_t pattern);
  [[nodiscard]] std::shared_ptr<const breaking::PieceSet> set_for(const ObjectState& object, std::size_t pattern) const;
  [[nodiscard]] Result<synth::ObjectNumber> load_piece(const ObjectState& object, const breaking::BodyPiece& piece,
                                                       const std::string& name);
  [[nodiscard]] std::vector<synth::Event> shatter(Armed& armed, const ObjectState& object,
                                                  const protocol::BreakObject& request, synth::Frame frame);
  void forget(ArmedObjects::iterator armed);
  void free_pieces(const std::vector<PieceReport>& pieces);

  Rack& rack_;
  // Numbers of objects that are followed, are broken, and have a strength. Threads read them before they lock.
  std::atomic<int> followed_ = 0, broken_ = 0, strong_ = 0;
  mutable std::mutex mutex_;  // guards armed_; not held while objects are loaded or freed, or events pushed
  ArmedObjects armed_;
};

}  // namespace ringdown::session

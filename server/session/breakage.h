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
#include "engine/modal/bank.h"
#include "engine/synth/events/event.h"
#include "protocol/request.h"
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

  // Breaks the object at `frame`, the peak of a blow, and loads pieces first if need be. The pieces take over the
  // object's motion when the crack reaches them; the piece under the blow receives the second half of it. If neither
  // the request nor arm() names a pattern, it is the finest of its place whose crack the vibration can pay for. Returns
  // the number of pieces. Refused for an object that is broken already.
  Result<std::size_t> break_object(const protocol::BreakObject& request, synth::Frame frame);

  // Frees the pieces. Refused for an object that has none.
  Result<void> mend(const protocol::ObjectRef& object);

  // The pieces of an armed or broken object.
  struct PieceReport {
    std::string name;
    std::optional<synth::ObjectNumber> number;  // nothing: it has no mode that rings
    modal::MassProperties mass;                 // in the object's frame and size
    Vec3 velocity_m_s, spin_rad_s;              // beyond those of the object before it broke; 0 if it has not
  };
  struct Report {
    std::size_t pattern = 0, patterns = 0;
    bool broken = false;
    std::vector<PieceReport> pieces;
  };
  [[nodiscard]] Result<Report> report(const protocol::ObjectRef& object) const;

  // Returns true if the object is a piece of another one. [any but audio]
  [[nodiscard]] bool is_piece(synth::ObjectNumber object) const;

  // Refuses blows on a broken object. [any but audio]
  [[nodiscard]] Result<void> check_whole(synth::ObjectNumber object) const;

  void played(const synth::Event& event) override;
  void changed(const ObjectState* before, const ObjectState* after, synth::Frame at) override;

 private:
  struct Armed {
    std::string name;  // of the object
    breaking::Breakable body;
    std::shared_ptr<const breaking::PieceSet> set;  // null until its pieces are loaded
    std::vector<PieceReport> pieces;                // of the set
    bool is_told = false;                           // the pattern was named, not chosen
    bool broken = false;
  };

  [[nodiscard]] Result<void> follow(const ObjectState& object);
  [[nodiscard]] Result<std::size_t> load_pieces(const ObjectState& object, std::size_t pattern, bool is_told);
  [[nodiscard]] Result<synth::ObjectNumber> load_piece(const ObjectState& object, const breaking::BodyPiece& piece,
                                                       const std::string& name);
  [[nodiscard]] std::vector<synth::Event> shatter(Armed& armed, const ObjectState& object,
                                                  const protocol::BreakObject& request, synth::Frame frame);
  void free_pieces(const std::vector<PieceReport>& pieces);

  Rack& rack_;
  std::atomic<int> broken_ = 0;  // how many objects are broken
  mutable std::mutex mutex_;     // guards armed_; not held while the rack is called
  std::map<synth::ObjectNumber, Armed> armed_;
};

}  // namespace ringdown::session

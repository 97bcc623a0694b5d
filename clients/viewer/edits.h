// Changes to the settings of objects, to bows and couplings on them, to which bodies a scene has and where, and to the
// listener: sent to the daemon, and undoable. [UI]
#pragma once

#include "clients/viewer/link/model.h"
#include "clients/viewer/touches.h"
#include "protocol/request.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::viewer {

inline constexpr std::size_t kMaxUndone = 256;  // older changes are forgotten

// Undo and redo. Each entry holds the request that reverts a change, and the request that makes it again.
class History {
 public:
  // Records a change of `what` ("bell: stiffness") that was already sent. A change that follows one with an equal
  // `what` within kOneGesture_s extends it, so that dragging a slider is one change.
  void note(const std::string& what, protocol::Request before, protocol::Request after, double now_s);

  static constexpr double kOneGesture_s = 0.7;

  // Return the request to send; nothing if no change is left.
  std::optional<protocol::Request> undo();
  std::optional<protocol::Request> redo();

  // Return the names of the changes that undo() and redo() would revert or repeat; empty for none.
  [[nodiscard]] std::string undoes() const { return done_ == 0 ? "" : entries_[done_ - 1].what; }
  [[nodiscard]] std::string redoes() const { return done_ == entries_.size() ? "" : entries_[done_].what; }

  void clear() { entries_.clear(), done_ = 0; }
  void forget_bodies();  // forgets new, removed and placed bodies, because their scene is gone

 private:
  struct Entry {
    std::string what;
    protocol::Request before, after;
    double when_s;
  };
  std::vector<Entry> entries_;
  std::size_t done_ = 0;  // entries before this index are done, the others are undone
};

// The settings of an object.
struct Adjustment {
  modal::MaterialScale scale;
  double gain = 1, pan = 0;
  modal::ModeRange range;
  double level_m = 0;  // of the object's liquid
};

class Edits {
 public:
  using Send = std::function<void(protocol::Request)>;
  Edits(const Model& model, Send send) : model_(model), send_(std::move(send)) {}

  void update(double now_s);  // call at every frame
  void restart();             // call when another daemon answers: its objects have no history

  // Returns the object's settings: as last sent, until the daemon has had a second to confirm; then as the daemon
  // reports.
  [[nodiscard]] Adjustment adjustment_of(const KnownObject& object) const;

  // Sends a change, which undo() can revert: SetMaterial, SetGain, SetPan, SetFill or SelectModes of an object that is
  // known.
  void change(const KnownObject& object, const protocol::Request& request, const std::string& what);
  // Takes a body out of the scene. undo() can revert this, and also takes out new bodies that the daemon has dropped.
  void remove_body(std::int32_t body);
  // Puts a body elsewhere, or the listener, which undo() reverts. Poses are as last sent until the daemon has had time
  // to confirm; then as it reports. A body's is nothing if it is not in the scene. The daemon reports no listener:
  // listener() is nothing until set_listener() or after listening ended.
  [[nodiscard]] std::optional<ringdown::Pose> pose_of(std::int32_t body) const;
  void place_body(std::int32_t body, const ringdown::Pose& pose);
  [[nodiscard]] const std::optional<ringdown::Pose>& listener() const { return listener_; }
  void set_listener(const std::optional<ringdown::Pose>& pose);
  void forget_bodies();
  // Lays, changes or ends a bow or a coupling (SetBow, SetCoupling). forget_touches() follows a request that ends all.
  void touch(const protocol::Request& bow_or_coupling);
  void forget_touches() { touches_.clear(); }
  [[nodiscard]] const Touches& touches() const { return touches_; }
  void undo() { send_if_any(history_.undo()); }
  void redo() { send_if_any(history_.redo()); }
  [[nodiscard]] const History& history() const { return history_; }

 private:
  void note_new_bodies();
  void send(const protocol::Request& request);
  void send_if_any(const std::optional<protocol::Request>& request);

  struct Pending {
    Adjustment adjustment;
    double sent_at_s;
  };
  const Model& model_;
  Send send_;
  History history_;
  std::map<std::string, Pending> pending_;  // changes sent and not yet confirmed, by object
  struct Placed {
    ringdown::Pose pose;
    double sent_at_s;
  };
  std::map<std::int32_t, Placed> placed_;  // poses sent and not yet shown, by body
  std::optional<ringdown::Pose> listener_;
  Touches touches_;
  double now_s_ = 0;
  std::uint64_t messages_seen_ = 0;
};

}  // namespace ringdown::viewer

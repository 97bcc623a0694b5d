// A body that may break, followed beside what the mixer plays. Sessions, scenes and the C library share it, so that all
// decide alike. It has no lock and belongs to no thread: calls for one body must not overlap. [any]
//
//   auto body = Breakable::make(map, material, sample_rate_hz, now);
//   body->follow(event);                                       // every event of the body, as the mixer takes it
//   const PieceSet pieces(*map, material, pattern);            // beforehand: each piece that rings becomes an object
//   const Shattered broken = body->shatter(pieces, {.blow = strike, .frame = frame, .numbers = numbers});
//
// Blows, imparted motions, chokes, clears and poses count. Rings, bows, contacts and inputs do not, so what they excite
// is missing in the pieces.
//
// A blow that breaks a body does so at the peak of its force, which is the frame of the strike. The second half of the
// blow goes to the piece under it, or is left to a striker that goes on to touch the piece.
#pragma once

#include "engine/base/result.h"
#include "engine/breaking/collision.h"
#include "engine/breaking/piece_set.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/fracture/modal_state.h"
#include "engine/synth/events/event.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::breaking {

enum class RestOfBlow { to_piece, to_striker };

// The most that cracks take of the energy of the body's modes; our choice. A blow that breaks the body also dents it
// and bends it in modes above its band, and the state has nothing of that energy, which pays for the rest of the
// cracks. Without this limit, a weak blow would leave pieces that fly and are silent.
inline constexpr double kMaxCrackShare = 0.5;

// A break at one frame. `blow` is in the body's frame and size.
struct Break {
  synth::verb::Strike blow;
  synth::Frame frame = 0;  // of the peak of the force
  // The motion at the break, by a collision; nothing: that at the peak of the blow.
  std::optional<modal::ModalState> motion = {};
  double crack_energy_j = 0;
  RestOfBlow rest = RestOfBlow::to_piece;
  synth::ObjectNumber body = 0;
  std::span<const std::optional<synth::ObjectNumber>> pieces;  // one for each piece; nothing: it is not heard
};

struct Shattered {
  modal::Broken broken;              // velocities and spins are beyond those of the body before the blow
  std::size_t under = 0;             // the piece under the blow
  std::vector<synth::Event> events;  // for the pieces, at the frames when the crack reaches them, and for the body
};

// A collision that has been followed to its end, and what it would have done to the body then.
struct Course {
  std::optional<double> strained_s;  // when the stress first reached the strength, from the first touch on
  double hardest_s = 0;              // when the force was largest
  double impulse_ns = 0;             // of the whole collision
  double end_s = 0;
  modal::ModalState end;  // its rigid motion is what the collision has added
};

class Breakable {
 public:
  // Fails with the end of a sentence, "its bank has no pieces", if a body of this bank cannot break.
  static Result<void> check(const modal::Bank& bank);

  // Fails as check() does, or if some modes do not ring in the material. The body is at rest at the frame `present`.
  static Result<Breakable> make(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material,
                                double sample_rate_hz, synth::Frame present);

  // Changes the state by an event of this body. One that another event of a later frame has overtaken is moved on.
  void follow(const synth::Event& event);

  // Moves the state on to a frame, unless it is there already. Rigid motion is not followed.
  const modal::ModalState& advance_to(synth::Frame frame);

  // Returns the state at the peak of a blow, with what its force has done until then. Its rigid motion is that of the
  // blow alone.
  [[nodiscard]] modal::ModalState at_peak(const synth::verb::Strike& blow, synth::Frame frame);

  // Follows a collision whose first touch is at `frame`, without changing the body. If a strength is given and the bank
  // knows stress, finds when the stress on the skin reaches it, during the collision or within 3 ms after, at all
  // places but those near the points of contact. Cost: collision.h, and some milliseconds if a bound on the stress
  // reaches the strength.
  [[nodiscard]] Course course_of(const Meeting& meeting, synth::Frame frame, std::optional<double> strength_pa);

  // Returns the state of the body, and the impulse [N s] that has acted, at a time of the collision.
  struct Moment {
    modal::ModalState state;  // its rigid motion is what the collision has added
    double impulse_ns = 0;
  };
  [[nodiscard]] Moment moment_of(const Meeting& meeting, synth::Frame frame, double time_s);

  // Lets the collision that course_of() has just followed count. The present is then its end.
  void follow(const Course& course);

  // Returns the largest tensile stress on the body's skin while the blow acts and shortly after it; 0 if the bank knows
  // no stress (knows_stress()). Points close to the blow are left out, where stress depends on the form of the striker.
  // If a bound lies below `above_pa`, the bound is returned instead, which costs a product for each mode; the stress
  // itself takes some milliseconds.
  [[nodiscard]] double stress_pa(const synth::verb::Strike& blow, synth::Frame frame, double above_pa = 0);
  [[nodiscard]] bool knows_stress() const { return !fracture().stress.positions.empty(); }

  // Returns true if the blow strains the body up to this strength.
  [[nodiscard]] bool exceeds(const synth::verb::Strike& blow, synth::Frame frame, double strength_pa) {
    return knows_stress() && stress_pa(blow, frame, strength_pa) >= strength_pa;
  }

  // Returns the patterns of the place that is nearest to a point [m], coarse to fine.
  [[nodiscard]] std::vector<std::size_t> levels_at(const Vec3& point_m) const;

  // Returns the last of these patterns whose crack costs at most this energy; the first when none does.
  [[nodiscard]] std::size_t affordable(std::span<const std::size_t> levels, double available_j) const;

  // Returns what the crack of a pattern takes from the vibration [J]: 0 if the bank does not know.
  [[nodiscard]] double crack_cost_j(std::size_t pattern) const;

  // Frames count at another sample rate from now on.
  void set_sample_rate(double sample_rate_hz) { rate_hz_ = sample_rate_hz; }

  // Breaks the body. `pieces` are of this body's map and material. Follow no events after it.
  [[nodiscard]] Shattered shatter(const PieceSet& pieces, const Break& breaks);

  [[nodiscard]] const std::shared_ptr<const modal::StrikeMap>& map() const { return map_; }
  [[nodiscard]] const modal::MaterialScale& material() const { return material_; }
  [[nodiscard]] const modal::Fracture& fracture() const { return *map_->bank().fracture; }

 private:
  struct Excited;

  Breakable(std::shared_ptr<const modal::StrikeMap> map, const modal::MaterialScale& material, double sample_rate_hz,
            synth::Frame present, modal::ModalState state);
  [[nodiscard]] double seconds(synth::Frame frames) const { return static_cast<double>(frames) / rate_hz_; }
  void append_piece(const BodyPiece& piece, const modal::PieceMotion& motion, bool under, const Break& breaks,
                    synth::ObjectNumber number, std::vector<synth::Event>& events) const;

  std::shared_ptr<const modal::StrikeMap> map_;
  modal::MaterialScale material_;
  double rate_hz_;
  synth::Frame present_;  // the frame of state_
  modal::ModalState state_;
  std::optional<synth::verb::Pose> pose_;
};

}  // namespace ringdown::breaking

// Objects that touch each other, or a bow, or a mallet, while they ring: rendered together, because each contact feels
// both of its surfaces in every sample (engine/contact).
//
// A chunk is cut at events, and into segments of at most kMaxTouchSteps steps. For each segment
//
//   1. free_motion() finds how the surfaces would move at the contacts if nothing pushed,
//   2. the network finds the forces step by step; what each force does to the rest of the segment at every contact is a
//      row of taps, the answer of the modes to a force of 1 N in one step,
//   3. drive_touched() moves every object on under its forces, once. Its samples are one more free motion, of a place
//      where all modes have a weight of 1, and the answers to the forces there. Where modes have gains of their own or
//      other forces act, too, drive_touched() computes the samples, which takes twice as long.
//
// So every mode of every object takes part, whatever their number, and the network sees sums alone. [audio, after
// construction]
#pragma once

#include "engine/base/realtime.h"
#include "engine/contact/network.h"
#include "engine/synth/contact/rubbing.h"
#include "engine/synth/touching/touch.h"
#include "engine/synth/kernels/aligned_array.h"
#include "engine/synth/objects/object.h"
#include "engine/synth/events/ramp.h"
#include "engine/synth/objects/source.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::synth {

inline constexpr std::size_t kMaxTouches = 16;         // two-way contacts at a time
inline constexpr std::size_t kMaxTouchColumns = 2048;  // of an object's modes; with more, contacts are one-way
inline constexpr std::size_t kMaxTouchSteps = 64;      // of a segment
inline constexpr std::size_t kMaxSubsteps = 4;         // of a sample, for short contacts
inline constexpr std::size_t kFreedomsOfTouch = 3;
inline constexpr std::size_t kTapRow = kMaxTouchSteps + 8;

// The weights of a place that moves as the object sounds.
alignas(64) inline constexpr std::array<double, kMaxTouchColumns> kTouchSound = [] {
  std::array<double, kMaxTouchColumns> weights{};
  weights.fill(1);
  return weights;
}();

// The motion of one place of an object in one direction.
struct TouchPort {
  AlignedArray<double> weight = aligned_zeros<double>(kMaxTouchColumns);  // displacement [m] per Re z
  std::array<double, kAnswerPadding + kMaxTouchSteps> answer{};           // the sound of 1 N in one step (add_answer())
  double leaning = 0;                                                     // the sum of Re z at rest under 1 N
  double last_n = 0;                                                      // the force in the last step
};

// A mass that moves along the contact's normal.
struct RigidMass {
  double kg = 0;  // 0: there is none
  double at_m = 0, speed_m_s = 0, load_n = 0;
};

// A two-way contact.
struct TouchSlot {
  struct Side {
    Object* object = nullptr;  // null: nothing, or the rigid mass alone
    std::array<TouchPort, kFreedomsOfTouch> ports;
    AlignedArray<double> poles = aligned_zeros<double>(2 * kMaxTouchColumns);  // of a step, where a sample has several
    AlignedArray<double> response = aligned_zeros<double>(2 * kMaxTouchColumns);  // PortForces
  };
  bool used = false;   // accepted, and not over
  bool open = false;   // its event has happened
  bool stale = false;  // its ports are to be found anew
  bool fresh = false;  // accepted since the group was set: other objects than before may touch here
  Touch touch;         // as the last event said
  std::array<Side, 2> sides;
  RigidMass rigid;
  double per_kg = 0;  // one over the mass that a short push along the normal feels
  contact::Contact contact;
  std::size_t first = 0;  // of its freedoms in the group's network
  Ramp speed_m_s, force_n;
  std::array<Ramp, 2> slide_m_s;  // rub: of the other along the surface,
  Rubbing relief;                 // the profiles that pass under it,
  double raised_m = 0;            // and by how much they press the two together
  Frame since = 0;

  [[nodiscard]] bool involves(const Object& object) const REALTIME {
    return sides[0].object == &object || sides[1].object == &object;
  }
};

class TouchGroup final : public Source {
 public:
  TouchGroup();
  void render(const Chunk& chunk, Workspace& workspace) REALTIME override;
  void skip(const Chunk& chunk, Workspace& workspace) REALTIME override { render(chunk, workspace); }
  [[nodiscard]] bool can_skip(const Chunk& /*chunk*/) const REALTIME override { return false; }
  void prepare(const Chunk& /*chunk*/) REALTIME override {}
  void count_levels(const Chunk& /*chunk*/, LevelHistogram& /*histogram*/) REALTIME override {}
  [[nodiscard]] ModeStates::Counts counts() const REALTIME override;

  // Before a chunk: these touch each other. What is known of contacts stays while they remain the same.
  void set(std::span<TouchSlot* const> touches) REALTIME;
  [[nodiscard]] bool empty() const REALTIME { return touch_count_ == 0; }

 private:
  struct Body {
    Object* object = nullptr;
    const ModeTable* table = nullptr;
    double* poles = nullptr;     // of a step, where a sample has several
    double* response = nullptr;  // what 1 N adds to z in a step at a place of weight 1
    bool heard_whole = false;    // `sound` is known: all modes are heard alike, and only contacts act
    alignas(64) std::array<double, kTapRow> sound;  // in each step of a segment
    // Other forces on it in a segment: pulses, inputs, one-way contacts.
    std::array<std::array<double, kMaxTouchSteps>, kMaxForces> impulses;
    std::array<Force, kMaxForces> exciting;
    std::size_t exciting_count = 0;
  };
  static constexpr std::size_t kFreedoms = contact::kMaxFreedoms;
  static_assert(kMaxPlaces > kFreedoms && kMaxPortForces >= kFreedoms, "all of them may act on one object");

  [[nodiscard]] std::span<TouchSlot* const> touches() const REALTIME { return {touches_.data(), touch_count_}; }
  void play_events(std::size_t offset, const Chunk& chunk) REALTIME;
  void play_touch(const Touch& how, Frame frame, const Object& object, const Chunk& chunk) REALTIME;
  void refresh(const Chunk& chunk) REALTIME;
  void find_poles(Body& body) REALTIME;
  void find_response(Body& body) REALTIME;
  // Returns the sum of the modes' squared shapes: one over the mass that a short push feels [1/kg].
  double find_port(Body& body, const Vec3& point_m, const Vec3& direction, double width_m, TouchPort& port) REALTIME;
  void find_ports(TouchSlot& touch) REALTIME;
  void find_taps() REALTIME;
  void find_laws(TouchSlot& touch) REALTIME;
  [[nodiscard]] ModeArrays modes_of(const Body& body, const StateArray& states) const REALTIME;
  [[nodiscard]] Body& body_of(const Object& object) REALTIME;
  void render_segment(std::size_t begin, std::size_t end, const Chunk& chunk, Workspace& workspace) REALTIME;
  [[nodiscard]] bool stays_apart(std::size_t steps) REALTIME;
  enum class Directions { all, normal, along };  // along the surface
  void move_freely(std::size_t begin, std::size_t frames, const Chunk& chunk, Directions which) REALTIME;
  void move_masses(std::size_t steps) REALTIME;
  void raise(TouchSlot& touch, Frame begin, std::size_t frames) REALTIME;
  void find_forces(Frame begin, std::size_t steps) REALTIME;
  void close_finished(Frame now) REALTIME;

  std::array<TouchSlot*, kMaxTouches> touches_{};
  std::size_t touch_count_ = 0;
  std::array<Body, 2 * kMaxTouches> bodies_;
  std::size_t body_count_ = 0;
  contact::Network network_;
  bool stale_ = true;  // bodies, ports and taps are to be found anew
  std::size_t substeps_ = 1;
  double step_s_ = 0;
  // For each pair of freedoms, with i <= j at j (j + 1) / 2 + i: the taps, and whether they share a body.
  AlignedArray<double> taps_;
  AlignedArray<double> kick_ = aligned_zeros<double>(2 * kMaxTouchColumns);  // what 1 N adds to z, for find_taps()
  std::array<bool, kFreedoms*(kFreedoms + 1) / 2> coupled_{};
  AlignedArray<double> approach_ = aligned_zeros<double>(kFreedoms * kTapRow);  // of each freedom, at each step
  AlignedArray<double> forces_ = aligned_zeros<double>(kFreedoms * kTapRow);
  std::array<bool, kFreedoms> pushes_{};  // not all forces of the segment are 0
  bool touched_ = false;                  // something did in the last segment
};

}  // namespace ringdown::synth

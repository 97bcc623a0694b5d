// What contacts sound like: from the touches of a step to events for the mixer. Free of any physics engine.
//
// It knows what every body and static brings to a contact, decides by ContactLives which touches strike and which last,
// and gives each event to the objects of both sides, each in its own frame. It knows too what rests on
// what, and how much that damps. [one thread at a time]
#pragma once

#include "engine/modal/damper.h"
#include "engine/scene/contact_life.h"
#include "engine/scene/rests.h"
#include "engine/scene/side.h"
#include "engine/synth/event.h"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxEventsPerStep = 512;  // strikes, clicks and tellings of lasting contacts

// Where scene time lies in frames.
struct Timeline {
  synth::Frame start = 0;
  double sample_rate_hz = 48000;
  [[nodiscard]] synth::Frame frame(double time_s) const;
};

// All that touches an object at rest in its scene and damps it, by numbers from modal::kFirstSceneDamper on; one that
// has ended is told of without damping.
struct Leaning {
  synth::Frame frame = 0;
  synth::ObjectNumber object = 0;
  modal::Dampers dampers;
};

class Sounding {
 public:
  explicit Sounding(const SceneDescription& scene);

  void set_side(BodyId id, Side side);
  void remove_side(BodyId id);
  void silence(synth::ObjectNumber object);  // its bodies stay, and sound no more

  // The events of the step that began at `now_s`, in order of their frames, valid until the next call. A strike lies at
  // its time of touch, depth over speed of approach before it was found, and never before an event of an earlier step.
  // `moved` are the bodies that moved in it.
  std::span<const synth::Event> hear(std::span<const Touch> touches, std::span<const Moved> moved, double now_s,
                                     const Timeline& timeline);

  // The objects on which something else lies since that step than before.
  [[nodiscard]] std::span<const Leaning> leanings() const { return leanings_; }

  [[nodiscard]] std::size_t dropped() const { return dropped_; }  // of that step, beyond kMaxEventsPerStep

  // No contact goes on: without touches there would be nothing to tell.
  [[nodiscard]] bool quiet() const { return lives_.size() == 0 && look_again_.empty() && !rests_.pending(); }

  // A contact has been told of that has not ended, or there is something to tell of what rests.
  [[nodiscard]] bool telling() const { return !lines_.empty() || !look_again_.empty(); }

 private:
  // An object's number for a contact of its that is being told of.
  struct Line {
    synth::ObjectNumber object = 0;
    std::uint32_t number = 0;
  };
  struct Lines {
    std::optional<Line> first, second;
  };

  void hear_pair(BodyPair pair, std::span<const Touch* const> touches, double now_s, const Timeline& timeline);
  [[nodiscard]] bool is_blow(const Touch& touch) const;
  void strike(const Touch& touch, double now_s, const Timeline& timeline);
  void look_again(const Side& side);
  void lean(synth::ObjectNumber object, synth::Frame frame);
  void click(BodyPair pair, std::span<const Touch* const> touches, const Timeline& timeline);
  [[nodiscard]] double contact_time_s(const Side& body, const Side& other, const Touch& touch) const;
  void tell(const Telling& telling, synth::Frame frame);
  void tell_side(const Telling& telling, const Side* side, std::optional<Line>& line, const Motion& motion,
                 Vec3 force_n, const synth::Texture& texture, synth::Frame frame);
  [[nodiscard]] std::uint32_t free_number(synth::ObjectNumber object) const;
  [[nodiscard]] const Side* find(BodyId id) const;
  void push(const synth::Event& event);

  ContactLives lives_;
  Rests rests_;
  double step_s_, bounce_threshold_m_s_;
  bool clicks_;
  double rest_damping_s_m_;
  double latest_s_ = 0;  // of all strikes so far
  std::map<BodyId, Side> sides_;
  std::map<BodyPair, Lines> lines_;
  std::vector<const Touch*> by_pair_;
  std::vector<synth::Event> events_;
  std::vector<Leaning> leanings_;
  std::set<synth::ObjectNumber> leaned_on_, look_again_;  // as told of; to be told of, perhaps
  std::size_t dropped_ = 0;
};

}  // namespace ringdown::scene

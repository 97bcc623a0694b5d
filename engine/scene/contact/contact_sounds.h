// Turns the contact points of a step into events for the mixer. Free of any physics engine.
//
// ContactSounds knows what every body and static contributes to a contact, lets ContactLives decide which contacts
// strike and which last, and gives each event to the objects on both sides, each in its own frame. It also reports how
// much resting contacts damp each object. [one thread at a time]
#pragma once

#include "engine/breaking/collision.h"
#include "engine/scene/contact/contact_life.h"
#include "engine/scene/contact/contact_side.h"
#include "engine/scene/contact/heard_contact.h"
#include "engine/scene/contact/lasting_events.h"
#include "engine/scene/contact/rest_damping.h"
#include "engine/synth/events/event.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

// Converts scene time to frames.
struct FrameClock {
  synth::Frame start = 0;
  double sample_rate_hz = 48000;
  [[nodiscard]] synth::Frame frame(double time_s) const;
};

// The blows of one step on a body that may break, by one other body, in its object's frame.
struct BodyBlows {
  synth::Frame frame = 0;                    // of the first touch
  std::vector<synth::verb::Strike> strikes;  // as from rigid bodies
  double pressed_ns = 0;                     // the sum of their impulses along the normals
  // At the places of the strikes, or all around the face on which the body lands: a simulation needs only some of them.
  breaking::Meeting meeting;
};

// A pair strikes, and one of its bodies may break. Returns the share of the blows' impulse that has acted when it does;
// nothing if it does not break.
using BlowJudge = std::function<std::optional<double>(BodyId body, BodyId other, const BodyBlows& blows)>;

class ContactSounds {
 public:
  explicit ContactSounds(const SceneDescription& scene);

  // Lets `judge` decide whether a body breaks under its blows, before they are reported. If one does, its own strikes
  // are left out, those of the other body have the share of the impulse that has acted by then, and so have the clicks
  // of both; the body's lasting contacts end, and it takes no more part.
  void judge_by(BlowJudge judge) { judge_ = std::move(judge); }

  // Lets the contact between a body that has gone and another one go on with a piece of the body, so that the blow
  // that broke the body does not strike the piece again.
  void pass_on(BodyId other, BodyId gone, BodyId piece);

  void set_side(BodyId id, ContactSide side);
  void remove_side(BodyId id);
  void silence(synth::ObjectNumber object);  // its bodies stay, without an object

  // Returns the events of the step that began at `now_s`, in order of their frames, valid until the next call. A strike
  // is placed at the time of impact, which is the overlap over the approach speed before the contact was found, but
  // never before an event of an earlier step. `moved` are the bodies that moved in the step.
  std::span<const synth::Event> process(std::span<const ContactPoint> points, std::span<const MovedBody> moved,
                                        double now_s, const FrameClock& timeline);

  // The objects whose resting contacts have changed in that step.
  [[nodiscard]] std::span<const RestDamping> rest_dampings() const { return rest_dampings_; }

  // The blows of that step, and the reports of its lasting contacts.
  [[nodiscard]] std::span<const HeardContact> heard() const { return heard_; }

  [[nodiscard]] std::size_t dropped() const { return events_.dropped; }  // events of that step beyond kMaxEventsPerStep

  // Returns true if a step without contact points would have nothing to report.
  [[nodiscard]] bool quiet() const { return lives_.size() == 0 && !resting_.pending(); }

  // Returns true if the end of a lasting contact or a change of an object's dampers has not been reported yet.
  [[nodiscard]] bool has_lasting() const { return !lasting_.empty() || resting_.has_unchecked(); }

 private:
  struct Run {  // points of one pair that follow each other
    BodyPair pair;
    std::span<const ContactPoint> points;
  };
  void process_pair(BodyPair pair, std::span<const ContactPoint* const> points, double now_s,
                    const FrameClock& timeline);
  [[nodiscard]] bool is_impact(const ContactPoint& point) const;
  [[nodiscard]] std::optional<double> face_time_s(std::span<const ContactPoint* const> points) const;
  struct PairStrike {  // of one contact point
    const ContactPoint* point;
    double contact_time_s;
    synth::Frame frame;
    double touched_s;  // when the surfaces touched, from the beginning of the step
    bool by_hertz;     // whether the contact time is that of this point alone
  };
  void strike(BodyPair pair, std::span<const ContactPoint* const> points, double now_s, const FrameClock& timeline);
  [[nodiscard]] std::optional<double> break_share(BodyId body, BodyId other) const;
  [[nodiscard]] std::vector<Vec3> face_around(const ContactSide& side, bool straight) const;
  void end_contacts(BodyId body, synth::Frame frame);
  [[nodiscard]] bool strike_two_way(const ContactSide& body, const ContactSide& other, const ContactPoint& point,
                                    double contact_time_s, synth::Frame frame);
  void note_blow(BodyPair pair, std::span<const ContactPoint* const> points);
  void click(BodyPair pair, double share);

  double step_s_, bounce_threshold_m_s_;
  bool clicks_;
  ContactSides sides_;
  ContactLives lives_;
  LastingEvents lasting_;
  RestDampings resting_;
  double latest_s_ = 0;                       // time of the latest strike so far
  std::vector<const ContactPoint*> by_pair_;  // the points of the step, sorted by pair
  std::vector<Run> runs_;
  std::vector<PairStrike> strikes_;  // of a pair
  BlowJudge judge_;
  StepEvents events_;
  std::vector<HeardContact> heard_;
  std::span<const RestDamping> rest_dampings_;
};

}  // namespace ringdown::scene

// Prepares the contacts of a step for ODE's solver: finds contact points, makes contact joints of them, and stores
// their impulses once the solver has run. Callers must hold OdeLock.
//
//   joints.begin_step();
//   joints.begin_part(found_s, part_s);      // a step may be done in several parts
//   joints.collide(one, two, islands);       // for every pair of bodies that may touch
//   joints.bounce(islands);
//   joints.hand_over(exact, islands);        // joints are made
//   ... the solver runs ...
//   joints.read_impulses(islands);
//   joints.end_part();                       // or solve again, from bounce() on
#pragma once

#include "engine/scene/contact/contact_rules.h"
#include "engine/scene/ode/friction_rounds.h"
#include "engine/scene/ode/islands.h"
#include "engine/scene/ode/overlap.h"
#include "engine/scene/ode/parting.h"
#include "engine/scene/ode/rolling.h"
#include "engine/scene/ode/surface_pairs.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

struct dContactGeom;
struct dxJointGroup;
struct dxWorld;

namespace ringdown::scene {

inline constexpr std::size_t kMaxContactsPerStep = 4096;

// ODE lets resting bodies overlap by this much. Bodies separated by a rounding error would fall and collide again. [m]
inline constexpr double kContactLayer_m = 2e-5;

// The largest speed at which overlapping bodies are pushed apart. More would act as a bounce, and create energy. [m/s]
inline constexpr double kMaxCorrection_m_s = 0.02;

class ContactJoints {
 public:
  ContactJoints(dxWorld* world, const SceneDescription& scene);
  ~ContactJoints();
  ContactJoints(const ContactJoints&) = delete;
  ContactJoints& operator=(const ContactJoints&) = delete;

  void begin_step();

  // `found_s` is the time from the beginning of the step to this part, `part_s` the part's length.
  void begin_part(double found_s, double part_s);

  // Finds the contact points of two bodies and unites their islands. Adds rolling resistance if the contact
  // has a single point or one of the bodies is a sphere.
  void collide(Collider& one, Collider& two, Islands& islands);

  // Sets the speeds at which bodies bounce, by the present elasticity of their islands.
  void bounce(Islands& islands);

  // Hands the contact points of islands that are not settled to the exact or to the iterative solver, as joints. The
  // iterative solver pushes overlapping bodies apart itself, because the part of a tower's weight that it fails to
  // carry in one part is pushed back in the next. If the exact solver will run, the contacts of a body that touches
  // only immovable things are solved here (fixed_contacts.h); push_lone_bodies() must then be called.
  void hand_over(bool exact, const Islands& islands);

  // Adds the forces of the contacts that hand_over() has solved to their bodies, for the next part of the step.
  void push_lone_bodies();

  // Stores the solver's impulses in the contact points of islands that are not settled.
  void read_impulses(const Islands& islands);

  // Settles all islands but those in which a body other than a sphere lands in this part in such a way that friction
  // may change the normal impulse.
  void settle_all_but_landing(Islands& islands) const;

  // Settles the islands that end by the last solution's impulses, and remakes the joints of the others with the bounds
  // for the next one. Returns false if no others are left.
  bool bound_friction(FrictionRounds& rounds, Islands& islands);

  // Moves overlapping bodies of the part apart (overlap.h), unless the solver has done so already.
  void move_bodies_apart(const Islands& islands);

  void forget(BodyId id) { pairs_.forget(id); }  // must be called when a body goes or changes its shape

  void end_part();

  [[nodiscard]] std::span<const ContactPoint> points() const { return points_; }  // all points of the step so far
  [[nodiscard]] std::span<const ContactPoint> part_points() const {
    return std::span(points_).subspan(part_.first_point);
  }

  // The joints keep this from one part to the next.
  struct Memory {
    Partings partings;
    ContactLoads loads;
    SurfacePairs pairs;
  };
  [[nodiscard]] Memory memory() const { return {partings_, loads_, pairs_}; }
  void recall(const Memory& memory);

  // Number of points and whole pairs beyond kMaxContactsPerStep in the step.
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

 private:
  struct Room;      // work space for ODE's results and for solve_lone_body()
  struct Contact;   // the data of one joint
  struct Touching;  // two bodies
  struct JointGroupDeleter {
    void operator()(dxJointGroup* joints) const;
  };
  struct Further;  // a contact without a joint
  [[nodiscard]] bool is_open(std::size_t point, const Islands& islands) const;
  void join(std::size_t point, std::optional<double> bound_n);
  bool solve_lone_body(Collider& body, std::span<const std::size_t> points);
  void add(const Touching& pair, const dContactGeom& geom, Islands& islands);
  [[nodiscard]] Landing land(const Contact& made, const ContactPoint& at, double restitution) const;
  [[nodiscard]] double push_speed(double depth_m) const;

  dxWorld* const world_;
  const double bounce_threshold_m_s_;
  const Vec3 gravity_m_s2_;
  const std::unique_ptr<dxJointGroup, JointGroupDeleter> joints_;
  const std::unique_ptr<Room> room_;
  struct Part {
    double found_s = 0, length_s = 0;
    std::size_t first_point = 0;  // number of points before the part
  } part_;                        // set by begin_part()
  // Contacts of the step, which collide() adds:
  std::vector<ContactPoint> points_;
  std::vector<MotionPair> motions_;  // motions of the touching pairs
  std::vector<Contact> made_;        // one for each contact point
  std::vector<Further> further_;     // contacts of the part that only move bodies apart
  std::size_t dropped_ = 0;
  // Set by hand_over():
  std::vector<std::size_t> lone_;  // contact points of the part that have been solved without ODE
  bool solver_pushes_ = false;
  SurfacePairs pairs_;
  Partings partings_;
  ContactLoads loads_;  // loads of the previous part
};

}  // namespace ringdown::scene

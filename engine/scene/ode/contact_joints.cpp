#include "engine/scene/ode/contact_joints.h"

#include "engine/scene/fixed_contacts.h"
#include "engine/scene/ode/contact_search.h"
#include "engine/scene/ode/overlap.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

// ODE pushes the bodies of a joint apart, because it also corrects the joint: correcting positions alone would pull the
// joint's two ends apart.
bool pushed_by_ode(const Collider& body, const Collider& other) { return body.sleep.joined() || other.sleep.joined(); }

// Maximum speed at which a hull is moved out of an overlap. All its contacts have similar normals, and a hull that lies
// on an edge of another one slips into it again and again until it lies flat.
constexpr double kMaxWayOut_m_s = 0.06;

bool is_hull(const Collider& collider) { return dGeomGetClass(collider.shape.geom.get()) == dConvexClass; }

// Below this speed the direction of sliding is noise.
constexpr double kMinSlip_m_s = 1e-6;

// Above this speed the bodies slide, and friction is that of sliding.
constexpr double kSlides_m_s = 1e-3;

// ODE's friction acts along two directions, each up to its limit. If the first one is along the sliding, or along the
// rolling if nothing slides, both together obey Coulomb's cone.
Vec3 friction_direction(Vec3 normal, const Motion& of_body, const Motion& of_other, Vec3 approach) {
  Vec3 along = approach - dot(approach, normal) * normal;
  if (length(along) < kMinSlip_m_s) along = cross(of_body.spin_rad_s - of_other.spin_rad_s, normal);
  const double speed = length(along);
  return speed < kMinSlip_m_s ? any_across(normal) : (1 / speed) * along;
}

}  // namespace

struct ContactJoints::Contact {
  Collider *body = nullptr, *other = nullptr;
  Vec3 along;                   // the first direction of friction
  double friction = 0;          // coefficient
  double restitution = 0;       // of fully elastic islands
  double approach_m_s = 0;      // of the bodies at the beginning of the part
  double bounce = 0;            // ratio of speeds; this and the next are set by bounce()
  double impact_share = 1;      // Landing::share
  double may_approach_m_s = 0;  // because the bodies do not touch yet
  bool bounces = false;         // between bodies of which none is a sphere
  bool solved = false;          // by solve_lone_body(); set by hand_over()
};

struct ContactJoints::Further {
  Collider *body, *other;
  ContactPoint point;
};

struct ContactJoints::Touching {
  Collider &body, &other;  // `body` can move
  const MotionPair& motions;
  SurfacePair surface;
};

struct ContactJoints::Room {
  std::array<dContactGeom, kMaxContactsFound> found{};  // of one pair of geometries
  std::vector<dJointFeedback> joints{kMaxContactsPerStep};
  std::vector<FixedContact> contacts{kMaxFixedContacts};  // of one body
  std::vector<Vec3> impulses_ns{kMaxFixedContacts};
};

void ContactJoints::JointGroupDeleter::operator()(dxJointGroup* joints) const { dJointGroupDestroy(joints); }

ContactJoints::ContactJoints(dxWorld* world, const SceneDescription& scene)
    : world_(world),
      bounce_threshold_m_s_(bounce_threshold(scene)),
      gravity_m_s2_(scene.gravity_m_s2),
      joints_(dJointGroupCreate(0)),
      room_(std::make_unique<Room>()) {
  points_.reserve(kMaxContactsPerStep);
  made_.reserve(kMaxContactsPerStep);
  motions_.reserve(kMaxContactsPerStep);  // points refer to them
}

ContactJoints::~ContactJoints() = default;

void ContactJoints::begin_step() {
  points_.clear();
  made_.clear();
  motions_.clear();
  dropped_ = 0;
}

void ContactJoints::begin_part(double found_s, double part_s) {
  part_ = {found_s, part_s, points_.size()};
  further_.clear();
}

void ContactJoints::collide(Collider& one, Collider& two, Islands& islands) {
  if (!one.awake() && !two.awake()) return;
  // A thousand meshes in one place have half a million pairs.
  if (points_.size() == kMaxContactsPerStep || motions_.size() == kMaxContactsPerStep) {
    ++dropped_;
    return;
  }
  const FoundContacts found =
      find_contacts(one.shape.geom.get(), two.shape.geom.get(), pairs_, room_->found, part_.length_s);
  const std::span<dContactGeom> points = found.carry;
  const bool swap = !one.movable();  // the first body of a joint must be one that moves
  Collider &body = swap ? two : one, &other = swap ? one : two;
  if (points.empty() && found.move.empty()) return;
  const auto into_body = [swap](dContactGeom geom) {
    if (!swap) return geom;
    for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
    std::swap(geom.g1, geom.g2);
    return geom;
  };
  motions_.push_back({body.motion(), other.motion()});
  Touching pair{body, other, motions_.back(), combine(body.surface, other.surface)};
  const std::size_t before = points_.size();
  for (const dContactGeom& geom : points) add(pair, into_body(geom), islands);
  if (points_.size() == before && found.move.empty()) return motions_.pop_back();  // no point refers to them
  if (pushed_by_ode(body, other)) return;
  for (const dContactGeom& further : found.move) {
    const dContactGeom geom = into_body(further);
    ContactPoint point{body.id, other.id, to_vec3(geom.pos), to_vec3(geom.normal), geom.depth};
    point.motions = &pair.motions;
    further_.push_back({&body, &other, point});
  }
  // Several contact points of bodies with edges resist rolling by themselves.
  if (points_.size() == before || (points.size() > 1 && !one.round && !two.round)) return;
  const double limit_nm = pair.surface.rolling_m * loads_.of_n(body.id, other.id);
  if (limit_nm == 0) return;
  const ContactPoint& last = points_.back();
  resist_rolling(body, other, last.point_m, last.normal, limit_nm, gravity_m_s2_, part_.length_s);
}

// The speed at which ODE pushes two bodies apart that overlap by `depth_m`.
double ContactJoints::push_speed(double depth_m) const {
  const double out_m_s = dWorldGetERP(world_) * std::max(depth_m - kContactLayer_m, 0.0) / part_.length_s;
  return std::min(out_m_s, kMaxCorrection_m_s);
}

// Corrects the bounce of a body that has reached a fixed surface within this part.
Landing ContactJoints::land(const Contact& made, const ContactPoint& at, double restitution) const {
  const Collider &body = *made.body, &other = *made.other;
  const double approach_m_s = made.approach_m_s;
  const bool lands = approach_m_s > bounce_threshold_m_s_ && at.depth_m <= approach_m_s * part_.length_s;
  if (other.movable() || other.driven() || !lands) return {restitution, approach_m_s};
  return corrected_landing({.restitution = restitution,
                            .approach_m_s = approach_m_s,
                            .fall_m_s2 = -dot(gravity_m_s2_, at.normal),
                            .depth_m = at.depth_m,
                            .part_s = part_.length_s,
                            .threshold_m_s = bounce_threshold_m_s_,
                            .pushed_m_s = pushed_by_ode(body, other) ? push_speed(at.depth_m) : 0});
}

// Adds one contact point with its joint. The normal of `geom` points into the body that can move.
void ContactJoints::add(const Touching& pair, const dContactGeom& geom, Islands& islands) {
  if (points_.size() == kMaxContactsPerStep) {
    ++dropped_;
    return;
  }
  const auto& [body, other, motions, surface] = pair;
  const auto& [of_body, of_other] = motions;
  const Vec3 point = to_vec3(geom.pos), normal = to_vec3(geom.normal);
  const Vec3 approach = of_other.velocity_at(point) - of_body.velocity_at(point);
  const double approach_m_s = dot(approach, normal);
  if (geom.depth < 0 && approach_m_s > bounce_threshold_m_s_) return;  // they bounce when they have met
  const bool slides = length(approach - approach_m_s * normal) > kSlides_m_s;
  made_.push_back({.body = &body,
                   .other = &other,
                   .along = surface.friction > 0 ? friction_direction(normal, of_body, of_other, approach) : Vec3{},
                   .friction = slides ? surface.sliding_friction : surface.friction,
                   .restitution = surface.restitution,
                   .approach_m_s = approach_m_s,
                   .may_approach_m_s = std::max(-geom.depth, 0.0) / part_.length_s,
                   .bounces = approach_m_s > bounce_threshold_m_s_ && !body.round && !other.round});
  islands.unite(body, other);
  points_.push_back({body.id, other.id, point, normal, geom.depth, {}, approach_m_s, part_.found_s, &motions});
}

void ContactJoints::bounce(Islands& islands) {
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    Contact& made = made_[k];
    ContactPoint& at = points_[k];
    const double elasticity = std::min(Islands::elasticity(*made.body), Islands::elasticity(*made.other));
    const Landing landing = land(made, at, elasticity * made.restitution);
    made.bounce = landing.bounce;
    made.impact_share = landing.share;
    at.approach_m_s = landing.approach_m_s;
    const double pushed_m_s = push_speed(at.depth_m);
    const double leaves_m_s = made.approach_m_s > bounce_threshold_m_s_ ? made.bounce * made.approach_m_s : 0;
    islands.set_speeds(k - part_.first_point, pushed_m_s > leaves_m_s ? pushed_m_s : 0, leaves_m_s > 0);
  }
}

void ContactJoints::hand_over(bool exact, const Islands& islands) {
  dJointGroupEmpty(joints_.get());
  solver_pushes_ = !exact;
  lone_.clear();
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    if (islands.is_settled(*made_[k].body)) continue;
    made_[k].solved = false;
    if (exact && islands.is_alone(*made_[k].body)) lone_.push_back(k);
  }
  const auto body_of = [this](std::size_t point) { return points_[point].body; };
  if (!std::ranges::is_sorted(lone_, {}, body_of)) std::ranges::stable_sort(lone_, {}, body_of);
  for (auto begin = lone_.begin(); begin != lone_.end();) {
    const auto end = std::find_if(begin, lone_.end(), [&](std::size_t k) { return body_of(k) != body_of(*begin); });
    const bool solved = solve_lone_body(*made_[*begin].body, {begin, end});
    for (; begin != end; ++begin) made_[*begin].solved = solved;
  }
  std::erase_if(lone_, [this](std::size_t k) { return !made_[k].solved; });
  for (Collider* body : islands.members()) {
    if (!islands.is_settled(*body)) body->sleep.allow(std::ranges::binary_search(lone_, body->id, {}, body_of));
  }
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    if (is_open(k, islands)) join(k, std::nullopt);
  }
}

// Returns whether ODE has to find the impulse of a contact point.
bool ContactJoints::is_open(std::size_t point, const Islands& islands) const {
  return !made_[point].solved && !islands.is_settled(*made_[point].body);
}

// Solves the problem that ODE's exact solver would receive: the body's motion without contacts, and for each contact
// the speed required by restitution or by the distance left before the bodies touch.
bool ContactJoints::solve_lone_body(Collider& body, std::span<const std::size_t> points) {
  if (points.size() > kMaxFixedContacts) return false;
  std::vector<FixedContact>& contacts = room_->contacts;
  std::vector<Vec3>& impulses_ns = room_->impulses_ns;
  const Motion& motion = points_[points.front()].motions->of_body;
  bool lands = false;
  contacts.resize(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ContactPoint& point = points_[points[k]];
    const Contact& made = made_[points[k]];
    const Vec3 arm_m = point.point_m - motion.position_m;
    contacts[k] = {arm_m, point.normal, made.along, -made.may_approach_m_s, made.friction};
    const double approach_m_s = -dot(motion.velocity_at(point.point_m), point.normal);
    if (approach_m_s > bounce_threshold_m_s_) contacts[k].wanted_m_s = made.bounce * approach_m_s;
    lands |= made.bounces;
  }
  const auto without = body.without_contacts(gravity_m_s2_, part_.length_s);
  const double softness = dWorldGetCFM(world_) / part_.length_s;
  if (!solve_fixed_contacts(without, contacts, softness, lands, impulses_ns)) {
    return false;
  }
  for (std::size_t k = 0; k < points.size(); ++k) points_[points[k]].impulse_ns = impulses_ns[k];
  return true;
}

void ContactJoints::push_lone_bodies() {
  for (const std::size_t k : lone_) {
    const ContactPoint& point = points_[k];
    made_[k].body->add_force((1 / part_.length_s) * point.impulse_ns,
                             point.point_m - point.motions->of_body.position_m);
  }
}

// Without a bound, ODE bounds friction by the coefficient times the contact's normal force without friction. With a
// bound, `mu` is used as the maximum force.
void ContactJoints::join(std::size_t point, std::optional<double> bound_n) {
  const Contact& made = made_[point];
  const ContactPoint& at = points_[point];
  dContact contact{};
  copy(at.point_m, contact.geom.pos);
  copy(at.normal, contact.geom.normal);
  contact.geom.depth = at.depth_m;
  contact.geom.g1 = made.body->shape.geom.get();
  contact.geom.g2 = made.other->shape.geom.get();
  contact.surface.mode = dContactBounce;
  contact.surface.bounce = made.bounce;
  contact.surface.bounce_vel = bounce_threshold_m_s_;
  contact.surface.mu = bound_n.value_or(made.friction);
  if (!bound_n) contact.surface.mode |= dContactApprox1;
  if (made.friction > 0) {
    contact.surface.mode |= dContactFDir1;
    copy(made.along, contact.fdir1);
  }
  if (at.depth_m < 0) {  // may come as close as this
    contact.geom.depth = 0;
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = -made.may_approach_m_s;
  }
  if (!solver_pushes_ && !pushed_by_ode(*made.body, *made.other)) {
    contact.geom.depth = std::min(contact.geom.depth, kContactLayer_m);
  }
  dxJoint* joint = dJointCreateContact(world_, joints_.get(), &contact);
  dJointAttach(joint, made.body->body.get(), made.other->body.get());
  dJointSetFeedback(joint, &room_->joints[point]);
}

void ContactJoints::settle_all_but_landing(Islands& islands) const {
  std::vector<bool> lands(islands.members().size());
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    const Contact& made = made_[k];
    if (is_open(k, islands) && made.bounces && made.friction > 0) lands[islands.number_of(*made.body)] = true;
  }
  for (const Collider* member : islands.members()) {
    if (!lands[islands.number_of(*member)]) islands.settle(*member);
  }
}

bool ContactJoints::bound_friction(FrictionRounds& rounds, Islands& islands) {
  dJointGroupEmpty(joints_.get());
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    if (!is_open(k, islands)) continue;
    const double normal_ns = dot(points_[k].impulse_ns, points_[k].normal);
    const double asked_n = made_[k].friction * std::max(normal_ns, 0.0) / part_.length_s;
    rounds.meet(k - part_.first_point, islands.number_of(*made_[k].body), asked_n);
  }
  rounds.end_round();
  bool any = false;
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    if (!is_open(k, islands)) continue;
    const std::size_t island = islands.number_of(*made_[k].body);
    if (rounds.ended(island)) {
      islands.settle(*made_[k].body);
    } else {
      join(k, rounds.bound_n(k - part_.first_point, island));
      any = true;
    }
  }
  return any;
}

void ContactJoints::read_impulses(const Islands& islands) {
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    if (is_open(k, islands)) points_[k].impulse_ns = part_.length_s * to_vec3(room_->joints[k].f1);
  }
}

void ContactJoints::move_bodies_apart(const Islands& islands) {
  if (solver_pushes_) return;
  std::vector<Overlap> overlaps;
  const auto ask = [&](Collider& body, Collider& other, const ContactPoint& point) {
    const double max_m_s = is_hull(body) || is_hull(other) ? kMaxWayOut_m_s : kMaxCorrection_m_s;
    overlaps.push_back({&body, &other, &point, max_m_s * part_.length_s});
  };
  for (const Further& further : further_) ask(*further.body, *further.other, further.point);
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    const Contact& made = made_[k];
    if (!pushed_by_ode(*made.body, *made.other)) ask(*made.body, *made.other, points_[k]);
  }
  partings_.limit(overlaps, part_.length_s);
  move_apart(overlaps, {kContactLayer_m, dWorldGetERP(world_)}, islands, gravity_m_s2_);
}

void ContactJoints::recall(const Memory& memory) {
  partings_ = memory.partings;
  loads_ = memory.loads;
  pairs_ = memory.pairs;
}

// Reduces each impulse to its impact's, and keeps the loads for the rolling resistance of the next part.
void ContactJoints::end_part() {
  for (std::size_t k = part_.first_point; k < points_.size(); ++k) {
    points_[k].impulse_ns = made_[k].impact_share * points_[k].impulse_ns;
  }
  loads_.set(part_points(), part_.length_s);
  pairs_.end_part();
  dJointGroupEmpty(joints_.get());
}

}  // namespace ringdown::scene

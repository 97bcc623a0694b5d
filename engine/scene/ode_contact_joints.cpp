#include "engine/scene/ode_contact_joints.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

// Two limits hold for meshes: the cosine of the largest angle between normals that agree, and how far meshes overlap at
// rest.
constexpr double kAgree = 0.7, kRestOverlap_m = 1e-4;

Vec3 to_vec3(const dReal* v) { return {v[0], v[1], v[2]}; }

// Moves the deepest contact to the front, then each time the one farthest from those already chosen.
std::size_t choose_contacts(std::span<dContactGeom> found) {
  if (found.size() <= kMaxContactsPerPair) return found.size();
  std::ranges::iter_swap(found.begin(), std::ranges::max_element(found, {}, &dContactGeom::depth));
  for (std::size_t chosen = 1; chosen < kMaxContactsPerPair; ++chosen) {
    const auto distance = [&](const dContactGeom& candidate) {
      double nearest = dInfinity;
      for (const dContactGeom& taken : found.first(chosen)) {
        nearest = std::min(nearest, length(to_vec3(candidate.pos) - to_vec3(taken.pos)));
      }
      return nearest;
    };
    std::ranges::iter_swap(found.begin() + static_cast<std::ptrdiff_t>(chosen),
                           std::ranges::max_element(found.subspan(chosen), {}, distance));
  }
  return kMaxContactsPerPair;
}

// A contact for every corner of the box below the plane, with the normal out of the plane. ODE itself finds at most
// four; for a thin plate that overlaps the plane these are the corners of one edge, about which the plate then rocks.
int box_on_plane(dxGeom* box, dxGeom* plane, std::span<dContactGeom> found) {
  dVector3 size;
  dVector4 half_space;
  dGeomBoxGetLengths(box, size);
  dGeomPlaneGetParams(plane, half_space);
  const Vec3 normal = to_vec3(half_space);
  int count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return (corner >> axis & 1 ? 0.5 : -0.5) * size[axis]; };
    dVector3 point;
    dGeomGetRelPointPos(box, side(0), side(1), side(2), point);
    const double depth = half_space[3] - dot(normal, to_vec3(point));
    if (depth < 0) continue;
    dContactGeom& contact = found[count++];
    contact = {};
    std::copy_n(point, 3, contact.pos);
    std::copy_n(half_space, 3, contact.normal);
    contact.depth = depth;
    contact.g1 = box;
    contact.g2 = plane;
  }
  return count;
}

PosedFaces posed_faces(dxGeom* geom) {
  const dReal* r = dGeomGetRotation(geom);
  const Matrix3 turn{{{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}}};
  return {static_cast<const Collider*>(dGeomGetData(geom))->shape.faces, turn, to_vec3(dGeomGetPosition(geom))};
}

// ODE finds one contact point of two hulls. Where faces of the hulls lie on each other, replaces it by the corners of
// the polygon that the faces share; returns the number of points.
int spread(std::span<dContactGeom> found) {
  const dContactGeom one = found.front();
  const FaceContact shared = share_of_faces(posed_faces(one.g1), posed_faces(one.g2), to_vec3(one.normal));
  const std::size_t count = std::min(shared.points.size(), found.size());
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [point, depth] = shared.points[k];
    found[k] = one;
    found[k].depth = depth;
    for (int axis = 0; const double part : {point.x, point.y, point.z}) found[k].pos[axis++] = part;
    for (int axis = 0; const double part : {shared.normal.x, shared.normal.y, shared.normal.z}) {
      found[k].normal[axis++] = part;
    }
  }
  return std::max(static_cast<int>(count), 1);
}

bool are_hulls(int one, int two) {
  const bool solid = (one == dConvexClass || one == dBoxClass) && (two == dConvexClass || two == dBoxClass);
  return solid && (one == dConvexClass || two == dConvexClass);  // of two boxes ODE finds all contacts
}

Vec3 velocity_at(dxGeom* geom, const dReal* point) {
  dxBody* body = dGeomGetBody(geom);
  if (!body) return {};
  dVector3 velocity;
  dBodyGetPointVel(body, point[0], point[1], point[2], velocity);
  return to_vec3(velocity);
}

// Removes false contacts of two meshes. ODE tests every pair of triangles, and gives each contact the shortest way out
// of the other triangle's plane: for two plates on each other also sideways ways, as long as the plates are wide. A
// contact is false if a contact within its own depth has less than half of that depth. It is also false if its normal
// disagrees with that of the shallowest contact, and it is deeper than that contact and the bodies' approach since the
// last step can explain.
std::size_t drop_false(std::span<dContactGeom> found, double part_s) {
  if (found.empty()) return 0;
  const dContactGeom least = *std::ranges::min_element(found, {}, &dContactGeom::depth);
  const auto is_false = [&](const dContactGeom& contact) {
    const bool shallower_nearby = std::ranges::any_of(found, [&](const dContactGeom& better) {
      const Vec3 way = to_vec3(better.pos) - to_vec3(contact.pos);
      return better.depth < 0.5 * contact.depth && dot(way, way) <= contact.depth * contact.depth;
    });
    if (shallower_nearby) return true;
    const Vec3 normal = to_vec3(contact.normal);
    if (dot(normal, to_vec3(least.normal)) > kAgree) return false;
    const Vec3 apart = velocity_at(contact.g1, contact.pos) - velocity_at(contact.g2, contact.pos);
    const double came_in_m = 2 * part_s * std::max(-dot(apart, normal), 0.0);
    return contact.depth > 2 * least.depth + kRestOverlap_m + came_in_m;
  };
  std::array<bool, kMaxContactsFound> out{};
  for (std::size_t k = 0; k < found.size(); ++k) out[k] = is_false(found[k]);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!out[k]) found[kept++] = found[k];
  }
  return kept;
}

int find_all(dxGeom* first, dxGeom* second, std::span<dContactGeom> found, double part_s) {
  const int one = dGeomGetClass(first), two = dGeomGetClass(second);
  if (one == dBoxClass && two == dPlaneClass) return box_on_plane(first, second, found);
  if (one != dPlaneClass || two != dBoxClass) {
    const int count = dCollide(first, second, kMaxContactsFound, found.data(), sizeof(dContactGeom));
    if (count > 0 && are_hulls(one, two)) return spread(found);
    if (one == dTriMeshClass && two == dTriMeshClass) {
      return static_cast<int>(drop_false(found.first(static_cast<std::size_t>(count)), part_s));
    }
    return count;
  }
  const int count = box_on_plane(second, first, found);
  for (dContactGeom& contact : found.first(static_cast<std::size_t>(count))) {
    for (int k = 0; k < 3; ++k) contact.normal[k] = -contact.normal[k];
    std::swap(contact.g1, contact.g2);
  }
  return count;
}

// Finds at most kMaxContactsPerPair contacts of two geometries: the deepest, and those farthest from each other.
// Normals point into the first. `room` holds kMaxContactsFound entries; the result is a part of it. `part_s` is how
// long the bodies have moved since contacts were last looked for. The user data of both geometries is their Collider.
std::span<dContactGeom> find_contacts(dxGeom* first, dxGeom* second, std::span<dContactGeom> room, double part_s) {
  const auto found = room.first(static_cast<std::size_t>(find_all(first, second, room, part_s)));
  return found.first(choose_contacts(found));
}

// Below this speed the direction of sliding is noise.
constexpr double kMinSlip_m_s = 1e-6;

// ODE's friction acts along two directions, each up to its limit. With the first one along the sliding, or the rolling
// where nothing slides, both together obey Coulomb's cone.
void set_friction_direction(dContact& contact, const Motion& of_body, const Motion& of_other, Vec3 approach) {
  const Vec3 normal = to_vec3(contact.geom.normal);
  Vec3 along = approach - dot(approach, normal) * normal;
  if (length(along) < kMinSlip_m_s) along = cross(of_body.spin_rad_s - of_other.spin_rad_s, normal);
  const double speed = length(along);
  if (speed < kMinSlip_m_s) return;
  contact.surface.mode |= dContactFDir1;
  for (int k = 0; const double component : {along.x, along.y, along.z}) contact.fdir1[k++] = component / speed;
}

}  // namespace

struct ContactJoints::Joint {
  dContact contact{};
  dxBody *body = nullptr, *other = nullptr;
  double friction = 0;   // coefficient
  bool bounces = false;  // between bodies of which none is a sphere
};

struct ContactJoints::Touching {
  Collider &body, &other;  // `body` can move
  Motion of_body, of_other;
  SurfacePair surface;
};

struct ContactJoints::Feedback {
  std::array<dContactGeom, kMaxContactsFound> found{};  // of one pair of geometries
  std::vector<dJointFeedback> joints{kMaxContactsPerStep};
};

void ContactJoints::JointGroupDeleter::operator()(dxJointGroup* joints) const { dJointGroupDestroy(joints); }

ContactJoints::ContactJoints(dxWorld* world, const SceneDescription& scene)
    : world_(world),
      bounce_threshold_m_s_(bounce_threshold(scene)),
      gravity_m_s2_(scene.gravity_m_s2),
      joints_(dJointGroupCreate(0)),
      feedback_(std::make_unique<Feedback>()),
      impact_shares_(kMaxContactsPerStep) {
  points_.reserve(kMaxContactsPerStep);
}

ContactJoints::~ContactJoints() = default;

void ContactJoints::begin_step() {
  points_.clear();
  dropped_ = 0;
}

void ContactJoints::begin_part(double found_s, double part_s) {
  found_s_ = found_s;
  part_s_ = part_s;
  part_begin_ = points_.size();
  bounds_n_.clear();
  lands_aslant_ = false;
  dropped_before_ = dropped_;
}

void ContactJoints::collide(dxGeom* first, dxGeom* second, Islands& islands) {
  Collider* a = static_cast<Collider*>(dGeomGetData(first));
  Collider* b = static_cast<Collider*>(dGeomGetData(second));
  if (!a->awake() && !b->awake()) return;
  if (points_.size() == kMaxContactsPerStep) {  // a thousand meshes in one place have half a million pairs
    ++dropped_;
    return;
  }
  const std::span<dContactGeom> points = find_contacts(first, second, feedback_->found, part_s_);
  const bool swap = !a->movable();  // the first body of a joint must be one that moves
  Collider &body = swap ? *b : *a, &other = swap ? *a : *b;
  if (points.empty()) return;
  Touching pair{body, other, body.motion(), other.motion(), combine(body.surface, other.surface)};
  pair.surface.restitution *= std::min(body.elasticity, other.elasticity);
  for (dContactGeom& geom : points) {
    if (swap) {
      for (int k = 0; k < 3; ++k) geom.normal[k] = -geom.normal[k];
      std::swap(geom.g1, geom.g2);
    }
    add(pair, geom, islands);
  }
  // Several contact points of bodies with edges resist rolling by themselves.
  if (points.size() > 1 && !a->round && !b->round) return;
  const double limit_nm = pair.surface.rolling_m * loads_.of_n(body.id, other.id);
  if (limit_nm == 0 || points_.empty()) return;
  const ContactPoint& last = points_.back();
  resist_rolling(body, other, last.point_m, last.normal, limit_nm, gravity_m_s2_, part_s_);
}

// The speed at which ODE will push two bodies apart that overlap by `depth_m`.
double ContactJoints::push_speed(double depth_m) const {
  const double out_m_s = dWorldGetERP(world_) * std::max(depth_m - kContactLayer_m, 0.0) / part_s_;
  return std::min(out_m_s, kMaxCorrection_m_s);
}

// Corrects the bounce of a body that has reached a fixed surface within this part.
Landing ContactJoints::land(const Collider& other, double restitution, double approach_m_s,
                            const dContactGeom& geom) const {
  const bool lands = approach_m_s > bounce_threshold_m_s_ && geom.depth <= approach_m_s * part_s_;
  if (other.movable() || !lands) return {restitution, approach_m_s};
  return corrected_landing({.restitution = restitution,
                            .approach_m_s = approach_m_s,
                            .fall_m_s2 = -dot(gravity_m_s2_, to_vec3(geom.normal)),
                            .depth_m = geom.depth,
                            .part_s = part_s_,
                            .threshold_m_s = bounce_threshold_m_s_,
                            .pushed_m_s = push_speed(geom.depth)});
}

// Adds one contact point with its joint. The normal of `geom` points into the body that can move.
void ContactJoints::add(const Touching& pair, const dContactGeom& geom, Islands& islands) {
  if (points_.size() == kMaxContactsPerStep) {
    ++dropped_;
    return;
  }
  const auto& [body, other, of_body, of_other, surface] = pair;
  const Vec3 point = to_vec3(geom.pos), normal = to_vec3(geom.normal);
  const Vec3 approach = of_other.velocity_at(point) - of_body.velocity_at(point);
  const double approach_m_s = dot(approach, normal);
  const Landing landing = land(other, surface.restitution, approach_m_s, geom);
  made_.resize(points_.size());
  Joint& made = made_.emplace_back();
  made.contact.geom = geom;
  made.contact.surface.mode = dContactBounce | dContactApprox1;
  made.contact.surface.mu = surface.friction;
  made.contact.surface.bounce = landing.bounce;
  made.contact.surface.bounce_vel = bounce_threshold_m_s_;
  set_friction_direction(made.contact, of_body, of_other, approach);
  made.body = body.body.get();
  made.other = other.body.get();
  made.friction = surface.friction;
  made.bounces = approach_m_s > bounce_threshold_m_s_ && !body.round && !other.round;
  lands_aslant_ |= made.bounces && made.friction > 0;
  join(points_.size(), std::nullopt);
  impact_shares_[points_.size()] = landing.share;
  const double pushed_m_s = push_speed(geom.depth);
  const double leaves_m_s = approach_m_s > bounce_threshold_m_s_ ? landing.bounce * approach_m_s : 0;
  islands.unite(body, other, pushed_m_s > leaves_m_s ? pushed_m_s : 0, leaves_m_s > 0);
  points_.push_back(
      {body.id, other.id, point, normal, geom.depth, {}, landing.approach_m_s, found_s_, of_body, of_other});
}

// Without a bound, ODE bounds friction by the impulse that the contact would have without friction. With one, `mu` is
// taken for the largest force.
void ContactJoints::join(std::size_t point, std::optional<double> bound_n) {
  const Joint& made = made_[point];
  dxJoint* joint = nullptr;
  if (bound_n) {
    dContact contact = made.contact;
    contact.surface.mode &= ~dContactApprox1;
    contact.surface.mu = *bound_n;
    joint = dJointCreateContact(world_, joints_.get(), &contact);
  } else {
    joint = dJointCreateContact(world_, joints_.get(), &made.contact);
  }
  dJointAttach(joint, made.body, made.other);
  dJointSetFeedback(joint, &feedback_->joints[point]);
}

double ContactJoints::bound_friction() {
  const std::size_t count = points_.size() - part_begin_;
  const bool first = bounds_n_.size() != count;
  if (first) bounds_n_.assign(count, 0);
  double largest = 0, change = 0;
  dJointGroupEmpty(joints_.get());
  for (std::size_t k = 0; k < count; ++k) {
    const ContactPoint& point = points_[part_begin_ + k];
    const double bound = made_[part_begin_ + k].friction * std::max(dot(point.impulse_ns, point.normal), 0.0) / part_s_;
    largest = std::max(largest, bound);
    change = std::max(change, std::abs(bound - bounds_n_[k]));
    bounds_n_[k] = bound;
    join(part_begin_ + k, bound);
  }
  return first ? 1 : change / std::max(largest, 1e-30);
}

void ContactJoints::free_friction() {
  dJointGroupEmpty(joints_.get());
  for (std::size_t k = part_begin_; k < points_.size(); ++k) join(k, std::nullopt);
}

void ContactJoints::read_impulses() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = part_s_ * to_vec3(feedback_->joints[k].f1);
  }
}

void ContactJoints::undo_part() {
  dJointGroupEmpty(joints_.get());
  bounds_n_.clear();
  lands_aslant_ = false;
  points_.resize(part_begin_);
  dropped_ = dropped_before_;
}

// Reduces each impulse to its impact's, and keeps the loads for the rolling resistance of the next part.
void ContactJoints::end_part() {
  for (std::size_t k = part_begin_; k < points_.size(); ++k) {
    points_[k].impulse_ns = impact_shares_[k] * points_[k].impulse_ns;
  }
  loads_.set(part_points(), part_s_);
  dJointGroupEmpty(joints_.get());
}

}  // namespace ringdown::scene

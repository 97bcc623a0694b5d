#include "engine/breaking/collision.h"

#include "engine/base/rotation.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

// One step
//
// A force f that is constant over the step h moves mode m, with the exponent p = -d + i omega, by
//
//   a <- e^{ph} a + (phi f) g,      g = -i/omega (e^{ph} - 1) / p,
//
// exactly, and a rigid motion by f h^2/2. The change of depth at point i is what both bodies do without forces, less
// Z_ij f_j with Z_ij = A_ij h^2/2 + sum_m phi_im phi_jm Re g_m, where A is the inverse mass of both rigid motions. The
// network's forces are passive for this line.
namespace ringdown::breaking {
namespace {

using Complex = std::complex<double>;

// The step follows the shortest contact time that the springs give without bending, and the fastest mode.
constexpr double kStepsOfContact = 24, kStepsOfPeriod = 6, kShortest_s = 5e-7, kLongest_s = 1e-5;

double hertz_time_s(const MeetingPoint& point, double per_kg) {
  const double speed = std::max(point.closing_m_s, 1e-3);
  const double depth = std::pow(1.25 * speed * speed / (per_kg * point.law.stiffness), 0.4);
  return 2.94 * depth / speed;
}

}  // namespace

Collision::Collision(const modal::StrikeMap& map, const modal::MaterialScale& material, const modal::ModalState& before,
                     const Meeting& meeting)
    : points_(meeting.points), state_(before), contacts_(meeting.points.size()) {
  const std::size_t count = points_.size(), modes = state_.modes.size();
  assert(0 < count && count <= contact::kMaxContacts);
  assert(meeting.other_per_kg.empty() || meeting.other_per_kg.size() == count * count);
  state_.velocity_m_s = state_.spin_rad_s = {};
  const modal::MassProperties& mass = state_.mass;
  const Rotation axes = Rotation::from_xyzw(mass.orientation);
  const Vec3& inertia = mass.inertia_kg_m2;
  for (const MeetingPoint& point : points_) {
    const Vec3 moment = rotated(inverse(axes), cross(point.point_m - mass.center_of_mass_m, point.normal));
    rigid_turn_.push_back(rotated(axes, Vec3{moment.x / inertia.x, moment.y / inertia.y, moment.z / inertia.z}));
    closing_m_s_.push_back(point.closing_m_s);
    std::vector<double> shape(modes);
    map.excite((1 / material.size) * point.point_m, point.normal, shape);
    for (const double one : shape) shapes_.push_back(modal::shape_factor(material) * one);
  }
  per_kg_ = meeting.other_per_kg.empty() ? std::vector<double>(count * count) : meeting.other_per_kg;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 turned = cross(points_[i].point_m - mass.center_of_mass_m, points_[i].normal);
    for (std::size_t j = 0; j < count; ++j)
      per_kg_[i * count + j] += dot(points_[i].normal, points_[j].normal) / mass.mass_kg + dot(turned, rigid_turn_[j]);
  }

  step_s_ = kLongest_s;
  for (std::size_t i = 0; i < count; ++i)
    step_s_ = std::min(step_s_, hertz_time_s(points_[i], per_kg_[i * count + i]) / kStepsOfContact);
  for (const modal::DampedMode& mode : state_.modes) {
    if (mode.frequency_hz > 0) step_s_ = std::min(step_s_, 1 / (kStepsOfPeriod * mode.frequency_hz));
  }
  step_s_ = std::max(step_s_, kShortest_s);

  for (const modal::DampedMode& mode : state_.modes) {
    const double omega = modal::hz_to_rad_per_s(mode.frequency_hz);
    const Complex p(-mode.decay_per_s, omega), turn = omega > 0 ? std::exp(p * step_s_) : 1.0;
    const Complex push = omega > 0 ? Complex(0, -1 / omega) * (turn - 1.0) / p : 0.0;
    turn_re_.push_back(turn.real()), turn_im_.push_back(turn.imag());
    push_re_.push_back(push.real()), push_im_.push_back(push.imag());
  }
  for (std::size_t i = 0; i < count; ++i) {
    contacts_[i].impact = points_[i].law;
    contacts_[i].pressed.place(-points_[i].gap_m);
    [[maybe_unused]] const auto freedom = network_.add(contacts_[i]);
    assert(freedom == i);
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double compliance = 0.5 * step_s_ * step_s_ * per_kg_[i * count + j];
      for (std::size_t m = 0; m < modes; ++m)
        compliance += shapes_[i * modes + m] * shapes_[j * modes + m] * push_re_[m];
      network_.set_compliance(i, j, compliance);
    }
  }
}

void Collision::step() {
  const std::size_t count = points_.size(), modes = state_.modes.size();
  std::array<double, contact::kMaxContacts> free{}, force{};
  for (std::size_t i = 0; i < count; ++i) free[i] = closing_m_s_[i] * step_s_;
  for (std::size_t m = 0; m < modes; ++m) {
    Complex& a = state_.amplitudes[m];
    const double re = turn_re_[m] * a.real() - turn_im_[m] * a.imag();
    const double moved = re - a.real();
    a = {re, turn_re_[m] * a.imag() + turn_im_[m] * a.real()};
    for (std::size_t i = 0; i < count; ++i) free[i] -= shapes_[i * modes + m] * moved;
  }
  time_s_ += step_s_;
  force_n_ = 0;
  if (network_.step(std::span(free).first(count), step_s_, std::span(force).first(count)))
    push(std::span(force).first(count));
}

void Collision::push(std::span<const double> force_n) {
  const std::size_t count = points_.size(), modes = state_.modes.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (force_n[i] == 0) continue;
    const double impulse_ns = force_n[i] * step_s_;
    force_n_ += force_n[i];
    pushed_ns_ += impulse_ns;
    for (std::size_t j = 0; j < count; ++j) closing_m_s_[j] -= per_kg_[j * count + i] * impulse_ns;
    state_.velocity_m_s = state_.velocity_m_s + (impulse_ns / state_.mass.mass_kg) * points_[i].normal;
    state_.spin_rad_s = state_.spin_rad_s + impulse_ns * rigid_turn_[i];
    for (std::size_t m = 0; m < modes; ++m) {
      const double along = shapes_[i * modes + m] * force_n[i];
      state_.amplitudes[m] += Complex(along * push_re_[m], along * push_im_[m]);
    }
  }
  if (force_n_ > 0) last_touch_s_ = time_s_;
}

bool Collision::is_over() const { return time_s_ > last_touch_s_ + kApart_s || time_s_ >= kMax_s; }

}  // namespace ringdown::breaking

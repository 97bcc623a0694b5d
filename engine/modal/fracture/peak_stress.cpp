#include "engine/modal/fracture/peak_stress.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

// Instants are taken eight at a time: the coordinates of all modes at eight instants are a table of M x 8 numbers,
// whose product with the three rows of a point gives the point's stress at these instants. Principal stress in a plane:
// (s11 + s22) / 2 + ((s11 - s22)^2 / 4 + s12^2)^1/2.
namespace ringdown::modal {
namespace {

constexpr std::size_t kInstants = 8;
using AtInstants = std::array<float, kInstants>;

// Returns the state `time_s` after the present, with what the blow has done until then.
ModalState state_at(const ModalState& state, const Blow* blow, double time_s) {
  ModalState then = state;
  advance(then, time_s);
  if (blow == nullptr) return then;
  if (time_s <= blow->contact_time_s) {
    add_begun_blow(then, *blow, time_s);
    return then;
  }
  ModalState alone = at_rest(state.modes, state.mass);
  add_begun_blow(alone, *blow, blow->contact_time_s);
  advance(alone, time_s - blow->contact_time_s);
  for (std::size_t j = 0; j < then.amplitudes.size(); ++j) then.amplitudes[j] += alone.amplitudes[j];
  return then;
}

std::vector<double> instants_of(const Blow* blow, const StressSearch& search) {
  std::vector<double> times;
  const double contact_s = blow == nullptr ? 0 : blow->contact_time_s;
  if (contact_s > 0) {
    for (int i = 1; i < search.instants_during; ++i) times.push_back(contact_s * i / search.instants_during);
  }
  const double step_s = search.after_s / std::max(search.instants_after - 1, 1);
  for (int i = 0; i < search.instants_after; ++i) times.push_back(contact_s + step_s * i);
  return times;
}

// Sums a row of the table times the coordinates, for all instants of a batch.
AtInstants at_instants(const float* row, const std::vector<AtInstants>& coordinates) {
  AtInstants sums{};
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    for (std::size_t i = 0; i < kInstants; ++i) sums[i] += row[j] * coordinates[j][i];
  }
  return sums;
}

bool is_spared(const Vec3f& point, std::span<const Vec3> places_m, double radius_m) {
  const Vec3 at{static_cast<double>(point[0]), static_cast<double>(point[1]), static_cast<double>(point[2])};
  return std::ranges::any_of(places_m, [&](const Vec3& place) { return length(at - place) < radius_m; });
}

// Calls visit(point, instant, stress) for the principal stress at all points that are not spared, where it is tensile.
template <class Visit>
void for_each_stress(const StressTable& table, const std::vector<AtInstants>& coordinates, std::size_t instants,
                     std::span<const Vec3> spared_m, double radius_m, const Visit& visit) {
  const std::size_t modes = coordinates.size();
  for (std::size_t p = 0; p < table.positions.size(); ++p) {
    if (is_spared(table.positions[p], spared_m, radius_m)) continue;
    const float* row = &table.stress[3 * p * modes];
    const AtInstants s11 = at_instants(row, coordinates), s22 = at_instants(row + modes, coordinates),
                     s12 = at_instants(row + 2 * modes, coordinates);
    for (std::size_t i = 0; i < instants; ++i) {
      const float principal = (s11[i] + s22[i]) / 2 + std::hypot((s11[i] - s22[i]) / 2, s12[i]);
      if (principal > 0) visit(p, i, principal);
    }
  }
}

}  // namespace

double stress_factor(const MaterialScale& scale) {
  return scale.stiffness / (std::sqrt(scale.density) * std::pow(scale.size, 2.5));
}

double stress_bound_pa(const StressTable& table, const ModalState& state, const Blow* blow) {
  assert(table.largest.size() == state.modes.size());
  double bound = 0;
  for (std::size_t j = 0; j < state.modes.size(); ++j) {
    double amplitude = std::abs(state.amplitudes[j]);
    const double omega = hz_to_rad_per_s(state.modes[j].frequency_hz);
    if (blow != nullptr && omega > 0) {
      const double angle = omega * blow->contact_time_s;
      amplitude += std::abs(blow->modal_impulse[j]) / omega * (angle > std::numbers::pi ? std::numbers::pi / angle : 1);
    }
    bound += amplitude * static_cast<double>(table.largest[j]);
  }
  return bound;
}

PeakStress peak_stress(const StressTable& table, const ModalState& state, const Blow* blow,
                       const StressSearch& search) {
  const std::size_t modes = state.modes.size();
  assert(table.stress.size() == 3 * table.positions.size() * modes);
  PeakStress peak;
  float largest = 0;
  const std::vector<double> times = instants_of(blow, search);
  for (std::size_t first = 0; first < times.size(); first += kInstants) {
    const std::size_t count = std::min(kInstants, times.size() - first);
    std::vector<AtInstants> coordinates(modes, AtInstants{});
    for (std::size_t i = 0; i < count; ++i) {
      const ModalState then = state_at(state, blow, times[first + i]);
      for (std::size_t j = 0; j < modes; ++j)
        coordinates[j][i] = static_cast<float>(motion_of(then.modes[j], then.amplitudes[j]).coordinate);
    }
    for_each_stress(table, coordinates, count, std::span(&search.spared_m, 1), search.spared_radius_m,
                    [&](std::size_t point, std::size_t i, float stress) {
                      if (stress <= largest) return;
                      largest = stress;
                      peak = {.stress_pa = static_cast<double>(stress), .point = point, .time_s = times[first + i]};
                    });
  }
  return peak;
}

std::optional<PeakStress> first_reaching(const StressTable& table, const MotionSamples& samples, double stress_pa,
                                         std::span<const Vec3> spared_m, double spared_radius_m) {
  const std::size_t modes = table.largest.size();
  assert(samples.coordinates.size() == samples.times_s.size() * modes);
  for (std::size_t first = 0; first < samples.times_s.size(); first += kInstants) {
    const std::size_t count = std::min(kInstants, samples.times_s.size() - first);
    std::vector<AtInstants> coordinates(modes, AtInstants{});
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < modes; ++j) coordinates[j][i] = samples.coordinates[(first + i) * modes + j];
    }
    std::optional<PeakStress> earliest;
    for_each_stress(table, coordinates, count, spared_m, spared_radius_m,
                    [&](std::size_t point, std::size_t i, float stress) {
                      const double pa = static_cast<double>(stress), time_s = samples.times_s[first + i];
                      if (pa < stress_pa || (earliest && earliest->time_s < time_s)) return;
                      if (earliest && earliest->time_s == time_s && earliest->stress_pa >= pa) return;
                      earliest = PeakStress{.stress_pa = pa, .point = point, .time_s = time_s};
                    });
    if (earliest) return earliest;
  }
  return {};
}

}  // namespace ringdown::modal

#include "clients/cli/picture/answer.h"

#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace ringdown::cli {
namespace {

constexpr double kMinDecay = 0.1;  // for what a bank says rings for ever

double energy(const modal::Bank& bank, std::size_t point, Vec3 direction) {
  double sum = 0;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double a = modal::hz_to_rad_per_s(bank.frequency_hz[m]) * dot(wide(bank.shape(m, point)), direction);
    sum += a * a / std::max(bank.decay_per_s[m], kMinDecay);
  }
  return sum;
}

Vec3 direction_at(const modal::Bank& bank, std::size_t point, Vec3 normal) {
  if (length(normal) > 0) return -1.0 * normal;
  const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return *std::ranges::max_element(axes, {}, [&](Vec3 axis) { return energy(bank, point, axis); });
}

}  // namespace

std::vector<Vec3> normals_of(const modal::Bank& bank) {
  std::vector<Vec3> normals(bank.point_count());
  for (const auto& [a, b, c] : bank.triangles) {
    const Vec3 p = wide(bank.positions[a]);
    const Vec3 n = cross(wide(bank.positions[b]) - p, wide(bank.positions[c]) - p);
    for (const auto corner : {a, b, c}) normals[corner] = normals[corner] + n;
  }
  for (Vec3& n : normals) {
    const double size = length(n);
    n = size > 0 ? (1 / size) * n : Vec3{};
  }
  return normals;
}

Answer answer_of(const modal::Bank& bank, std::optional<Vec3> at) {
  const std::vector<Vec3> normals = normals_of(bank);
  Answer answer;
  double best = -1;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const double score =
        at ? 1 / (1e-12 + length(wide(bank.positions[p]) - *at)) : energy(bank, p, direction_at(bank, p, normals[p]));
    if (score > best) {
      best = score;
      answer.point = p;
    }
  }
  answer.direction = direction_at(bank, answer.point, normals[answer.point]);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    answer.amplitude.push_back(modal::hz_to_rad_per_s(bank.frequency_hz[m]) *
                               dot(wide(bank.shape(m, answer.point)), answer.direction));
  }
  return answer;
}

double level_db(const modal::Bank& bank, const Answer& answer, double frequency_hz) {
  const double w = modal::hz_to_rad_per_s(frequency_hz);
  std::complex<double> sum = 0;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double wm = modal::hz_to_rad_per_s(bank.frequency_hz[m]);
    const std::complex<double> s(std::max(bank.decay_per_s[m], kMinDecay), w);
    sum += answer.amplitude[m] * wm / (s * s + wm * wm);
  }
  return 20 * std::log10(std::abs(sum) + 1e-300);
}

}  // namespace ringdown::cli

#include "engine/bake/tuning/mode_family.h"

#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numeric>

// Telling families apart
//
// In the axes of the body, the displacement of every point is fitted by motions of whole cross-sections: each of its
// three components is a polynomial along the body, plus one that grows with the distance across it (bending tilts a
// section, twist turns it). The least-squares fit has the same matrix for all modes, so it is set up once (Sections).
// The energy of each part of the fit over that of the motion is the part's share; the family with the largest share has
// the mode, if it explains at least half of the motion.
namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::array<std::pair<std::string_view, ModeFamily>, 6> kNames = {{{"vertical", ModeFamily::kVertical},
                                                                            {"lateral", ModeFamily::kLateral},
                                                                            {"torsion", ModeFamily::kTorsion},
                                                                            {"longitudinal", ModeFamily::kLongitudinal},
                                                                            {"other", ModeFamily::kOther},
                                                                            {"any", ModeFamily::kAny}}};

constexpr Index kMaxDegrees = 10;  // of the polynomials along the body
constexpr double kRidge = 1e-3;    // keeps the fit tame where points are few or lie on few sections
constexpr double kEqual = 1.0017;  // 3 cents
constexpr double kMinShare = 0.5;  // of the motion, that a family explains

Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 plain(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// Legendre polynomials of the places along, scaled to [-1, 1]: points x degrees.
MatrixXd polynomials(const VectorXd& along, Index degrees) {
  const double low = along.minCoeff(), high = along.maxCoeff();
  const VectorXd t = (2 * (along.array() - low) / std::max(high - low, 1e-30) - 1).matrix();
  MatrixXd values(along.size(), degrees);
  values.col(0).setOnes();
  if (degrees > 1) values.col(1) = t;
  for (Index n = 2; n < degrees; ++n) {
    const auto k = static_cast<double>(n);
    values.col(n) = ((2 * k - 1) * t.cwiseProduct(values.col(n - 1)) - (k - 1) * values.col(n - 2)) / k;
  }
  return values;
}

// A bank's points in the body's axes, and the fits that all modes share.
class Sections {
 public:
  Sections(const modal::Bank& bank, const BodyAxes& axes) {
    axes_ << eigen(axes.along), eigen(axes.strike), eigen(axes.across);
    const auto count = static_cast<Index>(bank.point_count());
    places_.resize(count, 3);
    for (Index p = 0; p < count; ++p) {
      const modal::Vec3f& at = bank.positions[p];
      places_.row(p) = axes_.transpose() * (Vector3d(at[0], at[1], at[2]) - eigen(axes.centre));
    }
    const Index degrees = std::clamp<Index>(count / 9, 1, kMaxDegrees);
    const MatrixXd basis = polynomials(places_.col(0), degrees);
    // Each component is a motion of the whole section plus one that grows across it: bending tilts the section, twist
    // turns it.
    parts_.resize(count, 3 * degrees);
    parts_ << basis, places_.col(1).asDiagonal() * basis, places_.col(2).asDiagonal() * basis;
    normal_ = dense::transposed_product(parts_, parts_);
    normal_.diagonal() *= 1 + kRidge;
    degrees_ = degrees;
  }

  [[nodiscard]] ModeFamily family_of(const modal::Bank& bank, std::size_t mode) const {
    const Index count = places_.rows(), n = degrees_;
    MatrixXd shape(count, 3);
    for (Index p = 0; p < count; ++p) {
      const modal::Vec3f& u = bank.shape(mode, static_cast<std::size_t>(p));
      shape.row(p) = axes_.transpose() * Vector3d(u[0], u[1], u[2]);
    }
    const MatrixXd fit = dense::solve_symmetric(normal_, dense::transposed_product(parts_, shape));
    const auto energy = [&](int component, int part) {
      return (parts_.middleCols(part * n, n) * fit.col(component).segment(part * n, n)).squaredNorm();
    };
    const std::array shares = {energy(1, 0), energy(2, 0), energy(1, 2) + energy(2, 1), energy(0, 0)};
    const auto largest = std::max_element(shares.begin(), shares.end());
    if (*largest < kMinShare * shape.squaredNorm()) return ModeFamily::kOther;
    return kNames[largest - shares.begin()].second;
  }

 private:
  Eigen::Matrix3d axes_;
  Eigen::MatrixXd places_;  // P x 3: along, strike, across, from the centre
  MatrixXd parts_;          // P x 3 degrees
  MatrixXd normal_;         // of the fit
  Index degrees_ = 1;
};

}  // namespace

std::string_view family_name(ModeFamily family) {
  return std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.second == family; })->first;
}

Result<ModeFamily> parse_family(std::string_view name) {
  for (const auto& [known, family] : kNames) {
    if (known == name && family != ModeFamily::kOther) return family;
  }
  return fail(ErrorKind::bad_input,
              "there is no family of modes '{}'; take vertical, lateral, torsion, longitudinal or any", name);
}

BodyAxes body_axes(const modal::Bank& bank, std::optional<Vec3> strike) {
  const modal::MassProperties& mass = bank.mass.value();
  const auto& q = mass.orientation;
  const Eigen::Matrix3d principal = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  const Vector3d moments = eigen(mass.inertia_kg_m2);
  Index smallest = 0, largest = 0;
  moments.minCoeff(&smallest);
  moments.maxCoeff(&largest);
  const Vector3d along = principal.col(smallest);
  Vector3d up = principal.col(largest == smallest ? (smallest + 1) % 3 : largest);
  if (strike) {
    const Vector3d given = eigen(*strike) - along * along.dot(eigen(*strike));
    if (given.norm() > 1e-6 * eigen(*strike).norm()) up = given.normalized();
  }
  return {mass.center_of_mass_m, plain(along), plain(up), plain(along.cross(up))};
}

std::vector<std::size_t> modes_of(const modal::Bank& bank, const BodyAxes& axes, ModeFamily family) {
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return bank.frequency_hz[a] < bank.frequency_hz[b]; });
  const Sections sections(bank, axes);
  std::vector<std::size_t> found;
  for (const std::size_t mode : order) {
    if (family == ModeFamily::kAny) {
      if (!found.empty() && bank.frequency_hz[mode] < kEqual * bank.frequency_hz[found.back()]) continue;
    } else if (sections.family_of(bank, mode) != family) {
      continue;
    }
    found.push_back(mode);
  }
  return found;
}

}  // namespace ringdown::bake

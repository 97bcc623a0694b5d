#include "engine/shatter/pattern.h"

#include "engine/mesh/boundary.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace ringdown::shatter {
namespace {

constexpr double kImpactRadius = 0.054;  // r0 over the diagonal
constexpr double kRingRatio = 1.6;

// Counts through SplitMix64 (Steele, Lea, Flood, OOPSLA 2014). The distributions of the standard library differ between
// its makers, so numbers are made here.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }  // in [0, 1)
  double around_zero() { return uniform() + uniform() + uniform() - 1.5; }  // standard deviation 0.5

 private:
  std::uint64_t state_;
};

// A body's straight elements as a place to draw points from.
class Wall {
 public:
  explicit Wall(const mesh::TetMesh& body) : body_(body) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index e = 0; e < body.elements.rows(); ++e) {
      const mesh::Corners corners = corners_of(body, e);
      volume_ += std::abs(mesh::jacobian(corners).determinant()) / 6;
      volume_up_to_.push_back(volume_);
      for (int c = 0; c < 4; ++c) box.extend(corners.row(c).transpose());
    }
    center_ = box.center();
    diagonal_m_ = box.diagonal().norm();
    faces_ = mesh::outer_faces(body.elements.leftCols(4));
    for (const mesh::OuterFace& face : faces_) area_ += 0.5 * doubled_area(face).norm();
  }

  [[nodiscard]] const Eigen::Vector3d& center() const { return center_; }
  [[nodiscard]] double diagonal_m() const { return diagonal_m_; }
  [[nodiscard]] double thickness_m() const { return 2 * volume_ / area_; }

  // A point of the body, each part of the volume being as likely.
  Eigen::Vector3d draw(Dice& dice) const {
    const auto above = std::upper_bound(volume_up_to_.begin(), volume_up_to_.end(), dice.uniform() * volume_);
    const auto element = std::min<Eigen::Index>(above - volume_up_to_.begin(), body_.elements.rows() - 1);
    std::array<double, 3> cuts = {dice.uniform(), dice.uniform(), dice.uniform()};
    std::sort(cuts.begin(), cuts.end());
    const Eigen::RowVector4d barycentric(cuts[0], cuts[1] - cuts[0], cuts[2] - cuts[1], 1 - cuts[2]);
    return (barycentric * corners_of(body_, element)).transpose();
  }

  // The direction that the skin around a point faces, either way. Faces near the point count most; the two sides of a
  // wall face along one line and outweigh its rim. Power iteration on the sum of n n^T.
  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& point) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const double near = 0.1 * diagonal_m_;
    for (const mesh::OuterFace& face : faces_) {
      const Eigen::Vector3d doubled = doubled_area(face);
      const double far = (body_.nodes.row(face.corners[0]).transpose() - point).norm() / near;
      if (doubled.norm() > 0) sum += doubled * doubled.transpose() / (doubled.norm() * (1 + std::pow(far, 6)));
    }
    Eigen::Vector3d normal(0.36, 0.48, 0.8);
    for (int k = 0; k < 60; ++k) normal = (sum * normal + 1e-12 * sum.trace() * normal).normalized();
    return normal;
  }

 private:
  [[nodiscard]] Eigen::Vector3d doubled_area(const mesh::OuterFace& face) const {
    const Eigen::RowVector3d a = body_.nodes.row(face.corners[0]);
    const Eigen::Vector3d u = (body_.nodes.row(face.corners[1]) - a).transpose();
    return u.cross((body_.nodes.row(face.corners[2]) - a).transpose());
  }

  const mesh::TetMesh& body_;
  std::vector<double> volume_up_to_;
  double volume_ = 0, area_ = 0, diagonal_m_ = 0;
  Eigen::Vector3d center_;
  std::vector<mesh::OuterFace> faces_;
};

// Seeds that keep apart.
class Planter {
 public:
  Planter(const Wall& wall, std::uint64_t seed, double min_distance_m)
      : wall_(wall), dice_(seed), apart_m_(min_distance_m) {}

  [[nodiscard]] const std::vector<Eigen::Vector3d>& seeds() const { return seeds_; }
  Dice& dice() { return dice_; }

  bool plant(const Eigen::Vector3d& point) {
    for (const Eigen::Vector3d& other : seeds_) {
      if ((other - point).squaredNorm() < apart_m_ * apart_m_) return false;
    }
    seeds_.push_back(point);
    return true;
  }

  // Draws points, keeps each with the probability (r0 / (r0 + r))^2, until there are `count` seeds. After many draws
  // that are too near to others the distance is reduced.
  void fill(std::size_t count, const Eigen::Vector3d& impact, double r0) {
    constexpr int kTries = 500;
    for (int failed = 0; seeds_.size() < count;) {
      const Eigen::Vector3d point = wall_.draw(dice_);
      const double kept = r0 / (r0 + (point - impact).norm());
      if (dice_.uniform() >= kept * kept) continue;
      if (plant(point)) {
        failed = 0;
      } else if (++failed == kTries) {
        apart_m_ *= 0.8;
        failed = 0;
      }
    }
  }

  // Rings around the impact with radii that grow by 1.6 up to the body's farthest point. Each place of the polar grid
  // takes the drawn point that is nearest in angle and in the logarithm of the radius, which is the projection of the
  // place into the wall; places without a point within half a step stay empty.
  void plant_rays(std::size_t count, const Eigen::Vector3d& impact) {
    constexpr int kDrawn = 4000;
    const Eigen::Vector3d normal = wall_.normal_at(impact);
    const Eigen::Vector3d first = normal.unitOrthogonal(), second = normal.cross(first);
    std::vector<Eigen::Vector3d> drawn;
    std::vector<std::array<double, 2>> polar;  // log radius, angle
    double farthest = 0;
    for (int k = 0; k < kDrawn; ++k) {
      drawn.push_back(wall_.draw(dice_));
      const Eigen::Vector3d arm = drawn.back() - impact;
      farthest = std::max(farthest, arm.norm());
      polar.push_back({std::log(std::max(arm.norm(), 1e-9)), std::atan2(arm.dot(second), arm.dot(first))});
    }
    const int rings = std::clamp(static_cast<int>(std::lround(std::sqrt(0.8 * static_cast<double>(count)))), 1, 9);
    const int rays = std::max(1, static_cast<int>(std::lround(static_cast<double>(count) / rings)));
    const double ring_step = std::log(kRingRatio), ray_step = 2 * std::numbers::pi / rays;
    for (int ring = 0; ring < rings; ++ring) {
      const double turn = 0.3 * dice_.uniform();
      for (int ray = 0; ray < rays; ++ray) {
        const double log_radius =
            std::log(0.8 * farthest) - (rings - 1 - ring) * ring_step + std::log1p(0.25 * dice_.around_zero() * 0.5);
        const double angle = (ray + turn + 0.3 * dice_.around_zero()) * ray_step;
        double nearest = 0.5;
        int taken = -1;
        for (int k = 0; k < kDrawn; ++k) {
          const double beside = std::remainder(polar[k][1] - angle, 2 * std::numbers::pi) / ray_step;
          const double distance = std::hypot((polar[k][0] - log_radius) / ring_step, beside);
          if (distance < nearest) {
            nearest = distance;
            taken = k;
          }
        }
        if (taken >= 0 && seeds_.size() < count) plant(drawn[taken]);
      }
    }
  }

  // Puts the seeds in random order (Fisher and Yates), so that the first few are spread as all are.
  void shuffle() {
    for (std::size_t k = seeds_.size(); k > 1; --k) std::swap(seeds_[k - 1], seeds_[dice_.next() % k]);
  }

 private:
  const Wall& wall_;
  Dice dice_;
  double apart_m_;
  std::vector<Eigen::Vector3d> seeds_;
};

// The first seeds are the coarse ones: a seed of a level belongs to the nearest seed of the coarser level.
std::vector<std::vector<std::int32_t>> nested_groups(const std::vector<Eigen::Vector3d>& seeds,
                                                     const std::vector<int>& counts) {
  std::vector<std::vector<std::int32_t>> groups(counts.size(), std::vector<std::int32_t>(seeds.size()));
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    auto group = static_cast<std::int32_t>(k);
    for (std::size_t level = counts.size(); level-- > 0;) {
      double min = std::numeric_limits<double>::max();
      std::int32_t nearest = group;
      for (std::int32_t other = 0; other < counts[level]; ++other) {
        const double distance = (seeds[other] - seeds[group]).squaredNorm();
        if (distance < min) {
          min = distance;
          nearest = other;
        }
      }
      group = groups[level][k] = nearest;
    }
  }
  return groups;
}

Result<void> check(const PatternOptions& options, const Wall& wall) {
  int before = 0;
  for (const int count : options.pieces) {
    if (count <= before || count > kMaxPieces) {
      return fail(ErrorKind::bad_input,
                  "the numbers of pieces must ascend from 1 or more to {} at most; {} after {} does not", kMaxPieces,
                  count, before);
    }
    before = count;
  }
  if (before == 0) return fail(ErrorKind::bad_input, "no number of pieces is given; give one or several, as 4, 14, 48");
  const Vec3& at = options.impact_m;
  if (!is_finite(at) || !((Eigen::Vector3d(at.x, at.y, at.z) - wall.center()).norm() <= wall.diagonal_m())) {
    const std::string place = formatted("({:.6g}, {:.6g}, {:.6g}) m", at.x, at.y, at.z);
    return fail(ErrorKind::bad_input, "the place of impact {} is far from the body; give a point of its surface",
                place);
  }
  return {};
}

}  // namespace

Result<Seeds> make_seeds(const mesh::TetMesh& body, const PatternOptions& options) {
  const Wall wall(body);
  if (auto sound = check(options, wall); !sound) return fail(sound);
  const Eigen::Vector3d impact(options.impact_m.x, options.impact_m.y, options.impact_m.z);
  const auto count = static_cast<std::size_t>(options.pieces.back());
  const bool even = options.pattern == Pattern::kUniform;
  Planter planter(wall, options.seed, options.min_distance_m > 0 ? options.min_distance_m : 1.5 * wall.thickness_m());
  if (options.pattern == Pattern::kRadial) planter.plant_rays(count, impact);
  planter.fill(count, impact, even ? std::numeric_limits<double>::max() : kImpactRadius * wall.diagonal_m());
  if (options.pattern == Pattern::kRadial) planter.shuffle();

  Seeds seeds{mesh::Points(static_cast<Eigen::Index>(count), 3), nested_groups(planter.seeds(), options.pieces)};
  for (std::size_t k = 0; k < count; ++k)
    seeds.points.row(static_cast<Eigen::Index>(k)) = planter.seeds()[k].transpose();
  return seeds;
}

}  // namespace ringdown::shatter

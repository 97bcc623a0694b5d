// The body-centred cubic lattice: the corners and centres of a block of cubes, and the tetrahedra between them.
// [any thread]
//
// A point has whole coordinates in halves of a cube's edge, all even (a corner) or all odd (a centre). An edge joins
// two neighbouring corners or two neighbouring centres (long, one edge of a cube) or a corner and a centre (short,
// sqrt(3)/2 of that). All tetrahedra are alike: two opposite long edges, four short ones, angles of 60 and 90 degrees.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace ringdown::mesh {

class BccLattice {
 public:
  using Place = Eigen::Vector3i;

  BccLattice() = default;
  BccLattice(const Eigen::Vector3d& origin, double size_m, const Eigen::Vector3i& cubes)
      : origin_(origin), size_(size_m), cubes_(cubes) {}

  [[nodiscard]] const Eigen::Vector3i& cubes() const { return cubes_; }
  [[nodiscard]] std::int32_t corner_count() const { return (cubes_.array() + 1).prod(); }
  [[nodiscard]] std::int32_t point_count() const { return corner_count() + cubes_.prod(); }

  [[nodiscard]] bool has(const Place& place) const {
    return (place.array() >= 0).all() && (place.array() <= 2 * cubes_.array()).all();
  }

  [[nodiscard]] std::int32_t number(const Place& place) const {
    const Eigen::Vector3i half = place / 2;
    if (place[0] % 2) return corner_count() + (half[2] * cubes_[1] + half[1]) * cubes_[0] + half[0];
    return (half[2] * (cubes_[1] + 1) + half[1]) * (cubes_[0] + 1) + half[0];
  }

  [[nodiscard]] Place place(std::int32_t number) const {
    const bool centre = number >= corner_count();
    const Eigen::Vector3i count = centre ? cubes_ : Eigen::Vector3i(cubes_.array() + 1);
    const int n = centre ? number - corner_count() : number;
    const Place half(n % count[0], n / count[0] % count[1], n / count[0] / count[1]);
    return 2 * half + Place::Constant(centre ? 1 : 0);
  }

  [[nodiscard]] Eigen::Vector3d point(const Place& place) const { return origin_ + size_ / 2 * place.cast<double>(); }

  // The ways to the 14 neighbours; the first six are long. The opposite of way w is w ^ 1.
  static constexpr int kWays = 14, kLongWays = 6;
  static Place way(int number) {
    static const std::array<Place, kWays> ways = {{{2, 0, 0},
                                                   {-2, 0, 0},
                                                   {0, 2, 0},
                                                   {0, -2, 0},
                                                   {0, 0, 2},
                                                   {0, 0, -2},
                                                   {1, 1, 1},
                                                   {-1, -1, -1},
                                                   {1, 1, -1},
                                                   {-1, -1, 1},
                                                   {1, -1, 1},
                                                   {-1, 1, -1},
                                                   {-1, 1, 1},
                                                   {1, -1, -1}}};
    return ways[number];
  }

  // The four corners of tetrahedron `number` of 12 of the cube with that centre: those that lie across its faces
  // towards larger x, y and z. Corners 0 and 1 are joined by a long edge, and so are 2 and 3; positively oriented.
  [[nodiscard]] static std::array<Place, 4> tetrahedron(const Place& centre, int number) {
    const int axis = number / 4, side = number % 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
    constexpr std::array<std::array<int, 2>, 4> kRound = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    std::array<Place, 4> corners = {centre, centre, centre, centre};
    corners[1][axis] += 2;
    for (int k = 0; k < 2; ++k) {
      corners[2 + k][axis] += 1;
      corners[2 + k][u] += kRound[(side + k) % 4][0];
      corners[2 + k][v] += kRound[(side + k) % 4][1];
    }
    return corners;
  }

 private:
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double size_ = 1;
  Eigen::Vector3i cubes_ = Eigen::Vector3i::Zero();
};

}  // namespace ringdown::mesh

#include "engine/bake/body_shape.h"

#include "engine/dense/decompositions.h"
#include "engine/mesh/boundary.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

// The size of elements is the smallest of three: a share of the shortest wave in the band, a third of the body's width,
// so that its section can warp, and a few thicknesses, so that flat elements still bend. Unless that takes too many
// unknowns, sharp edges get elements as small as the body is thick.
namespace ringdown::bake {
namespace {

constexpr std::array kElementsPerWave = {20.0, 8.0, 4.0, 2.5};      // order 1 to 4
constexpr std::array kUnknownsPerElement = {0.7, 6.0, 17.0, 38.0};  // gmsh's meshes of bodies, not of films
constexpr double kElementsPerThicknessAtEdges = 1;
constexpr double kSizeInSection = 0.33;  // of the width

// Returns a vector along the normal of each triangle, twice as long as its area.
mesh::Points normals_of(const mesh::TriangleMesh& skin) {
  mesh::Points normals(skin.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    const Eigen::RowVector3d at = skin.nodes.row(skin.triangles(t, 0));
    const Eigen::RowVector3d to_b = skin.nodes.row(skin.triangles(t, 1)) - at;
    const Eigen::RowVector3d to_c = skin.nodes.row(skin.triangles(t, 2)) - at;
    normals.row(t) = to_b.cross(to_c);
  }
  return normals;
}

// The integral of |k1 + k2| is the sum over edges of their lengths times the angles between their triangles.
double bend_of(const mesh::TriangleMesh& skin, const mesh::Points& normals) {
  constexpr double kSharp = std::numbers::pi * 40 / 180;
  std::vector<std::array<Eigen::Index, 3>> sides;  // two nodes, ascending, and the triangle
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(skin.triangles(t, i), skin.triangles(t, (i + 1) % 3));
      sides.push_back({low, high, t});
    }
  }
  std::sort(sides.begin(), sides.end());
  double bend = 0;
  for (std::size_t n = 1; n < sides.size(); ++n) {
    const auto [a, b, t] = sides[n];
    if (sides[n - 1][0] != a || sides[n - 1][1] != b) continue;
    const Eigen::RowVector3d one = normals.row(t), other = normals.row(sides[n - 1][2]);
    const double angle = std::atan2(one.cross(other).norm(), one.dot(other));
    if (angle < kSharp) bend += angle * (skin.nodes.row(a) - skin.nodes.row(b)).norm();
  }
  return bend / (0.5 * normals.rowwise().norm().sum());
}

double thickness_of(const BodyShape& shape) {
  return shape.wall_m > 0 ? std::min(shape.wall_m, shape.thickness_m) : shape.thickness_m;
}

// The shorter of two waves at a frequency: the shear wave of the material, and the bending wave of a plate as thick as
// the body, 2 pi (D / (rho h omega^2))^(1/4) with the plate's stiffness D = E h^3 / (12 (1 - nu^2)) (Kirchhoff's
// theory).
double shortest_wave(const BodyShape& shape, const modal::Material& material, double frequency_hz) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double shear = std::sqrt(e / (2 * (1 + nu) * rho)) / frequency_hz;
  const double omega = modal::hz_to_rad_per_s(frequency_hz), h = thickness_of(shape);
  const double bending_per_mass = e * h * h / (12 * (1 - nu * nu) * rho);  // D / (rho h)
  return std::min(shear, 2 * std::numbers::pi * std::pow(bending_per_mass, 0.25) / std::sqrt(omega));
}

double extent(const mesh::Points& nodes) { return (nodes.colwise().maxCoeff() - nodes.colwise().minCoeff()).norm(); }

// Volume and its first and second moments.
class Moments {
 public:
  void add(const mesh::Corners& corners) {
    const double part = mesh::jacobian(corners).determinant() / 6;
    const Eigen::RowVector3d sum = corners.colwise().sum();
    volume_ += part;
    first_ += part / 4 * sum;
    second_ += part / 20 * (corners.transpose() * corners + sum.transpose() * sum);
  }

  [[nodiscard]] BodyShape shape(const mesh::TriangleMesh& skin) const {
    const mesh::Points normals = normals_of(skin);
    const double area = 0.5 * normals.rowwise().norm().sum();
    const Eigen::Matrix3d spread = second_ / volume_ - first_.transpose() * first_ / (volume_ * volume_);
    const dense::Spectrum3 principal = dense::spectrum_of_3(spread);
    return {.volume_m3 = std::abs(volume_),
            .thickness_m = 2 * std::abs(volume_) / area,
            .wall_m = 0,
            .width_m = std::sqrt(12 * std::max(principal.values[1], 0.0)),
            .length_m = extent(skin.nodes),
            .bend_per_m = bend_of(skin, normals)};
  }

 private:
  double volume_ = 0;
  Eigen::RowVector3d first_ = Eigen::RowVector3d::Zero();
  Eigen::Matrix3d second_ = Eigen::Matrix3d::Zero();
};

// The size that makes that many unknowns: the inverse of estimated_unknowns().
double size_for(const BodyShape& shape, double unknowns, int order) {
  const double cells = 8 * kUnknownsPerElement[order - 1] * shape.volume_m3 / unknowns;
  const double compact = std::cbrt(cells);
  return compact <= shape.thickness_m ? compact : std::sqrt(cells / shape.thickness_m);
}

}  // namespace

BodyShape measure_shape(const mesh::TetMesh& mesh) {
  Moments moments;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) moments.add(mesh::corners_of(mesh, e));
  return moments.shape(mesh::skin_of(mesh));
}

// The moments are those of the signed tetrahedra between the middle of the nodes and each triangle.
BodyShape measure_shape(const mesh::TriangleMesh& skin, double wall_m) {
  Moments moments;
  const Eigen::RowVector3d middle = skin.nodes.colwise().mean();
  for (Eigen::Index t = 0; t < skin.triangles.rows(); ++t) {
    mesh::Corners corners = mesh::Corners::Zero();
    for (int i = 0; i < 3; ++i) corners.row(i + 1) = skin.nodes.row(skin.triangles(t, i)) - middle;
    moments.add(corners);
  }
  BodyShape shape = moments.shape(skin);
  shape.wall_m = wall_m;
  return shape;
}

double estimated_unknowns(const BodyShape& shape, double size_m, int order) {
  const double cell = size_m * size_m * std::min(size_m, shape.thickness_m) / 8;
  return kUnknownsPerElement[order - 1] * shape.volume_m3 / cell;
}

MeshChoice choose_mesh(const BodyShape& shape, const modal::Material& material, double band_high_hz, int order,
                       double max_unknowns) {
  MeshChoice choice{.shortest_wave_m = shortest_wave(shape, material, band_high_hz)};
  choice.size_m = std::min({choice.shortest_wave_m / kElementsPerWave[order - 1], kSizeInSection * shape.width_m,
                            (order + 1) * thickness_of(shape)});
  choice.wall_m = shape.wall_m;
  const double finest = size_for(shape, max_unknowns, order);
  choice.bounded = choice.size_m < finest;
  choice.size_m = std::max(choice.size_m, finest);
  if (!choice.bounded) choice.edge_size_m = std::min(choice.size_m, shape.thickness_m / kElementsPerThicknessAtEdges);
  return choice;
}

MeshChoice choose_coarse_mesh(const BodyShape& shape, int order, double unknowns) {
  return {.size_m = size_for(shape, unknowns, order)};
}

namespace {

struct Unit {
  const char *name, *option;
  double length_m;
};
constexpr std::array<Unit, 4> kUnits = {
    {{"millimetre", "mm", 0.001}, {"centimetre", "cm", 0.01}, {"inch", "in", 0.0254}, {"metre", "m", 1}}};

BodyShape scaled(BodyShape shape, double by) {
  shape.volume_m3 *= by * by * by;
  shape.thickness_m *= by;
  shape.wall_m *= by;
  shape.width_m *= by;
  shape.length_m *= by;
  shape.bend_per_m /= by;
  return shape;
}

std::string length_text(double metres) {
  return metres < 1 ? formatted("{:.3g} mm", 1000 * metres) : formatted("{:.3g} m", metres);
}

// The limits of a bank.
struct Limits {
  double band_high_hz;
  int max_modes;
};

double modes_below(const BodyShape& shape, const modal::Material& material, const Limits& limits) {
  return debye_count(shape.volume_m3, material, highest_lambda_in_band(limits.band_high_hz, material.damping));
}

enum class Sound { kGood, kSilent, kCrowded };

Sound sound_of(const BodyShape& shape, const modal::Material& material, const Limits& limits) {
  if (guessed_lowest_hz(shape, material) > limits.band_high_hz) return Sound::kSilent;
  return modes_below(shape, material, limits) > limits.max_modes ? Sound::kCrowded : Sound::kGood;
}

}  // namespace

// The lower of a free bar's first bending mode, 1.03 (h / L^2) sqrt(E / rho) for a rectangular section, and of a half
// wave of shear along the body.
double guessed_lowest_hz(const BodyShape& shape, const modal::Material& material) {
  const double e = material.youngs_modulus_pa, rho = material.density_kg_m3, nu = material.poisson_ratio;
  const double bending = 1.03 * shape.thickness_m / (shape.length_m * shape.length_m) * std::sqrt(e / rho);
  const double shear = std::sqrt(e / (2 * (1 + nu) * rho)) / (2 * shape.length_m);
  return std::min(bending, shear);
}

// The number of modes below a frequency by Weyl's law, as in Debye's theory of heat capacity: V omega^3 / (6 pi^2)
// times the sum of c^-3 over the longitudinal and the two transverse waves. It leaves out the terms of surface and
// edges.
double debye_count(double volume_m3, const modal::Material& material, double lambda) {
  const double e = material.youngs_modulus_pa, nu = material.poisson_ratio, rho = material.density_kg_m3;
  const double transverse = std::sqrt(e / (2 * (1 + nu) * rho));
  const double longitudinal = transverse * std::sqrt((2 - 2 * nu) / (1 - 2 * nu));
  const double slowness = std::pow(longitudinal, -3) + 2 * std::pow(transverse, -3);
  return volume_m3 * std::pow(lambda, 1.5) / (6 * std::numbers::pi * std::numbers::pi) * slowness;
}

std::string question_size(const BodyShape& shape, const modal::Material& material, double band_high_hz, int max_modes,
                          const std::filesystem::path& path, double unit_m) {
  const Limits limits{band_high_hz, max_modes};
  const Sound sound = sound_of(shape, material, limits);
  if (sound == Sound::kGood) return "";
  const std::string trouble =
      sound == Sound::kSilent ? formatted("its lowest note would be near {:.2g} Hz", guessed_lowest_hz(shape, material))
                              : formatted("about {:.2g} modes would lie below {:.0f} Hz",
                                          modes_below(shape, material, limits), band_high_hz);
  const std::string text =
      formatted("{} is {} long, so that {}", path.filename().string(), length_text(shape.length_m), trouble);
  for (const Unit& unit : kUnits) {
    const BodyShape other = scaled(shape, unit.length_m / unit_m);
    if (unit.length_m == unit_m || sound_of(other, material, limits) != Sound::kGood) continue;
    return formatted("{}; if its unit is the {} (--unit {}), it is {} long, and its lowest note about {:.2g} Hz", text,
                     unit.name, unit.option, length_text(other.length_m), guessed_lowest_hz(other, material));
  }
  return text + "; check its unit (--unit)";
}

Result<void> check_place(const mesh::Points& nodes, double length_m) {
  constexpr double kMaxDistance = 1e4;
  const double reach = nodes.cwiseAbs().maxCoeff();
  if (reach < kMaxDistance * length_m) return {};
  return fail(ErrorKind::bad_input,
              " is {:.3g} m long and lies {:.3g} m from the origin, too far for the 32-bit positions of a bank; move "
              "it to the origin",
              length_m, reach);
}

Result<void> check_count(double volume_m3, const modal::Material& material, double lambda, double band_high_hz,
                         int max_modes) {
  const double count = debye_count(volume_m3, material, lambda);
  if (count <= 4.0 * max_modes) return {};
  return fail(ErrorKind::too_large,
              "about {:.2g} modes lie below {} Hz, and a bank holds {}: check the unit of its lengths (--unit 0.001 "
              "for millimetres), or narrow the band (--band)",
              count, std::lround(band_high_hz), max_modes);
}

}  // namespace ringdown::bake

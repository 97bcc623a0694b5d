#include "engine/scene/solid.h"

#include "engine/scene/hull.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace ringdown::scene {
namespace {

// Below this ratio of the smallest to the largest moment, inverting the tensor means nothing.
constexpr double kMinMomentRatio = 1e-9;

struct Bounds {
  Vec3 low, high;
  [[nodiscard]] Vec3 center() const { return 0.5 * (low + high); }
  [[nodiscard]] Vec3 size() const { return high - low; }
};

Vec3 to_vec3(const modal::Vec3f& p) { return {p[0], p[1], p[2]}; }

Bounds bounds_of(const modal::Bank& bank) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Bounds bounds{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const modal::Vec3f& p : bank.positions) {
    bounds.low = {std::min<double>(bounds.low.x, p[0]), std::min<double>(bounds.low.y, p[1]),
                  std::min<double>(bounds.low.z, p[2])};
    bounds.high = {std::max<double>(bounds.high.x, p[0]), std::max<double>(bounds.high.y, p[1]),
                   std::max<double>(bounds.high.z, p[2])};
  }
  return bounds;
}

Matrix3 diagonal(double x, double y, double z) { return {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}; }

RigidMass box_mass(Vec3 size, double density, Vec3 center) {
  const double mass = density * size.x * size.y * size.z, k = mass / 12;
  const Vec3 square{size.x * size.x, size.y * size.y, size.z * size.z};
  return {mass, center, diagonal(k * (square.y + square.z), k * (square.x + square.z), k * (square.x + square.y))};
}

RigidMass sphere_mass(double radius, double density, Vec3 center) {
  const double mass = density * 4 / 3 * std::numbers::pi * radius * radius * radius;
  const double moment = 0.4 * mass * radius * radius;
  return {mass, center, diagonal(moment, moment, moment)};
}

Result<RigidMass> bank_mass(const modal::MassProperties& mass, double density_scale) {
  const Rotation axes = Rotation::from_xyzw(mass.orientation);
  const Vec3 moments = mass.inertia_kg_m2;
  const double largest = std::max({moments.x, moments.y, moments.z});
  if (!range::kMass_kg.holds(mass.mass_kg * density_scale)) {
    return fail(ErrorKind::bad_input, "its mass of {:f} kg is outside 1e-7 ... 1e7 kg", mass.mass_kg * density_scale);
  }
  if (!is_finite(mass.center_of_mass_m) || !is_finite(moments) ||
      !(std::min({moments.x, moments.y, moments.z}) > kMinMomentRatio * largest) ||
      !(std::abs(norm(axes) - 1) < 1e-3)) {
    return fail(ErrorKind::bad_input,
                "its massProperties are degenerate: three moments > 0 and a unit quaternion are needed");
  }
  RigidMass rigid{mass.mass_kg * density_scale, mass.center_of_mass_m, inertia_tensor(mass)};
  for (auto& row : rigid.inertia_kg_m2) {
    for (double& moment : row) moment *= density_scale;
  }
  return rigid;
}

// Box and sphere with every size filled in, in the object frame.
struct Extent {
  Vec3 center_m, size_m;
  double radius_m = 0;
};

Result<Extent> extent_of(const Shape& shape, const modal::Bank* bank) {
  const bool wants_bank = shape.type == ShapeType::box      ? shape.size_m == Vec3{}
                          : shape.type == ShapeType::sphere ? shape.radius_m == 0
                                                            : !shape.mesh;
  if (shape.mesh && (shape.type == ShapeType::convex || shape.type == ShapeType::trimesh)) return Extent{};
  if (wants_bank && !bank)
    return fail(ErrorKind::bad_input, "it has no object to take its size from; give it a size or a radius");
  if (wants_bank && bank->positions.empty())
    return fail(ErrorKind::bad_input, "its bank has no surface; give the body a size or a radius");
  const Vec3 usual_center = bank && !bank->positions.empty() ? bounds_of(*bank).center() : Vec3{};
  Extent extent{shape.center_m.value_or(usual_center), shape.size_m, shape.radius_m};
  if (wants_bank) {
    const Vec3 size = bounds_of(*bank).size();
    const double thinnest = range::kSize_m.low;  // a flat surface still gets a body
    extent.size_m = {std::max(size.x, thinnest), std::max(size.y, thinnest), std::max(size.z, thinnest)};
  }
  const Vec3 size = extent.size_m;
  const bool sized = shape.type == ShapeType::sphere && !wants_bank
                         ? range::kSize_m.holds(shape.radius_m)
                         : range::kSize_m.holds(size.x) && range::kSize_m.holds(size.y) && range::kSize_m.holds(size.z);
  if (!sized) return fail(ErrorKind::bad_input, "its size is outside 0.0001 ... 1000 m");
  return extent;
}

// The sphere about the centre of mass that encloses the surface.
double enclosing_radius(const modal::Bank& bank, Vec3 center) {
  double radius = range::kSize_m.low;
  for (const auto& p : bank.positions) radius = std::max(radius, length(to_vec3(p) - center));
  return radius;
}

Result<RigidMass> mass_of(const BodyDescription& body, const modal::Bank* bank, double density_scale,
                          const Extent& extent) {
  if (body.mass) return bank_mass(*body.mass, 1);
  if (body.density_kg_m3 == 0 && bank && bank->held && !body.fixed) {
    return fail(ErrorKind::bad_input,
                "its bank is held by supports, so it is not a free body: give fixed = true, or the mass of the whole "
                "body that moves with it");
  }
  if (body.density_kg_m3 == 0 && bank && bank->mass) return bank_mass(*bank->mass, density_scale);
  if (body.density_kg_m3 == 0 && body.fixed) return box_mass({0.1, 0.1, 0.1}, 1000, extent.center_m);
  if (body.density_kg_m3 == 0) {
    return fail(ErrorKind::bad_input, bank ? "its bank has no massProperties; give the body density_kg_m3"
                                           : "a silent body needs density_kg_m3");
  }
  if (!range::kDensity_kg_m3.holds(body.density_kg_m3))
    return fail(ErrorKind::bad_input, "its density is outside 0.1 ... 100000 kg/m^3");
  if (body.shape.type == ShapeType::convex || body.shape.type == ShapeType::trimesh) {
    return fail(ErrorKind::bad_input,
                "density_kg_m3 goes with shape box or sphere; a convex or trimesh body takes its mass from its bank");
  }
  RigidMass mass = box_mass(extent.size_m, body.density_kg_m3, extent.center_m);
  if (body.shape.type == ShapeType::sphere) {
    const double radius = extent.radius_m > 0 ? extent.radius_m : enclosing_radius(*bank, extent.center_m);
    mass = sphere_mass(radius, body.density_kg_m3, extent.center_m);
  }
  if (!range::kMass_kg.holds(mass.mass_kg)) {
    return fail(ErrorKind::bad_input, "its size and density make {:f} kg, outside 1e-7 ... 1e7 kg", mass.mass_kg);
  }
  return mass;
}

// Removes triangles with two corners in one, then points without a triangle. ODE ends the process when a mesh has more
// points than edges.
void remove_loose_parts(CollisionShape& shape) {
  std::erase_if(shape.triangles, [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  constexpr std::uint32_t kLoose = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(shape.points.size(), kLoose);
  for (const auto& triangle : shape.triangles) {
    for (const std::uint32_t corner : triangle) number[corner] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] == kLoose) continue;
    shape.points[kept] = shape.points[k];
    number[k] = kept++;
  }
  shape.points.resize(kept);
  for (auto& triangle : shape.triangles) {
    for (std::uint32_t& corner : triangle) corner = number[corner];
  }
}

Result<CollisionShape> shape_of(const Shape& shape, const modal::Bank* bank, const Extent& extent,
                                Vec3 center_of_mass) {
  CollisionShape out;
  out.type = shape.type;  // the points of hulls and meshes lie about the centre of mass: their center_m stays 0
  if (shape.type == ShapeType::box) {
    out.center_m = extent.center_m - center_of_mass;
    out.size_m = extent.size_m;
  } else if (shape.type == ShapeType::sphere) {
    const bool own = shape.radius_m > 0;
    out.radius_m = own ? shape.radius_m : enclosing_radius(*bank, center_of_mass);
    if (own) out.center_m = extent.center_m - center_of_mass;
  } else if (shape.mesh) {
    for (const Vec3& p : shape.mesh->points_m) out.points.push_back(p - center_of_mass);
    out.triangles = shape.mesh->triangles;
  } else {
    for (const auto& p : bank->positions) out.points.push_back(to_vec3(p) - center_of_mass);
    out.triangles = bank->triangles;
  }
  if (shape.type == ShapeType::trimesh) remove_loose_parts(out);
  if (shape.type == ShapeType::trimesh && out.triangles.empty()) {
    return fail(ErrorKind::bad_input, "its surface has no triangles; use shape box, sphere or convex");
  }
  if (shape.type == ShapeType::convex) {
    Result<Hull> hull = convex_hull(out.points);
    if (!hull) return fail(hull);
    out.points = std::move(hull->points);
    out.triangles = std::move(hull->triangles);
  }
  return out;
}

Result<Solid> solid_of(const BodyDescription& body, const modal::Bank* bank, double density_scale) {
  const Result<Extent> extent = extent_of(body.shape, bank);
  if (!extent) return fail(extent);
  Result<RigidMass> mass = mass_of(body, bank, density_scale, *extent);
  if (!mass) return fail(mass);
  Result<CollisionShape> shape = shape_of(body.shape, bank, *extent, mass->center_m);
  if (!shape) return fail(shape);
  return Solid{*mass, std::move(*shape)};
}

// Returns a scaled bank with only what its rigid body needs.
modal::Bank body_of(const modal::Bank& bank, const modal::MaterialScale& scale) {
  modal::Bank scaled;
  for (const modal::Vec3f& point : bank.positions) scaled.positions.push_back(modal::rescale(point, scale));
  scaled.triangles = bank.triangles;
  if (bank.mass) scaled.mass = modal::rescale(*bank.mass, scale);
  return scaled;
}

}  // namespace

Matrix3 inertia_tensor(const modal::MassProperties& mass) {
  const Matrix3 r = to_matrix(normalized(Rotation::from_xyzw(mass.orientation)));
  const std::array moments{mass.inertia_kg_m2.x, mass.inertia_kg_m2.y, mass.inertia_kg_m2.z};
  Matrix3 tensor{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) tensor[i][j] += r[i][k] * moments[k] * r[j][k];
    }
  }
  return tensor;
}

Result<Solid> make_solid(const BodyDescription& body, const modal::Bank* bank, const modal::MaterialScale& scale) {
  if (bank == nullptr || scale.size == 1) return solid_of(body, bank, scale.density);
  const modal::Bank scaled = body_of(*bank, scale);
  return solid_of(body, &scaled, 1);
}

double outer_radius(const CollisionShape& shape) {
  if (shape.type == ShapeType::sphere) return length(shape.center_m) + shape.radius_m;
  if (shape.type == ShapeType::box) return length(shape.center_m) + 0.5 * length(shape.size_m);
  double radius = 0;
  for (const Vec3& point : shape.points) radius = std::max(radius, length(point));
  return radius;
}

}  // namespace ringdown::scene

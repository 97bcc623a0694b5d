#include "engine/bake/fitted_makeup.h"

#include "engine/base/byte_stream.h"
#include "engine/base/formatted.h"
#include "engine/base/quote.h"
#include "engine/fem/mode_energy.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kOnPlace = 1e-6;   // of the body's length, how far a node may lie outside
constexpr double kNearPoint = 0.1;  // of the body's length, how far a point that touches it may lie beside it
constexpr double kFlat = 1e-6;      // 1 - length of the mean normal of a surface that slides
// Stiffness for each area of a surface that slides, in units of modulus over length. It gives way by a
// ten-millionth of the strain times the length, and leaves eigenvalues nine digits.
constexpr double kRigid = 1e7;

Vector3d to_eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

fem::EngineeringConstants constants_of(const modal::Orthotropy& o, double unit_pa) {
  return {Eigen::Array3d(o.youngs_modulus_pa.data()) / unit_pa, Eigen::Array3d(o.poisson_ratio.data()),
          Eigen::Array3d(o.shear_modulus_pa.data()) / unit_pa};
}

// The directions of a material's axes 1, 2, 3 at a point, as columns.
Matrix3d axes_at(const Grain& grain, const Vector3d& point_m) {
  Vector3d along = to_eigen(grain.along).normalized(), outward;
  if (grain.axis) {
    const Vector3d axis = to_eigen(*grain.axis).normalized();
    const Vector3d arm = point_m - to_eigen(grain.through_m);
    outward = arm - axis * axis.dot(arm);
    if (!(outward.norm() > 1e-12 * arm.norm())) outward = axis.unitOrthogonal();
    outward.normalize();
    along = grain.winds ? Vector3d(axis.cross(outward)) : axis;
  } else {
    const Vector3d radial = grain.radial ? to_eigen(*grain.radial) : Vector3d(along.unitOrthogonal());
    outward = (radial - along * along.dot(radial)).normalized();
  }
  Matrix3d axes;
  axes << along, outward, along.cross(outward);
  return axes;
}

Result<void> check_grain(const modal::Material& material, const Grain& grain) {
  if (!material.orthotropy) {
    return fail(ErrorKind::bad_input,
                "has a grain, but the material's file has no [orthotropic] or "
                "[transversely_isotropic] constants; leave the grain out, or give them");
  }
  const Vector3d along = to_eigen(grain.axis ? *grain.axis : grain.along);
  if (!(along.norm() > 0)) return fail(ErrorKind::bad_input, "the grain's direction has no length");
  if (grain.axis) return {};
  if (!grain.radial && !is_transversely_isotropic(*material.orthotropy)) {
    return fail(ErrorKind::bad_input,
                "differs in the directions across its grain: give the direction of the radius of its growth rings, "
                "radial = [x, y, z]");
  }
  if (grain.radial && !(to_eigen(*grain.radial).cross(along).norm() > 1e-6 * to_eigen(*grain.radial).norm()))
    return fail(ErrorKind::bad_input, "the grain and its radial direction must not be parallel");
  return {};
}

Eigen::Array<double, 6, 1> loss_ratios(const modal::Orthotropy& o) { return Eigen::Array<double, 6, 1>(o.loss.data()); }

// A part's laws: of its stiffness, and of what it loses.
struct PartLaws {
  fem::Matrix6 stiffness, lost;  // in the material's axes
};

std::string place_text(const Place& place) {
  if (!place.group.empty()) return "group " + quote(place.group);
  return place.box_m ? "box" : "plane";
}

class Fitter {
 public:
  Fitter(const Makeup& makeup, const modal::Material& material, const mesh::TetMesh& mesh,
         const mesh::MeshGroups& groups, const BodyUnits& units)
      : makeup_(makeup), material_(material), mesh_(mesh), groups_(groups), units_(units) {}

  Result<FittedMakeup> run() {
    if (auto parts = find_parts(); !parts) return fail(parts);
    if (auto laws = make_laws(); !laws) return fail(laws);
    for (const Support& support : makeup_.supports) {
      if (support.kind != SupportKind::kSprings) continue;
      if (auto held = hold(support); !held) return fail(held);
    }
    for (const Support& support : makeup_.supports) {
      if (support.kind == SupportKind::kSprings) continue;
      if (auto held = hold(support); !held) return fail(held);
    }
    for (const GluedMass& mass : makeup_.masses) {
      if (auto glued = glue(mass); !glued) return fail(glued);
    }
    fitted_.free_motions = fem::free_motions(mesh_, fitted_.holding);
    fitted_.heat = BodyHeat(fitted_.materials);
    write_key();
    return std::move(fitted_);
  }

 private:
  Result<void> find_parts() {
    for (const Part& part : makeup_.parts) fitted_.materials.push_back(part.material);
    fitted_.materials.push_back(material_);
    if (makeup_.parts.empty()) return {};
    const auto rest = static_cast<std::int32_t>(makeup_.parts.size());
    fitted_.part_of.assign(static_cast<std::size_t>(mesh_.elements.rows()), rest);
    for (std::size_t p = 0; p < makeup_.parts.size(); ++p) {
      const auto found = std::ranges::find(groups_.volumes, makeup_.parts[p].group);
      if (found == groups_.volumes.end())
        return fail(ErrorKind::bad_input, no_group(makeup_.parts[p].group, groups_.volumes));
      const auto number = static_cast<std::int32_t>(found - groups_.volumes.begin());
      for (std::size_t e = 0; e < fitted_.part_of.size(); ++e) {
        if (groups_.volume_of[e] == number) fitted_.part_of[e] = static_cast<std::int32_t>(p);
      }
    }
    return {};
  }

  static std::string no_group(const std::string& name, const std::vector<std::string>& known) {
    std::string text = "the mesh has no group " + quote(name) + " (Physical Volume or Physical Surface of gmsh)";
    if (known.empty()) return text + "; it has none at all";
    for (const std::string& one : known) text += (&one == &known.front() ? "; it has " : ", ") + one;
    return text;
  }

  const std::optional<Grain>& grain_of(std::size_t part) const {
    return part < makeup_.parts.size() ? makeup_.parts[part].grain : makeup_.grain;
  }

  fem::Elastic elastic_of(const modal::Material& material) const {
    return {material.youngs_modulus_pa / units_.modulus_pa, material.poisson_ratio,
            material.density_kg_m3 / units_.density_kg_m3};
  }

  // One law for each part of one direction; where the direction turns around an axis, one for each element.
  Result<void> make_laws() {
    std::vector<fem::Law> laws, lost;
    std::vector<std::int32_t> law_of(static_cast<std::size_t>(mesh_.elements.rows()), 0);
    for (std::size_t p = 0; p < fitted_.materials.size(); ++p) {
      const modal::Material& material = fitted_.materials[p];
      const std::optional<Grain>& grain = grain_of(p);
      const fem::Elastic elastic = elastic_of(material);
      const auto refuse = [&](const Error& error) { return fail(error.kind, material.name + ": " + error.message); };
      if (!grain) {
        if (auto stable =
                fem::check_elastic({material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3});
            !stable)
          return refuse(stable.error());
        add_law(p, {elastic}, {elastic}, laws, lost, law_of);
        continue;
      }
      if (auto good = check_grain(material, *grain); !good) return refuse(good.error());
      const fem::EngineeringConstants constants = constants_of(*material.orthotropy, units_.modulus_pa);
      const Result<fem::Matrix6> stiffness = fem::orthotropic_stiffness(constants);
      if (!stiffness) return refuse(stiffness.error());
      const PartLaws own{*stiffness, fem::lost_stiffness(constants, loss_ratios(*material.orthotropy))};
      const auto turned = [&](const Eigen::Vector3d& point_m, const fem::Matrix6& law) {
        return fem::Law{{1, 0, elastic.density_kg_m3}, fem::rotated(law, axes_at(*grain, point_m))};
      };
      if (!grain->axis) {
        add_law(p, turned(Vector3d::Zero(), own.stiffness), turned(Vector3d::Zero(), own.lost), laws, lost, law_of);
        continue;
      }
      for (Eigen::Index e = 0; e < mesh_.elements.rows(); ++e) {
        if (part_of(e) != p) continue;
        const Vector3d middle_m = units_.length_m * middle(e);
        law_of[static_cast<std::size_t>(e)] = static_cast<std::int32_t>(laws.size());
        laws.push_back(turned(middle_m, own.stiffness));
        lost.push_back(turned(middle_m, own.lost));
      }
    }
    fitted_.solid = fem::Solid(std::move(laws), law_of);
    fitted_.lost = fem::Solid(std::move(lost), std::move(law_of));
    return fem::check_solid(fitted_.solid);
  }

  void add_law(std::size_t part, const fem::Law& law, const fem::Law& lost_law, std::vector<fem::Law>& laws,
               std::vector<fem::Law>& lost, std::vector<std::int32_t>& law_of) const {
    for (Eigen::Index e = 0; e < mesh_.elements.rows(); ++e) {
      if (part_of(e) == part) law_of[static_cast<std::size_t>(e)] = static_cast<std::int32_t>(laws.size());
    }
    laws.push_back(law);
    lost.push_back(lost_law);
  }

  [[nodiscard]] std::size_t part_of(Eigen::Index e) const {
    return fitted_.part_of.empty() ? 0 : static_cast<std::size_t>(fitted_.part_of[static_cast<std::size_t>(e)]);
  }

  // The point of element `e` at the middle of the reference element, free of units like the mesh.
  [[nodiscard]] Vector3d middle(Eigen::Index e) const {
    return mesh::nodes_of(mesh_, e).transpose() * mesh::interpolation(mesh_.order(), Eigen::Vector4d::Constant(0.25));
  }

  Result<std::vector<mesh::OuterFace>> faces_at(const Place& place) {
    if (outer_.empty()) outer_ = mesh::outer_faces(mesh_.elements);
    std::vector<mesh::OuterFace> faces;
    if (!place.group.empty()) {
      const auto found = std::ranges::find(groups_.surfaces, place.group, &mesh::FaceGroup::name);
      std::vector<std::string> known;
      for (const mesh::FaceGroup& group : groups_.surfaces) known.push_back(group.name);
      if (found == groups_.surfaces.end()) return fail(ErrorKind::bad_input, no_group(place.group, known));
      std::copy_if(outer_.begin(), outer_.end(), std::back_inserter(faces), [&](const mesh::OuterFace& face) {
        return std::ranges::binary_search(found->faces, static_cast<std::int64_t>(4 * face.element + face.opposite));
      });
    } else {
      std::copy_if(outer_.begin(), outer_.end(), std::back_inserter(faces), [&](const mesh::OuterFace& face) {
        const std::vector<std::int32_t> nodes = fem::nodes_on(mesh_, {face});
        return std::ranges::all_of(nodes,
                                   [&](std::int32_t n) { return lies_on(place, mesh_.nodes.row(n).transpose()); });
      });
    }
    if (!faces.empty()) return faces;
    return fail(ErrorKind::bad_input, "no face of its surface lies on the " + place_text(place) +
                                          " of a support or mass; check its place, in metres of the object");
  }

  [[nodiscard]] bool lies_on(const Place& place, const Vector3d& point) const {
    if (place.plane) {
      const Vector3d normal = to_eigen((*place.plane)[1]).normalized();
      return std::abs(normal.dot(point - to_eigen((*place.plane)[0]) / units_.length_m)) <= kOnPlace;
    }
    const Vector3d a = to_eigen((*place.box_m)[0]) / units_.length_m, b = to_eigen((*place.box_m)[1]) / units_.length_m;
    return ((point - a.cwiseMin(b)).array() >= -kOnPlace).all() && ((a.cwiseMax(b) - point).array() >= -kOnPlace).all();
  }

  Result<void> touch(const Support& support) {
    if (outer_.empty()) outer_ = mesh::outer_faces(mesh_.elements);
    const double unit_kg = units_.density_kg_m3 * std::pow(units_.length_m, 3);
    for (const Vec3& point_m : support.points_m) {
      fem::HeldPoint point = fem::nearest_point(mesh_, outer_, to_eigen(point_m) / units_.length_m);
      if (point.distance > kNearPoint) {
        const std::string text = formatted(
            "the point ({:.4g}, {:.4g}, {:.4g}) of a support lies {:.3g} m away from the body; give it in metres of "
            "the object",
            point_m.x, point_m.y, point_m.z, point.distance * units_.length_m);
        return fail(ErrorKind::bad_input, text);
      }
      point.mass_kg = support.point_mass_kg / unit_kg;
      fitted_.holding.points.push_back(point);
      fitted_.point_damping_ns_m.push_back(support.point_damping_ns_m);
    }
    const std::size_t count = support.points_m.size();
    fitted_.notes.push_back(formatted("touched at {}{}", count, count == 1 ? " point" : " points"));
    return {};
  }

  Result<void> hold(const Support& support) {
    if (support.kind == SupportKind::kPoints) return touch(support);
    auto faces = faces_at(support.place);
    if (!faces) return fail(faces);
    const fem::Extent extent = fem::extent_of(mesh_, *faces);
    const double spring = units_.length_m / units_.modulus_pa;
    switch (support.kind) {
      case SupportKind::kClamped:
        note("clamped", extent.area);
        fitted_.holding.clamped.insert(fitted_.holding.clamped.end(), faces->begin(), faces->end());
        break;
      case SupportKind::kSlides:
        if (1 - extent.normal.norm() > kFlat) {
          return fail(ErrorKind::bad_input, "the surface that slides, " + place_text(support.place) +
                                                ", is not flat; give each flat side its own support");
        }
        note("slides", extent.area);
        fitted_.holding.layers.push_back(
            {.faces = std::move(*faces), .normal_n_m3 = kRigid, .direction = extent.normal.normalized()});
        break;
      case SupportKind::kSprings:
        note("on springs", extent.area);
        fitted_.springs.push_back(support);
        fitted_.holding.layers.push_back({.faces = std::move(*faces),
                                          .normal_n_m3 = spring * support.stiffness_n_m3,
                                          .tangential_n_m3 = spring * support.stiffness_along_n_m3});
        break;
      case SupportKind::kPoints:
        break;
    }
    return {};
  }

  Result<void> glue(const GluedMass& mass) {
    auto faces = faces_at(mass.place);
    if (!faces) return fail(faces);
    const double area = fem::extent_of(mesh_, *faces).area;
    const double unit_kg = units_.density_kg_m3 * std::pow(units_.length_m, 3);
    note("with a glued mass", area);
    fitted_.holding.layers.push_back({.faces = std::move(*faces), .mass_kg_m2 = mass.mass_kg / unit_kg / area});
    return {};
  }

  void note(const char* what, double area) {
    fitted_.notes.push_back(formatted("{}: {:.3g} cm2", what, 1e4 * area * units_.length_m * units_.length_m));
  }

  void write_key() {
    ByteWriter key;
    for (const fem::Solid* solid : {&fitted_.solid, &fitted_.lost}) {
      for (const fem::Law& law : solid->laws()) {
        key.put(law.elastic.youngs_modulus_pa).put(law.elastic.poisson_ratio).put(law.elastic.density_kg_m3);
        if (law.stiffness_pa) key.put_list(std::span<const double>(law.stiffness_pa->data(), 36));
      }
    }
    for (const fem::HeatRatios& part : fitted_.heat.parts)
      key.put(part.expansion).put(part.conductivity).put(part.capacity);
    key.put_list(std::span<const std::int32_t>(fitted_.solid.law_of()));
    key.put_list(std::span<const std::int32_t>(fitted_.part_of));
    const auto put_faces = [&key](const std::vector<mesh::OuterFace>& faces) {
      std::vector<std::int64_t> numbers;
      for (const mesh::OuterFace& face : faces) numbers.push_back(4 * face.element + face.opposite);
      key.put_list(std::span<const std::int64_t>(numbers));
    };
    put_faces(fitted_.holding.clamped);
    for (const fem::Layer& layer : fitted_.holding.layers) {
      put_faces(layer.faces);
      key.put(layer.normal_n_m3).put(layer.tangential_n_m3).put(layer.mass_kg_m2);
    }
    for (const fem::HeldPoint& point : fitted_.holding.points) {
      key.put(static_cast<std::int64_t>(point.element)).put(point.mass_kg);
      key.put_list(std::span<const double>(point.barycentric.data(), 4));
    }
    fitted_.key = key.bytes();
  }

  const Makeup& makeup_;
  const modal::Material& material_;
  const mesh::TetMesh& mesh_;
  const mesh::MeshGroups& groups_;
  const BodyUnits& units_;
  FittedMakeup fitted_{.solid = fem::Elastic{}, .lost = fem::Elastic{}};
  std::vector<mesh::OuterFace> outer_;
};

}  // namespace

bool Support::only_damps() const {
  if (kind == SupportKind::kPoints) return point_mass_kg == 0;
  return kind == SupportKind::kSprings && stiffness_n_m3 == 0 && stiffness_along_n_m3 == 0;
}

bool Makeup::moves_freely() const {
  return !grain && parts.empty() && masses.empty() && std::ranges::all_of(supports, &Support::only_damps);
}

Makeup scaled(Makeup makeup, double scale) {
  const auto scale_grain = [scale](std::optional<Grain>& grain) {
    if (grain) grain->through_m = scale * grain->through_m;
  };
  const auto scale_place = [scale](Place& place) {
    if (place.box_m) *place.box_m = {scale * (*place.box_m)[0], scale * (*place.box_m)[1]};
    if (place.plane) (*place.plane)[0] = scale * (*place.plane)[0];
  };
  scale_grain(makeup.grain);
  for (Part& part : makeup.parts) scale_grain(part.grain);
  for (Support& support : makeup.supports) {
    scale_place(support.place);
    for (Vec3& point_m : support.points_m) point_m = scale * point_m;
  }
  for (GluedMass& mass : makeup.masses) scale_place(mass.place);
  return makeup;
}

Result<FittedMakeup> fit_makeup(const Makeup& makeup, const modal::Material& material, const mesh::TetMesh& unit_mesh,
                                const mesh::MeshGroups& groups, const BodyUnits& units, int pieces) {
  if (!makeup.plain()) return Fitter(makeup, material, unit_mesh, groups, units).run();
  const fem::Elastic elastic{.youngs_modulus_pa = 1, .poisson_ratio = material.poisson_ratio, .density_kg_m3 = 1};
  FittedMakeup plain{.solid = elastic, .lost = elastic};
  plain.materials = {material};
  plain.free_motions = 6 * pieces;
  plain.heat = BodyHeat(plain.materials);
  return plain;
}

ModeShares FittedMakeup::shares(const mesh::TetMesh& unit_mesh, const Eigen::Ref<const Eigen::MatrixXd>& shapes) const {
  ModeShares shares;
  if (key.empty()) return shares;
  fem::ModeEnergy energy = fem::mode_energy(unit_mesh, lost, part_of, static_cast<int>(materials.size()), shapes);
  shares.strain = std::move(energy.strain);
  shares.motion = std::move(energy.motion);
  shares.springs.resize(2 * static_cast<Eigen::Index>(springs.size()), shapes.cols());
  for (std::size_t k = 0; k < springs.size(); ++k)
    shares.springs.middleRows<2>(2 * static_cast<Eigen::Index>(k)) =
        fem::motion_on(unit_mesh, holding.layers[k], shapes);
  shares.points = fem::motion_at(unit_mesh, holding.points, shapes);
  return shares;
}

// A part's material takes the share of the mode's energy that is in it, weighed by the loss of its directions; springs
// take theirs, dampers c |v|^2 for each area or at each point, and Rayleigh's alpha goes with the part's share of the
// motion.
modal::ModeLoss FittedMakeup::loss(const ModeShares& shares, const BodyUnits& units, Eigen::Index m, double lambda,
                                   double air_per_s) const {
  if (key.empty()) return modal::mode_loss(materials.front().damping_law(), lambda, air_per_s);
  modal::ModeLoss loss{.air_per_s = air_per_s};
  const double unit_free = lambda / units.lambda();
  double alpha_per_s = 0;
  for (std::size_t p = 0; p < materials.size(); ++p) {
    const modal::MaterialDamping law = materials[p].damping_law();
    const auto row = static_cast<Eigen::Index>(p);
    loss.material_per_s += shares.strain(row, m) / unit_free * modal::mode_loss(law, lambda).material_per_s;
    if (law.loss_factors.empty()) alpha_per_s += shares.motion(row, m) * law.rayleigh.alpha_per_s;
  }
  loss.support_per_s = std::max(0.5 * alpha_per_s - air_per_s, 0.0);
  const double per_area = 1 / (units.density_kg_m3 * units.length_m);  // of |phi|^2 [m^2 / kg]
  for (std::size_t k = 0; k < springs.size(); ++k) {
    const Support& support = springs[k];
    const double normal = per_area * shares.springs(2 * static_cast<Eigen::Index>(k), m);
    const double along = per_area * shares.springs(2 * static_cast<Eigen::Index>(k) + 1, m);
    const double energy = support.stiffness_n_m3 * normal + support.stiffness_along_n_m3 * along;
    loss.support_per_s +=
        0.5 * support.damping_ns_m3 * (normal + along) + 0.5 * support.loss_factor * energy / std::sqrt(lambda);
  }
  const double per_point = per_area / (units.length_m * units.length_m);
  for (std::size_t k = 0; k < point_damping_ns_m.size(); ++k)
    loss.support_per_s += 0.5 * point_damping_ns_m[k] * per_point * shares.points(static_cast<Eigen::Index>(k), m);
  return loss;
}

double FittedMakeup::highest_lambda(double band_high_hz) const {
  double highest = 0;
  for (const modal::Material& material : materials) {
    double max = 1;
    if (!key.empty() && material.orthotropy) max = std::ranges::max(material.orthotropy->loss);
    modal::Material strongest = material;
    for (modal::LossFactor& point : strongest.loss_factors) point.eta *= std::max(max, 1.0);
    strongest.damping.beta_s *= std::max(max, 1.0);
    highest = std::max(highest, modal::highest_lambda(band_high_hz, strongest.damping_law()));
  }
  return highest;
}

// The geometric means of the three Young's and shear moduli.
modal::Material isotropic_stand_in(const modal::Material& material) {
  modal::Material isotropic = material;
  if (!material.orthotropy) return isotropic;
  const auto& [e, nu, g, loss] = *material.orthotropy;
  const double young = std::cbrt(e[0] * e[1] * e[2]), shear = std::cbrt(g[0] * g[1] * g[2]);
  isotropic.poisson_ratio = std::clamp(young / (2 * shear) - 1, 0.0, 0.45);
  isotropic.youngs_modulus_pa = 2 * (1 + isotropic.poisson_ratio) * shear;
  isotropic.orthotropy.reset();
  return isotropic;
}

Result<fem::Matrix6> stiffness_at(const modal::Material& material, const Grain& grain, const Eigen::Vector3d& point_m) {
  if (auto good = check_grain(material, grain); !good) return fail(good);
  return fem::orthotropic_stiffness(constants_of(*material.orthotropy, 1)).map([&](const fem::Matrix6& stiffness) {
    return fem::rotated(stiffness, axes_at(grain, point_m));
  });
}

}  // namespace ringdown::bake

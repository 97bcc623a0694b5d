#include "engine/scene/contact/contact_side.h"

#include "engine/scene/rotation.h"

namespace ringdown::scene {
namespace {

Elastic elastic_of(const FrictionSurface& surface, const modal::Bank* bank, const modal::MaterialScale& scale) {
  Elastic elastic;
  if (bank && bank->material && bank->material->youngs_modulus_pa > 0) {
    elastic = {bank->material->youngs_modulus_pa * scale.stiffness, bank->material->poisson_ratio};
  }
  return {surface.young_pa.value_or(elastic.young_pa), surface.poisson.value_or(elastic.poisson)};
}

Curvature curvature_of(const CollisionShape& shape, const FrictionSurface& surface) {
  if (shape.type == ShapeType::sphere) return {Curvature::sphere, shape.radius_m};
  return {Curvature::edged, surface.edge_radius_m};
}

}  // namespace

const ContactSide* find(const ContactSides& sides, BodyId id) {
  const auto found = sides.find(id);
  return found == sides.end() ? nullptr : &found->second;
}

Vec3 to_object(const Motion& motion, const ContactSide& side, Vec3 world_m) {
  return transpose(to_matrix(motion.rotation)) * (world_m - motion.position_m) + side.center_m;
}

double inverse_mass(const ContactSide& side, const Motion& motion, Vec3 point_m, Vec3 normal) {
  if (!side.mass) return 0;
  return inverse_effective_mass(*side.mass, to_matrix(motion.rotation), point_m - motion.position_m, normal);
}

double inverse_mass(const ContactSide& side, const Motion& motion, const PushedPlace& at, const PushedPlace& push) {
  if (!side.mass) return 0;
  const Matrix3 turn = to_matrix(motion.rotation);
  const Vec3 moment = transpose(turn) * cross(push.point_m - motion.position_m, push.normal);
  const Vec3 spin = turn * (inverse(side.mass->inertia_kg_m2) * moment);
  return dot(at.normal, push.normal) / side.mass->mass_kg + dot(at.normal, cross(spin, at.point_m - motion.position_m));
}

ContactSide side_of(const BodyDescription& body, const Solid& solid, const modal::Bank* bank,
                    const modal::MaterialScale& scale) {
  ContactSide side{.surface = body.surface,
                   .elastic = elastic_of(body.surface, bank, scale),
                   .curvature = curvature_of(solid.shape, body.surface),
                   .breaks = body.breaks.has_value(),
                   .two_way = body.two_way,
                   .center_m = solid.mass.center_m};
  if (!body.fixed) side.mass = solid.mass;
  if (side.breaks) side.corners_m = solid.shape.points;
  return side;
}

ContactSide side_of(const StaticDescription& description) {
  const bool plane = description.type == StaticType::plane;
  return {.surface = description.surface,
          .elastic = elastic_of(description.surface, nullptr, {}),
          .curvature = {plane ? Curvature::flat : Curvature::edged, description.surface.edge_radius_m}};
}

}  // namespace ringdown::scene

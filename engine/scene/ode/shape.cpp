#include "engine/scene/ode/shape.h"

#include "engine/scene/rotation.h"

#include <ode/ode.h>

#include <cassert>

namespace ringdown::scene {
namespace {

void flatten(const CollisionShape& shape, OdeShape& out) {
  for (const Vec3& p : shape.points) out.points.insert(out.points.end(), {p.x, p.y, p.z});
}

dxGeom* convex_of(dxSpace* space, const OdeShape& shape) {
  return dCreateConvex(space, shape.planes.data(), static_cast<unsigned>(shape.planes.size() / 4), shape.points.data(),
                       static_cast<unsigned>(shape.points.size() / 3), shape.indices.data());
}

// ODE wants a plane per face, and each face as its corner count followed by the corners.
void make_convex(dxSpace* space, const CollisionShape& shape, OdeShape& out) {
  flatten(shape, out);
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3 area = cross(shape.points[b] - shape.points[a], shape.points[c] - shape.points[a]);
    const Vec3 normal = (1 / length(area)) * area;
    out.planes.insert(out.planes.end(), {normal.x, normal.y, normal.z, dot(normal, shape.points[a])});
    out.indices.insert(out.indices.end(), {3, a, b, c});
  }
  out.faces = flat_faces(shape.points, shape.triangles);
  out.surface = make_surface(shape.points, shape.triangles);
  out.geom.reset(convex_of(space, out));
}

// ODE ends the process when a convex shape meets a trimesh without preprocessed face angles.
void make_trimesh(dxSpace* space, const CollisionShape& shape, OdeShape& out) {
  flatten(shape, out);
  for (const auto& triangle : shape.triangles) out.indices.insert(out.indices.end(), triangle.begin(), triangle.end());
  out.surface = make_surface(shape.points, shape.triangles);
  out.mesh.reset(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(out.mesh.get(), out.points.data(), 3 * sizeof(double),
                              static_cast<int>(shape.points.size()), out.indices.data(),
                              static_cast<int>(out.indices.size()), 3 * sizeof(std::uint32_t));
  const unsigned wanted = 1u << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES | 1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES;
  dGeomTriMeshDataPreprocess2(out.mesh.get(), wanted, nullptr);
  out.geom.reset(dCreateTriMesh(space, out.mesh.get(), nullptr, nullptr, nullptr));
}

}  // namespace

void GeomDeleter::operator()(dxGeom* geom) const { dGeomDestroy(geom); }
void MeshDeleter::operator()(dxTriMeshData* data) const { dGeomTriMeshDataDestroy(data); }
void SpaceDeleter::operator()(dxSpace* space) const { dSpaceDestroy(space); }
void WorldDeleter::operator()(dxWorld* world) const { dWorldDestroy(world); }

OdeShape make_shape(dxSpace* space, const CollisionShape& shape) {
  OdeShape out;
  switch (shape.type) {
    case ShapeType::box:
      out.geom.reset(dCreateBox(space, shape.size_m.x, shape.size_m.y, shape.size_m.z));
      out.faces = box_faces(shape.size_m);
      out.surface = box_surface(shape.size_m);
      break;
    case ShapeType::sphere:
      out.geom.reset(dCreateSphere(space, shape.radius_m));
      break;
    case ShapeType::convex:
      make_convex(space, shape, out);
      break;
    case ShapeType::trimesh:
      make_trimesh(space, shape, out);
      break;
  }
  assert(out.geom);
  return out;
}

dxGeom* ghost_of(OdeShape& shape) {
  if (shape.ghost) return shape.ghost.get();
  dVector3 size;
  switch (dGeomGetClass(shape.geom.get())) {
    case dBoxClass:
      dGeomBoxGetLengths(shape.geom.get(), size);
      shape.ghost.reset(dCreateBox(nullptr, size[0], size[1], size[2]));
      break;
    case dSphereClass:
      shape.ghost.reset(dCreateSphere(nullptr, dGeomSphereGetRadius(shape.geom.get())));
      break;
    case dConvexClass:
      shape.ghost.reset(convex_of(nullptr, shape));
      break;
    default:
      shape.ghost.reset(dCreateTriMesh(nullptr, shape.mesh.get(), nullptr, nullptr, nullptr));
  }
  return shape.ghost.get();
}

OdeShape make_static(dxSpace* space, const StaticDescription& description) {
  OdeShape out;
  if (description.type == StaticType::plane) {
    const Vec3 normal = (1 / length(description.normal)) * description.normal;
    out.geom.reset(dCreatePlane(space, normal.x, normal.y, normal.z, description.offset_m));
    return out;
  }
  const Vec3 size = description.size_m, position = description.position_m;
  const Rotation rotation = normalized(description.rotation);
  out.geom.reset(dCreateBox(space, size.x, size.y, size.z));
  out.faces = box_faces(size);
  out.surface = box_surface(size);
  dGeomSetPosition(out.geom.get(), position.x, position.y, position.z);
  const dQuaternion q = {rotation.w, rotation.x, rotation.y, rotation.z};
  dGeomSetQuaternion(out.geom.get(), q);
  return out;
}

}  // namespace ringdown::scene

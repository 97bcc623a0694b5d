// From plain shapes to ODE geometries. ODE's types are only named here, so that its headers stay in the .cpp files.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/faces.h"
#include "engine/scene/solid.h"

#include <cstdint>
#include <memory>
#include <vector>

struct dxGeom;
struct dxSpace;
struct dxTriMeshData;

namespace ringdown::scene {

struct GeomDeleter {
  void operator()(dxGeom* geom) const;
};
struct MeshDeleter {
  void operator()(dxTriMeshData* data) const;
};

// An ODE geometry and the arrays it points into. The geometry leaves its space when this goes. Callers hold OdeLock.
struct OdeShape {
  std::vector<double> points, planes;
  std::vector<std::uint32_t> indices;
  std::vector<Face> faces;  // of a box or a hull, in the geometry's own frame
  std::unique_ptr<dxTriMeshData, MeshDeleter> mesh;
  std::unique_ptr<dxGeom, GeomDeleter> geom;
};

// The shape about the centre of mass; attach it to a body, then place it by `shape.center_m`.
OdeShape make_shape(dxSpace* space, const CollisionShape& shape);

// What stands still, in its place.
OdeShape make_static(dxSpace* space, const StaticDescription& description);

}  // namespace ringdown::scene

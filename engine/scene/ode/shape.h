// Makes ODE geometries from plain shapes. This header only names ODE's types, so that ODE's headers stay in .cpp files.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/faces.h"
#include "engine/scene/solid.h"
#include "engine/scene/surface.h"

#include <cstdint>
#include <memory>
#include <vector>

struct dxGeom;
struct dxSpace;
struct dxTriMeshData;
struct dxWorld;

namespace ringdown::scene {

struct GeomDeleter {
  void operator()(dxGeom* geom) const;
};
struct MeshDeleter {
  void operator()(dxTriMeshData* data) const;
};
struct SpaceDeleter {
  void operator()(dxSpace* space) const;
};
struct WorldDeleter {
  void operator()(dxWorld* world) const;
};

// An ODE geometry and the arrays it points into. Destruction removes the geometry from its space. Callers hold OdeLock.
struct OdeShape {
  std::vector<double> points, planes;
  std::vector<std::uint32_t> indices;
  std::vector<Face> faces;  // of a box or a hull, in the geometry's own frame
  Surface surface;          // of a box, a hull or a mesh, in the geometry's own frame
  std::unique_ptr<dxTriMeshData, MeshDeleter> mesh;
  std::unique_ptr<dxGeom, GeomDeleter> geom;
  std::unique_ptr<dxGeom, GeomDeleter> ghost;  // see ghost_of()
};

// Makes the geometry of a body's shape. The caller attaches it to a body, and then sets its offset to `shape.center_m`.
OdeShape make_shape(dxSpace* space, const CollisionShape& shape);

// Returns a second geometry of the same shape that belongs to no space and no body. Callers may place it anywhere to
// test what the shape would touch there. Made on the first call.
dxGeom* ghost_of(OdeShape& shape);

// Makes the geometry of a static, in its position.
OdeShape make_static(dxSpace* space, const StaticDescription& description);

}  // namespace ringdown::scene

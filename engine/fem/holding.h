// The supports of a body: parts of its surface that are clamped, slide, or rest on springs, and masses glued on.
// [worker]
//
// A layer of springs adds to the stiffness, and a glued mass to the mass, for the shape functions N_a of a face:
//
//   K_ab += integral of  N_a N_b (k_n n n^T + k_t (I - n n^T)) dS        k in N/m for each m^2
//   M_ab += integral of  N_a N_b m dS                                    m in kg/m^2
//
// with n the surface's normal, or one direction for all of it. Clamped nodes leave the system: what is left has the
// same form (assembly.h), so that every method of engine/solve takes it. A surface that slides is a layer with k_t = 0
// and a k_n beside which the body is soft (kRigid in bake/fitted_makeup.cpp).
#pragma once

#include "engine/fem/assembly.h"
#include "engine/mesh/boundary.h"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace ringdown::fem {

struct Layer {
  std::vector<mesh::OuterFace> faces;
  double normal_n_m3 = 0, tangential_n_m3 = 0;
  double mass_kg_m2 = 0;
  std::optional<Eigen::Vector3d> direction = std::nullopt;  // of length 1, in place of the normal
};

struct Holding {
  std::vector<mesh::OuterFace> clamped;
  std::vector<Layer> layers;
};

// A point of an element's face: `area` is what it stands for.
struct FacePoint {
  Eigen::Vector4d barycentric;
  Eigen::Vector3d normal;  // of length 1; inward when the element is inside out
  double area = 0;
};
// Stiffness of a layer at a point, for each area [N/m^3]: k_n n n^T + k_t (I - n n^T).
Eigen::Matrix3d stiffness_at(const Layer& layer, const FacePoint& point);

// Exact for products of two shape functions on straight faces.
std::vector<FacePoint> points_on_face(const mesh::ElementNodes& nodes, int opposite);

// Areas of faces, and their mean normal, whose length is 1 only where they are flat.
struct Extent {
  double area = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};
Extent extent_of(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces);

// Adds the layers to a system that assemble() made of that mesh.
void add_layers(const mesh::TetMesh& mesh, const Holding& holding, System& system);

// Numbers of the nodes on faces, ascending.
std::vector<std::int32_t> nodes_on(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces);

// The system without those nodes, and shapes (3N' x m) of it with zeros put in their places: 3N x m.
void remove_nodes(const std::vector<std::int32_t>& nodes, const System& whole, System& left);
Eigen::MatrixXd with_nodes(const Eigen::Ref<const Eigen::MatrixXd>& shapes, const std::vector<std::int32_t>& nodes);

// How many of a body's rigid motions cost no energy: six for each piece, less what the holding resists.
int free_motions(const mesh::TetMesh& mesh, const Holding& holding);

// For each mode, the integrals over the faces of (phi . n)^2 and of |phi|^2 - (phi . n)^2: 2 x m.
Eigen::MatrixXd motion_on(const mesh::TetMesh& mesh, const Layer& layer,
                          const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace ringdown::fem

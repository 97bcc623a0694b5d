// The supports of a body: parts of its surface that are clamped, slide, or rest on springs, masses glued on, and points
// that cords touch.
// [worker]
//
// A layer of springs adds to the stiffness, and a glued mass to the mass, for the shape functions N_a of a face:
//
//   K_ab += integral of  N_a N_b (k_n n n^T + k_t (I - n n^T)) dS        k in N/m per m^2
//   M_ab += integral of  N_a N_b m dS                                    m in kg/m^2
//
// with n the surface's normal, or one direction for all of it. Clamped nodes are removed from the system. The rest
// keeps its form (assembly.h), so every method of engine/solve accepts it. A sliding surface is a layer with k_t = 0
// and a k_n that is stiff compared with the body (kRigid in bake/fitted_makeup.cpp).
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
  std::optional<Eigen::Vector3d> direction = std::nullopt;  // unit vector that replaces the normal
};

// A point of the surface, and the mass that moves with it.
struct HeldPoint {
  Eigen::Index element = 0;
  Eigen::Vector4d barycentric = Eigen::Vector4d::Zero();
  double mass_kg = 0;
  double distance = 0;  // of the point that was asked for
};

struct Holding {
  std::vector<mesh::OuterFace> clamped;
  std::vector<Layer> layers;
  std::vector<HeldPoint> points;
};

// The point of the faces that is nearest to `point`, with the faces taken to be flat between their corners. There must
// be a face.
HeldPoint nearest_point(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces,
                        const Eigen::Vector3d& point);

// A point on an element's face, with its share of the face's area.
struct FacePoint {
  Eigen::Vector4d barycentric;
  Eigen::Vector3d normal;  // unit vector; points inward when the element is inside out
  double area = 0;
};
// Stiffness of a layer at a point, per area [N/m^3]: k_n n n^T + k_t (I - n n^T).
Eigen::Matrix3d stiffness_at(const Layer& layer, const FacePoint& point);

// A quadrature rule on one face, exact for products of two shape functions on straight faces.
std::vector<FacePoint> points_on_face(const mesh::ElementNodes& nodes, int opposite);

// Total area and mean normal of faces. The normal's length is 1 only for flat faces.
struct Extent {
  double area = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};
Extent extent_of(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces);

// Adds the layers and the points' masses to a system that assemble() made of `mesh`.
void add_layers(const mesh::TetMesh& mesh, const Holding& holding, System& system);

// The numbers of the nodes on the faces, ascending.
std::vector<std::int32_t> nodes_on(const mesh::TetMesh& mesh, const std::vector<mesh::OuterFace>& faces);

// remove_nodes() writes the system without `nodes` to `left`. with_nodes() expands shapes of that system (3N' x m) to
// 3N x m, with zeros at `nodes`.
void remove_nodes(const std::vector<std::int32_t>& nodes, const System& whole, System& left);
Eigen::MatrixXd with_nodes(const Eigen::Ref<const Eigen::MatrixXd>& shapes, const std::vector<std::int32_t>& nodes);

// The number of rigid motions that cost no energy: six for each piece, less those that the holding resists.
int free_motions(const mesh::TetMesh& mesh, const Holding& holding);

// For each mode, the integrals over the faces of (phi . n)^2 and of |phi|^2 - (phi . n)^2: 2 x m.
Eigen::MatrixXd motion_on(const mesh::TetMesh& mesh, const Layer& layer,
                          const Eigen::Ref<const Eigen::MatrixXd>& shapes);

// |phi|^2 at each point for each mode: points x m.
Eigen::MatrixXd motion_at(const mesh::TetMesh& mesh, const std::vector<HeldPoint>& points,
                          const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace ringdown::fem

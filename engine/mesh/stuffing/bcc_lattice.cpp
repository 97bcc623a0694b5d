#include "engine/mesh/stuffing/bcc_lattice.h"

// Cutting one tetrahedron of the lattice
//
// Up to symmetry a tetrahedron can be cut in few ways (stencil()). One corner inside leaves a smaller tetrahedron; two
// inside, one on the surface and one outside leave a pyramid; all other cases leave a prism. The prism's
// quadrilaterals, except one on the surface, lie on faces of the lattice, so the neighbouring tetrahedron must split
// them along the same diagonal. diagonal_at() chooses the diagonal from the face's lattice coordinates alone: if a long
// and a short edge are cut, by the lengths of the edges; if both are short, by a parity of signs that both neighbours
// compute alike. A prism whose three diagonals run around in a ring cannot be filled with tetrahedra; the choice always
// leaves one corner with two diagonals, and add_prism() begins there.
namespace ringdown::mesh {
namespace {

using Sites = std::array<BccLattice::Site, 4>;

bool is_long(int a, int b) { return a / 2 == b / 2; }

StencilPoint corner(int a) { return {static_cast<std::int8_t>(a), static_cast<std::int8_t>(a)}; }
StencilPoint cut(int a, int b) { return {static_cast<std::int8_t>(a), static_cast<std::int8_t>(b)}; }

// Returns true if the diagonal of the quadrilateral u, v, (v w), (u w) runs from u to (v w), and false if from v to
// (u w).
bool diagonal_at(const Sites& sites, int u, int v, int w) {
  if (!is_long(u, v)) return is_long(v, w);
  // `along` is the edge u v; `aside` leads from its middle to w. Seen from u, the cut point of v w lies beyond the
  // middle of u v and aside in the direction of w.
  const BccLattice::Site along = sites[v] - sites[u], aside = sites[w] - (sites[u] + sites[v]) / 2;
  int greater = 0;
  for (int k = 0; k < 3; ++k) greater += along[k] < 0 || aside[k] < 0;
  return greater % 2 == 0;
}

void add(Stencil& to, StencilPoint a, StencilPoint b, StencilPoint c, StencilPoint d) {
  to.elements[to.count++] = {a, b, c, d};
}

using StencilFace = std::array<StencilPoint, 3>;

// Adds the prism between triangles u and v. at[i][j]: the diagonal of u_i u_j v_j v_i is u_i v_j. One u has two
// diagonals.
void add_prism(Stencil& to, const StencilFace& u, const StencilFace& v, const bool (&at)[3][3]) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (!at[i][j] || !at[i][k]) continue;
    add(to, u[i], v[0], v[1], v[2]);
    add(to, u[i], u[j], u[k], at[j][k] ? v[k] : v[j]);
    add(to, u[i], at[j][k] ? u[j] : u[k], v[j], v[k]);
    return;
  }
}

void two_inside(Stencil& to, const Sites& sites, int a, int b, int m, int n) {
  const bool first = diagonal_at(sites, a, b, m), second = diagonal_at(sites, a, b, n);
  bool at[3][3] = {};
  at[0][1] = first;
  at[1][0] = !first;
  at[0][2] = second;
  at[2][0] = !second;
  // No neighbour shares the quadrilateral on the surface, so its diagonal is free. This choice avoids the ring.
  at[1][2] = second;
  at[2][1] = !second;
  add_prism(to, {corner(a), cut(a, m), cut(a, n)}, {corner(b), cut(b, m), cut(b, n)}, at);
}

void three_inside(Stencil& to, const Sites& sites, const std::array<int, 3>& in, int out) {
  bool at[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) at[i][j] = i != j && diagonal_at(sites, in[i], in[j], out);
  }
  add_prism(to, {corner(in[0]), corner(in[1]), corner(in[2])}, {cut(in[0], out), cut(in[1], out), cut(in[2], out)}, at);
}

}  // namespace

Stencil stencil(const Sites& sites, const std::array<Side, 4>& sides) {
  Stencil result;
  std::array<int, 4> in{}, on{}, out{};
  int ins = 0, ons = 0, outs = 0;
  for (int c = 0; c < 4; ++c) {
    if (sides[c] == Side::inside) in[ins++] = c;
    if (sides[c] == Side::surface) on[ons++] = c;
    if (sides[c] == Side::outside) out[outs++] = c;
  }
  if (ins == 0) return result;
  if (outs == 0) {
    add(result, corner(0), corner(1), corner(2), corner(3));
  } else if (ins == 1) {
    std::array<StencilPoint, 4> points;
    for (int c = 0; c < 4; ++c) points[c] = sides[c] == Side::outside ? cut(in[0], c) : corner(c);
    result.elements[result.count++] = points;
  } else if (outs == 2) {
    two_inside(result, sites, in[0], in[1], out[0], out[1]);
  } else if (ons == 1) {
    const int u = in[0], v = in[1], w = out[0];
    const bool at_u = diagonal_at(sites, u, v, w);
    add(result, corner(on[0]), corner(u), corner(v), at_u ? cut(v, w) : cut(u, w));
    add(result, corner(on[0]), at_u ? corner(u) : corner(v), cut(u, w), cut(v, w));
  } else {
    three_inside(result, sites, {in[0], in[1], in[2]}, out[0]);
  }
  return result;
}

}  // namespace ringdown::mesh

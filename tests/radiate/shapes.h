// Bodies and exact answers for the tests of radiation. Shares no code with engine/radiate.
#pragma once

#include "engine/radiate/radiate.h"

#include <Eigen/Core>

#include <complex>
#include <functional>

namespace ringdown {

// A sphere about the origin: an icosahedron whose sides are divided into `parts`.
mesh::TriangleMesh sphere(double radius_m, int parts);

// A disc in the plane z = 0, thick beside the radius 1 by `thickness`, of `rings` rings.
mesh::TriangleMesh disc(int rings, double thickness);

// A box about the origin, each face a grid of right triangles with sides of at most `side_m`.
mesh::TriangleMesh box(const Eigen::Vector3d& size_m, double side_m);

// Samples of a flow that is known everywhere: q(point, outward normal) for each mode. Triangles are divided until their
// sides are shorter than `side_m`, and within `graded` distances of `center` shorter than that share of their distance.
radiate::FlowSamples sample(const mesh::TriangleMesh& surface, int modes,
                            const std::function<double(int, const Eigen::Vector3d&, const Eigen::Vector3d&)>& flow,
                            double side_m, const Eigen::Vector3d& center = {1e9, 0, 0}, double graded = 0.3);

// The far field of a sphere of radius a that vibrates with a real harmonic of degree n and amplitude 1: the factor F
// has beside that harmonic. By recurrence of spherical Hankel functions in extended precision.
std::complex<double> sphere_factor(int n, double k, double a);

// A pulsating sphere's power over that, at unit amplitude of both [dB]: how far below a vibration of degree n radiates.
double below_pulsation_db(int n, double ka);

}  // namespace ringdown

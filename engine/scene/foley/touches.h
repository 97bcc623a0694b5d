// The touches of pairs of bodies between two frames of an animation, and which of them are blows. [any thread]
#pragma once

#include "engine/scene/foley/recovery.h"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace ringdown::scene {

using BodyIndices = std::pair<std::size_t, std::size_t>;  // of two bodies; the first one moves

// How two bodies come together at the fastest of their contact points.
struct Closing {
  double approach_m_s = 0, parting_m_s = 0;  // along the normal, before and after
  Vec3 normal;
  double inverse_mass = 0;  // of both, at the point and along the normal
};

// The contacts of a pair in one interval, and the impulses at its points around the frames before and after.
struct Touch {
  BodyIndices pair;
  Meeting met;
  std::vector<Vec3> before_ns, after_ns;
  Closing closing;
  bool blow = false;          // the two strike each other
  bool answers = false;       // the second carries the first, immovable, while another body strikes the first
  double share = 0;           // of the interval, when one of these happens
  std::vector<Vec3> blow_ns;  // impulses of that at the points
  std::size_t contacts = 0, loads_before = 0, loads_after = 0;  // their first contacts in the system of pushes
};

// Returns the part of the pair's impulse that each point carries, and the mean point with these weights.
std::vector<double> shares_of(const Touch& touch);
Vec3 mean_point(const Touch& touch);

// Finds out which touches of interval `k` are blows faster than `strike_m_s`, and removes those that cannot have been:
// a blow on one of the bodies, before or after the touch, led the body away from where the touch was seen.
void find_blows(std::span<const FoleyBody> bodies, std::vector<Touch>& touches, std::size_t k, double strike_m_s);

// Returns the speed at which the other blows of interval `k` send the two bodies of a touch against each other.
double sent_m_s(std::span<const FoleyBody> bodies, std::span<const Touch> touches, const Touch& touch, std::size_t k);

}  // namespace ringdown::scene

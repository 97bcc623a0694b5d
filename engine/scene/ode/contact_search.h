// The search for contacts of two geometries: by their surfaces where those serve better, and by ODE elsewhere. Callers
// hold OdeLock.
#pragma once

#include <cstddef>
#include <span>

struct dContactGeom;
struct dxGeom;

namespace ringdown::scene {

class SurfacePairs;

// The deepest, and those farthest from each other; of bodies that touch in several directions, some more.
inline constexpr std::size_t kMaxContactsPerPair = 4, kMaxContactsOfShells = 8;

// The most contacts of a pair out of which overlapping bodies are moved.
inline constexpr std::size_t kMaxContactsMoved = 24;

// A mesh on a plane gives one contact per vertex, of which a good few are then chosen.
inline constexpr int kMaxContactsFound = 256;

struct FoundContacts {
  std::span<dContactGeom> carry;  // hold the bodies: each becomes a joint
  std::span<dContactGeom> move;   // further ones, out of which overlapping bodies are moved
};

// Finds the contacts of two geometries: the deepest, and those that differ most from each other. Normals point into the
// first. `room` holds kMaxContactsFound entries; the results are parts of it. `part_s` is how long the bodies have
// moved since contacts were last looked for. The user data of both geometries is their Collider.
FoundContacts find_contacts(dxGeom* first, dxGeom* second, SurfacePairs& pairs, std::span<dContactGeom> room,
                            double part_s);

}  // namespace ringdown::scene

// Finds the contacts of two geometries: by their surfaces if those give better contacts, otherwise by ODE. Callers must
// hold OdeLock.
#pragma once

#include <cstddef>
#include <span>

struct dContactGeom;
struct dxGeom;

namespace ringdown::scene {

class SurfacePairs;

// Maximum number of contacts of a pair that become joints: the deepest, and those that differ most from each other.
// Pairs that touch in several directions get the larger number.
inline constexpr std::size_t kMaxContactsPerPair = 4, kMaxContactsOfShells = 8;

// Maximum number of contacts of a pair that are used to move overlapping bodies apart.
inline constexpr std::size_t kMaxContactsMoved = 24;

// Maximum number of contacts found, from which the best are chosen. A mesh on a plane gives one contact per vertex.
inline constexpr int kMaxContactsFound = 256;

struct FoundContacts {
  std::span<dContactGeom> carry;  // contacts that hold the bodies; each becomes a joint
  std::span<dContactGeom> move;   // further contacts, used only to move overlapping bodies apart
};

// Finds the contacts of two geometries: the deepest, and those that differ most from each other. Normals point into the
// first body. `room` holds kMaxContactsFound entries; the results are parts of `room`. `part_s` is the time that the
// bodies have moved since the last search.
FoundContacts find_contacts(dxGeom* first, dxGeom* second, SurfacePairs& pairs, std::span<dContactGeom> room,
                            double part_s);

}  // namespace ringdown::scene

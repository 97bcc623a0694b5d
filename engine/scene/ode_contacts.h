// The points at which two ODE geometries touch. Callers hold OdeLock. This header only names ODE's types.
#pragma once

#include <cstddef>
#include <span>

struct dContactGeom;
struct dxGeom;

namespace ringdown::scene {

inline constexpr std::size_t kMaxContactsPerPair = 4;  // the deepest, and those farthest from each other

// A mesh on a plane gives one contact per vertex, of which a good few are then chosen.
inline constexpr int kMaxContactsFound = 256;

// Finds at most kMaxContactsPerPair contacts of two geometries: the deepest, and those farthest from each other.
// Normals point into the first. `room` holds kMaxContactsFound entries; the result is a part of it. `part_s` is how
// long the bodies have moved since contacts were last looked for. The user data of both geometries is their Collider.
std::span<dContactGeom> find_contacts(dxGeom* first, dxGeom* second, std::span<dContactGeom> room, double part_s);

}  // namespace ringdown::scene

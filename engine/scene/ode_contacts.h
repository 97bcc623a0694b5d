// Where two ODE geometries touch. Callers hold OdeLock. ODE's types are only named here.
#pragma once

#include <span>

struct dContactGeom;
struct dxGeom;

namespace ringdown::scene {

// A mesh touching a plane gives a contact per vertex: enough of them to choose a good few.
inline constexpr int kMaxContactsFound = 256;

// The contacts of the two, at most kMaxContactsPerPair: the deepest, and those farthest from each other. The normal
// points into the first. `room` holds kMaxContactsFound. `part_s` is how long the two have moved since they
// were looked at last. Both carry their Item as user data.
std::span<dContactGeom> find_contacts(dxGeom* first, dxGeom* second, std::span<dContactGeom> room, double part_s);

}  // namespace ringdown::scene

// Contacts that share bodies, solved together, one time step after another.
//
// Each contact has one to three directions: the normal, with Hunt and Crossley's law or a given load, and one or two
// directions along the surface, with bristles. A direction of a contact is a *freedom*; its change in a step is the
// approach, or the sliding, of the two surfaces. The network knows the bodies only by how much each freedom would
// change without forces, and by the compliances: a newton at freedom j lowers the change of freedom i by this much, a
// sum over modes. The number of bodies, their masses and modes do not affect the cost.
//
//   network.clear(); const auto i = network.add(contact); ... set_compliance(i, j, m_n) ...
//   each step: network.step(free_m, step_s, force_n)
//
// No memory is allocated after construction. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/contact/friction.h"
#include "engine/contact/impact.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace ringdown::contact {

inline constexpr std::size_t kMaxContacts = 16;  // contacts of a network
inline constexpr std::size_t kMaxFreedoms = 24;  // freedoms of all its contacts together

struct Contact {
  std::optional<ImpactLaw> impact;  // none: the surfaces are pressed together by load_n
  double load_n = 0;
  std::optional<FrictionLaw> friction;
  std::size_t directions = 0;  // number of directions along the surface: 0 without friction, else 1 or 2
  Impact pressed;              // states
  Friction sliding;
  bool on = true;  // false: the contact neither touches nor rubs

  [[nodiscard]] std::size_t freedoms() const REALTIME { return (impact ? 1 : 0) + directions; }
};

class Network {
 public:
  void clear() REALTIME {
    contacts_ = freedoms_ = 0;
    fresh_ = true;
  }
  // Adds a contact and returns its first freedom: its normal, then its directions along the surface. The contact must
  // outlive the network or its next clear(). Returns nullopt if there is no room.
  [[nodiscard]] std::optional<std::size_t> add(Contact& contact) REALTIME;
  [[nodiscard]] std::size_t freedoms() const REALTIME { return freedoms_; }
  void set_compliance(std::size_t i, std::size_t j, double m_n) REALTIME {
    compliance_[i][j] = compliance_[j][i] = m_n;
  }

  // Computes the forces of a step from the changes of the freedoms without forces. Returns false if all forces are 0.
  bool step(std::span<const double> free_m, double step_s, std::span<double> force_n) REALTIME;

 private:
  struct Place {
    Contact* contact = nullptr;
    std::size_t first = 0;
    Impact::Step impact;
    Friction::Step friction;
    bool works = false, rubs = false, released = false;
  };
  void foresee(Place& place, std::span<const double> free_m, double step_s, std::span<double> force_n) REALTIME;
  [[nodiscard]] double free_of(std::size_t i, std::span<const double> free_m, std::span<const double> force_n,
                               std::size_t skip, std::size_t skip_count) const REALTIME;
  void close(std::span<const double> free_m, std::span<double> force_n) REALTIME;

  std::array<Place, kMaxContacts> places_;
  std::size_t contacts_ = 0, freedoms_ = 0;
  std::array<std::array<double, kMaxFreedoms>, kMaxFreedoms> compliance_{};
  bool fresh_ = true;                        // whether a contact has just begun or ended
  std::array<double, kMaxFreedoms> last_{};  // forces of the last step; the next prediction starts from them
};

}  // namespace ringdown::contact

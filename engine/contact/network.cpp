// A step has two halves. First each contact predicts its own force, with the others' forces held at the last step's
// values, or, if a contact has just begun or ended, in two rounds (Gauss-Seidel). This turns every law into a straight
// line, f = a + b x. Then all lines are solved together with the bodies' x = free - Z f:
//
//   (1 + B Z) f = a + B free,
//
// which is exact to rounding for any prediction, so that the passivity of the lines ensures that no energy is created.
// A normal force that comes out negative is released, with its friction, and the rest is solved again.
//
// 1 + B Z is a symmetric positive definite matrix between two diagonal ones, so elimination needs no pivots.
#include "engine/contact/network.h"

#include <algorithm>
#include <cstddef>

namespace ringdown::contact {

std::optional<std::size_t> Network::add(Contact& contact) REALTIME {
  const std::size_t wanted = contact.freedoms();
  if (contacts_ == kMaxContacts || freedoms_ + wanted > kMaxFreedoms) return std::nullopt;
  const std::size_t first = freedoms_;
  places_[contacts_++] = {.contact = &contact, .first = first};
  freedoms_ += wanted;
  for (std::size_t i = first; i < freedoms_; ++i) {
    last_[i] = 0;
    for (std::size_t j = 0; j < freedoms_; ++j) set_compliance(i, j, 0);
  }
  return first;
}

// Returns by how much [m] freedom i would change under the other contacts' forces: all but `skip_count` freedoms from
// `skip` on.
double Network::free_of(std::size_t i, std::span<const double> free_m, std::span<const double> force_n,
                        std::size_t skip, std::size_t skip_count) const REALTIME {
  double change = free_m[i];
  for (std::size_t j = 0; j < skip; ++j) change -= compliance_[i][j] * force_n[j];
  for (std::size_t j = skip + skip_count; j < freedoms_; ++j) change -= compliance_[i][j] * force_n[j];
  return change;
}

void Network::foresee(Place& place, std::span<const double> free_m, double step_s, std::span<double> force_n) REALTIME {
  Contact& contact = *place.contact;
  double normal_n = contact.load_n;
  std::size_t at = place.first;
  place.works = place.rubs = place.released = false;
  if (contact.impact) {
    place.impact =
        contact.pressed.foresee(*contact.impact, free_of(at, free_m, force_n, at, 1), compliance_[at][at], step_s);
    place.works = place.impact.touches;
    force_n[at] = normal_n = place.impact.force_n;
    ++at;
  }
  if (!contact.friction || contact.directions == 0) return;
  const bool two = contact.directions == 2;
  if (normal_n > 0) {
    const Along free{free_of(at, free_m, force_n, at, contact.directions),
                     two ? free_of(at + 1, free_m, force_n, at, 2) : 0};
    const AlongCompliance z{compliance_[at][at], two ? compliance_[at][at + 1] : 0,
                            two ? compliance_[at + 1][at + 1] : 0};
    place.friction = contact.sliding.foresee(*contact.friction, normal_n, free, z, step_s);
    place.works = place.rubs = true;
  } else {
    contact.sliding.release();
    place.friction = {};
  }
  force_n[at] = place.friction.force_n[0];
  if (two) force_n[at + 1] = place.friction.force_n[1];
}

void Network::close(std::span<const double> free_m, std::span<double> force_n) REALTIME {
  std::array<double, kMaxFreedoms> slope;
  std::array<std::size_t, kMaxFreedoms> row;
  std::size_t rows = 0;
  const auto put = [&](std::size_t i, double at_rest, double per_m) REALTIME {
    row[rows] = i;
    slope[rows] = per_m;
    force_n[i] = at_rest + per_m * free_m[i];
    ++rows;
  };
  for (std::size_t c = 0; c < contacts_; ++c) {
    const Place& place = places_[c];
    if (!place.works || place.released) continue;
    std::size_t at = place.first;
    if (place.contact->impact) put(at++, place.impact.line.at_rest, place.impact.line.per_m);
    for (std::size_t k = 0; k < place.contact->directions; ++k) {
      put(at + k, place.friction.at_rest[k], place.friction.per_m);
    }
  }
  std::array<std::array<double, kMaxFreedoms>, kMaxFreedoms> matrix;
  std::array<double, kMaxFreedoms> value;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rows; ++j) matrix[i][j] = slope[i] * compliance_[row[i]][row[j]];
    matrix[i][i] += 1;
    value[i] = force_n[row[i]];
  }
  for (std::size_t i = 0; i < rows; ++i) {
    const double pivot = 1 / matrix[i][i];
    for (std::size_t k = i + 1; k < rows; ++k) {
      const double by = matrix[k][i] * pivot;
      for (std::size_t j = i + 1; j < rows; ++j) matrix[k][j] -= by * matrix[i][j];
      value[k] -= by * value[i];
    }
  }
  for (std::size_t i = rows; i-- > 0;) {
    for (std::size_t j = i + 1; j < rows; ++j) value[i] -= matrix[i][j] * value[j];
    value[i] /= matrix[i][i];
    force_n[row[i]] = value[i];
  }
}

bool Network::step(std::span<const double> free_m, double step_s, std::span<double> force_n) REALTIME {
  std::copy_n(last_.begin(), freedoms_, force_n.begin());
  const int sweeps = fresh_ && freedoms_ > 1 ? 2 : 1;
  bool works = false, fresh = false;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    works = false;
    for (std::size_t c = 0; c < contacts_; ++c) {
      Place& place = places_[c];
      const bool worked = place.works;
      if (place.contact->on) {
        foresee(place, free_m, step_s, force_n);
      } else {
        place.works = place.released = false;
        std::fill_n(force_n.begin() + static_cast<std::ptrdiff_t>(place.first), place.contact->freedoms(), 0.0);
      }
      works = works || place.works;
      if (sweep == 0) fresh = fresh || place.works != worked;
    }
    if (!works) break;
  }
  fresh_ = fresh;
  for (bool again = works; again;) {
    std::fill_n(force_n.begin(), freedoms_, 0.0);
    close(free_m, force_n);
    again = false;
    for (std::size_t c = 0; c < contacts_; ++c) {
      Place& place = places_[c];
      if (!place.contact->impact || !place.works || place.released || force_n[place.first] >= 0) continue;
      place.released = again = true;
      place.contact->sliding.release();
    }
  }
  if (!works) std::fill_n(force_n.begin(), freedoms_, 0.0);
  for (std::size_t c = 0; c < contacts_; ++c) {
    Place& place = places_[c];
    Contact& contact = *place.contact;
    if (!contact.on) continue;
    std::size_t at = place.first;
    const auto change_of = [&](std::size_t i)
                               REALTIME { return works ? free_of(i, free_m, force_n, 0, 0) : free_m[i]; };
    if (contact.impact) contact.pressed.advance(*contact.impact, change_of(at++), place.released);
    if (place.rubs && !place.released) {
      contact.sliding.advance({change_of(at), contact.directions == 2 ? change_of(at + 1) : 0}, step_s);
    }
  }
  std::copy_n(force_n.begin(), freedoms_, last_.begin());
  return works;
}

}  // namespace ringdown::contact

#include "clients/plugin/window/shown_body.h"

#include "engine/modal/bank.h"

#include <algorithm>

namespace ringdown::plugin {
namespace {

ringdown_bank_info info_of(const ringdown_bank* bank) {
  ringdown_bank_info info{};
  info.size = sizeof info;
  ringdown_bank_describe(bank, &info);
  return info;
}

template <class Item, class Number>
void copy_triples(const Number* numbers, std::size_t count, std::vector<Item>& items) {
  for (std::size_t i = 0; i < count; ++i) items.push_back({numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
}

// The shape alone, as the viewer's functions take it.
modal::Bank surface_of(const ringdown_bank* bank) {
  const ringdown_bank_info info = info_of(bank);
  modal::Bank surface;
  copy_triples(ringdown_bank_points_m(bank), info.points, surface.positions);
  copy_triples(ringdown_bank_triangles(bank), info.triangles, surface.triangles);
  return surface;
}

std::size_t nearest_key(const KeyMap& map, std::size_t wanted) {
  for (std::size_t away = 0; away < kKeys; ++away) {
    if (wanted >= away && map.keys[wanted - away].sounds) return wanted - away;
    if (wanted + away < kKeys && map.keys[wanted + away].sounds) return wanted + away;
  }
  return wanted;
}

}  // namespace

viewer::Displacement ShownBody::displacement(std::size_t mode) const {
  const ringdown_bank_info info = info_of(bank.get());
  modal::Bank alone;
  alone.frequency_hz = {frequencies_hz[mode]};
  alone.positions.resize(info.points);
  copy_triples(ringdown_bank_shapes(bank.get()) + 3 * mode * info.points, info.points, alone.shapes);
  return viewer::mode_displacement(alone, 0);
}

Result<ShownBody> read_body(const Source& source, std::size_t key) {
  const auto plan = plan_keys(source, {});
  if (!plan) return fail(plan);
  ShownBody shown;
  shown.source = source.name;
  shown.is_note_map = plan->map.is_note_map;
  shown.key = nearest_key(plan->map, std::min(key, kKeys - 1));
  const std::size_t body = plan->map.objects[plan->map.keys[shown.key].object].body;
  shown.bank = plan->banks[body];
  shown.body = plan->map.bodies[body];
  shown.mesh = viewer::shaded_mesh(surface_of(shown.bank.get()));
  const ringdown_bank_info info = info_of(shown.bank.get());
  shown.material = info.material;
  const double* const frequencies_hz = ringdown_bank_frequencies_hz(shown.bank.get());
  const double* const decays_per_s = ringdown_bank_decays_per_s(shown.bank.get());
  shown.frequencies_hz.assign(frequencies_hz, frequencies_hz + info.modes);
  shown.decays_per_s.assign(decays_per_s, decays_per_s + info.modes);
  return shown;
}

}  // namespace ringdown::plugin

#include "engine/modal/mode_choice.h"

#include "engine/modal/fracture/fracture.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace ringdown::modal {

// Names every member of a bank, so that a new member that is not handled here does not compile.
void take_modes(Bank& bank, const std::vector<std::size_t>& order) {
  auto& [name, frequencies, decays, losses, heat, radiation, nonlinear, errors, shape_errors, positions, shapes,
         triangles, material, mass, held, gain, pitch, fracture, levels, cavity, provenance] = bank;
  levels.reset();  // their matrices are those of all modes
  if (fracture) {
    Fracture broken = *fracture;
    take_modes(broken, frequencies.size(), order);
    fracture = std::make_shared<const Fracture>(std::move(broken));
  }
  const auto take = [&order](auto& list, std::size_t width) {
    if (list.empty()) return;
    std::remove_reference_t<decltype(list)> chosen;
    chosen.reserve(order.size() * width);
    for (const std::size_t m : order) {
      const auto from = list.begin() + static_cast<std::ptrdiff_t>(m * width);
      chosen.insert(chosen.end(), from, from + static_cast<std::ptrdiff_t>(width));
    }
    list = std::move(chosen);
  };
  take(shapes, positions.size());
  take(frequencies, 1);
  take(decays, 1);
  take(losses, 1);
  take(heat, 1);
  take(errors, 1);
  take(shape_errors, 1);
  if (cavity) {
    std::vector<Cavity::Mode> chosen;
    for (const Cavity::Mode& mode : cavity->modes) {
      const auto at = std::ranges::find(order, mode.mode);
      if (at != order.end()) chosen.push_back({static_cast<std::uint32_t>(at - order.begin()), mode.flux});
    }
    cavity->modes = std::move(chosen);
    if (cavity->modes.empty()) cavity.reset();
  }
  if (nonlinear) take_modes(*nonlinear, order);
  if (nonlinear && nonlinear->modes.empty()) nonlinear.reset();
  if (!radiation) return;
  auto& [maps, air, radiation_errors, reasons] = *radiation;
  take(maps.modes, 1);
  take(radiation_errors, 1);
  take(reasons, 1);
}

}  // namespace ringdown::modal

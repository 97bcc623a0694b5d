#include "engine/bake/liquid/wet_body.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace ringdown::bake {
namespace {

using Eigen::Vector3d;

constexpr double kGutter = 0.05;  // of the largest basin's volume: so much smaller ones must be named to be filled

Vector3d to_eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

std::string place_text(const Vector3d& at) {
  char text[80];
  std::snprintf(text, sizeof text, "(%.3g, %.3g, %.3g)", at[0], at[1], at[2]);
  return text;
}

// Finds the basins that a filling is for.
Result<std::vector<liquid::Basin>> chosen_basins(const Filling& filling, const liquid::WetWall& wall, double length_m) {
  const std::vector<liquid::Basin> basins = liquid::basins_of(wall);
  if (basins.empty()) {
    return fail(ErrorKind::bad_input,
                "it has no basin that holds a liquid: below every level it is open, so that it would leak; check `up`, "
                "or leave [fill] out");
  }
  const auto bottom_of = [&](const liquid::Basin& basin) -> Vector3d {
    return wall.skin().surface.nodes.row(basin.bottom).transpose() * length_m;
  };
  if (filling.basins_m.empty()) {
    if (basins.size() == 1 || basins[1].volume < kGutter * basins[0].volume) return std::vector{basins.front()};
    std::string places;
    for (std::size_t b = 0; b < std::min<std::size_t>(basins.size(), 4); ++b)
      places += (places.empty() ? "" : ", ") + place_text(bottom_of(basins[b]));
    return fail(ErrorKind::bad_input, "it has " + std::to_string(basins.size()) + " basins, with their bottoms at " +
                                          places + (basins.size() > 4 ? ", ..." : "") +
                                          " m; say which are filled by basin = [x, y, z]");
  }
  std::vector<liquid::Basin> chosen;
  for (const Vec3& place_m : filling.basins_m) {
    const Vector3d place = to_eigen(place_m);
    const auto nearest = std::ranges::min_element(
        basins, {}, [&](const liquid::Basin& basin) { return (bottom_of(basin) - place).norm(); });
    const double reach = 1.5 * std::cbrt(nearest->volume) * length_m;
    if ((bottom_of(*nearest) - place).norm() > reach) {
      return fail(ErrorKind::bad_input, "there is no basin at " + place_text(place) +
                                            " m; the nearest has its bottom at " + place_text(bottom_of(*nearest)) +
                                            " m");
    }
    const auto known = std::ranges::find(chosen, nearest->bottom, &liquid::Basin::bottom);
    if (known == chosen.end()) chosen.push_back(*nearest);
  }
  return chosen;
}

WetPart part_of(liquid::Wetted wetted, const liquid::Liquid& liquid, int wall_nodes, const WetUnits& units) {
  return {.wetted = std::move(wetted),
          .density = liquid.density_kg_m3 / units.density_kg_m3,
          .sound_speed = liquid.sound_speed_m_s / units.speed_m_s,
          .wall_nodes = wall_nodes,
          .drag_si = std::sqrt(liquid.density_kg_m3 * liquid.viscosity_pa_s / 2)};
}

modal::LiquidNote note_of(const liquid::Liquid& liquid, double level_m, double volume_m3, const Vec3& up, bool bath) {
  return {.liquid = liquid.name,
          .density_kg_m3 = liquid.density_kg_m3,
          .sound_speed_m_s = liquid.sound_speed_m_s,
          .viscosity_pa_s = liquid.viscosity_pa_s,
          .level_m = level_m,
          .volume_m3 = volume_m3,
          .up = up,
          .around = bath};
}

Result<void> plan_bath(const Bath& bath, const WetUnits& units, WetPlan& plan) {
  const liquid::WetWall wall(plan.skin, to_eigen(bath.up));
  const double level = bath.level_m / units.length_m;
  std::vector<liquid::Piece> pieces = wall.pieces_below(level);
  std::erase_if(pieces, [](const liquid::Piece& piece) { return piece.is_basin(); });
  char text[96];
  std::snprintf(text, sizeof text, "it reaches from %.4g m to %.4g m", wall.lowest() * units.length_m,
                wall.highest() * units.length_m);
  if (pieces.empty())
    return fail(ErrorKind::bad_input, "the level of its bath lies below the body's lowest point: " + std::string(text));
  if (level >= wall.highest())
    return fail(ErrorKind::bad_input, "the bath covers all of it, and a body under a liquid is not modelled: " +
                                          std::string(text) + "; choose a lower level");
  double displaced = 0;
  for (const liquid::Piece& piece : pieces) displaced -= piece.volume;
  plan.parts.push_back(part_of(liquid::wetted_by(wall, pieces, level, true), bath.liquid, liquid::kWetNodes, units));
  plan.notes.push_back(note_of(bath.liquid, bath.level_m, displaced * std::pow(units.length_m, 3), bath.up, true));
  return {};
}

// Plans levels from the bottom to the rim, denser towards the rim, where the modes change fastest.
Result<void> plan_levels(const Filling& filling, const liquid::WetWall& wall, const liquid::Basin& basin,
                         const WetUnits& units, WetPlan& plan) {
  constexpr double kDenser = 1.5;
  const double bottom = wall.height(basin.bottom);
  plan.levels.push_back({.level = bottom, .volume = 0, .part = {}});
  for (std::size_t l = 1; l < filling.levels; ++l) {
    const double left = 1 - static_cast<double>(l) / static_cast<double>(filling.levels - 1);
    const double level = basin.rim - std::pow(left, kDenser) * (basin.rim - bottom);
    const liquid::Piece piece = liquid::piece_of(wall, basin, level);
    if (piece.triangles.empty() || piece.is_closed())
      return fail(ErrorKind::bad_input, "levels are found for an open basin only; leave `levels` out");
    plan.levels.push_back(
        {.level = level,
         .volume = piece.volume,
         .part = part_of(liquid::wetted_by(wall, {piece}, level, false), filling.liquid, filling.wall_nodes, units)});
  }
  return {};
}

}  // namespace

Result<void> plan_filling(const Filling& filling, const WetUnits& units, WetPlan& plan) {
  const liquid::WetWall wall(plan.skin, to_eigen(filling.up));
  const double metre = 1 / units.length_m;
  liquid::Amount amount = filling.amount;
  amount.value *= amount.kind == liquid::Amount::Kind::kVolume ? metre * metre * metre : metre;
  const auto basins = chosen_basins(filling, wall, units.length_m);
  if (!basins) return fail(basins);
  for (const liquid::Basin& basin : *basins) {
    const Result<double> level = liquid::level_of(wall, basin, amount, metre);
    if (!level) return fail(level);
    const liquid::Piece piece = liquid::piece_of(wall, basin, *level);
    if (piece.triangles.empty())
      return fail(ErrorKind::bad_input, "the liquid spills into another basin below that level; fill that one");
    plan.parts.push_back(
        part_of(liquid::wetted_by(wall, {piece}, *level, false), filling.liquid, filling.wall_nodes, units));
    plan.notes.push_back(note_of(filling.liquid, *level * units.length_m, piece.volume * std::pow(units.length_m, 3),
                                 filling.up, false));
  }
  if (filling.levels == 0) return {};
  if (basins->size() > 1)
    return fail(ErrorKind::bad_input, "levels are found for one basin only; fill one, or leave `levels` out");
  return plan_levels(filling, wall, basins->front(), units, plan);
}

Result<WetPlan> plan_liquids(const Liquids& liquids, const mesh::TetMesh& unit_mesh, const mesh::Boundary& surface,
                             const WetUnits& units) {
  if (liquids.fill && liquids.fill->levels > 0 && liquids.bath)
    return fail(ErrorKind::bad_input, "levels are not found for a body that stands in a bath; leave `levels` out");
  WetPlan plan{.skin = liquid::skin_of(unit_mesh, surface), .parts = {}, .levels = {}, .air = {}, .notes = {}};
  if (liquids.fill) {
    if (auto planned = plan_filling(*liquids.fill, units, plan); !planned) return fail(planned);
  }
  if (liquids.bath) {
    if (auto planned = plan_bath(*liquids.bath, units, plan); !planned) return fail(planned);
  }
  std::vector<liquid::Wetted> wetted;
  for (const WetPart& part : plan.parts) wetted.push_back(part.wetted);
  Result<liquid::AirSurface> air = liquid::air_surface_of(plan.skin, wetted);
  if (!air) return fail(air);
  plan.air = std::move(*air);
  return plan;
}

}  // namespace ringdown::bake

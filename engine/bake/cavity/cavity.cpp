#include "engine/bake/cavity/cavity.h"

#include "engine/bake/cavity/openings.h"
#include "engine/cavity/air_modes.h"

#include <span>
#include <utility>

namespace ringdown::bake {
namespace {

constexpr double kMinTerm = 1e-4;  // of a field, as in the radiation of bodies

HeardMode heard_mode(const cavity::AirMode& mode, const modal::Air& air) {
  const double decay_per_s = mode.wall_decay_per_s + mode.radiation_decay_per_s;
  HeardMode heard{.lambda = modal::undamped_lambda({mode.frequency_hz, decay_per_s}),
                  .mode = {mode.frequency_hz, decay_per_s},
                  .loss = {.air_per_s = decay_per_s},
                  .frequency_error = mode.frequency_error};
  heard.field.wavenumber_rad_m = modal::hz_to_rad_per_s(mode.frequency_hz) / air.sound_speed_m_s;
  heard.field.terms = modal::terms_of(std::span(mode.field.data(), mode.field.size()), kMinTerm);
  return heard;
}

}  // namespace

Result<std::vector<CavityMode>> find_cavity(const RadiatingBody& body, const CavityPlan& plan, const modal::Air& air,
                                            const Vec3& origin_m, double band_low_hz, double band_high_hz,
                                            const Progress& progress) {
  radiate::Body vessel = radiating_surface(body, {}, {});
  keep_openings(body.unit_mesh, body.surface, vessel.surface);
  const double length = body.units.length_m;
  vessel.surface.nodes *= length;
  vessel.flow.positions *= length;
  vessel.flow.areas *= length * length;
  const auto at = [](const Vec3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  const auto found = cavity::air_modes({.body = vessel,
                                        .origin = at(origin_m),
                                        .mouth = at(plan.mouth_m),
                                        .lowest_hz = band_low_hz,
                                        .highest_hz = band_high_hz,
                                        .modes = plan.modes},
                                       air, progress);
  if (!found) return fail(found);
  if (found->empty())
    return fail(ErrorKind::bad_input,
                "[cavity]: the air in it has no note in the band; its mouth may be closed, or too wide beside it");
  std::vector<CavityMode> modes;
  for (const cavity::AirMode& mode : *found) modes.push_back({heard_mode(mode, air), mode.flux});
  return modes;
}

void append_cavity(const CavityPlan& plan, const std::vector<CavityMode>& modes, modal::Bank& bank) {
  bank.cavity = modal::Cavity{.mouth_m = plan.mouth_m, .diameter_m = plan.diameter_m, .modes = {}};
  for (const auto& [heard, flux] : modes) {
    bank.cavity->modes.push_back({static_cast<std::uint32_t>(bank.mode_count()), flux});
    bank.frequency_hz.push_back(heard.mode.frequency_hz);
    bank.decay_per_s.push_back(heard.mode.decay_per_s);
    bank.losses.push_back(heard.loss);
    if (!bank.heat.empty()) bank.heat.emplace_back();
    bank.frequency_error.push_back(to_digits(heard.frequency_error, 3));
    bank.shape_error.push_back(0);
    bank.shapes.resize(bank.shapes.size() + bank.point_count());
    bank.radiation->maps.modes.push_back(heard.field);
    bank.radiation->error_db.push_back(0);
    if (!bank.radiation->reason.empty()) bank.radiation->reason.emplace_back();
  }
}

}  // namespace ringdown::bake

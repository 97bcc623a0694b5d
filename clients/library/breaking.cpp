#include "clients/library/handles.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/fracture/strength.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

using namespace ringdown;
using library::check_index, library::first_null, library::guarded, library::missing, library::numbered;

static_assert(RINGDOWN_NO_OBJECT == synth::kNoObject);

namespace {

void copy(const Vec3& from, double* to) {
  const std::array<double, 3> numbers = {from.x, from.y, from.z};
  std::ranges::copy(numbers, to);
}

ringdown_piece_info piece_of(const modal::MassProperties& mass, std::size_t pieces) {
  ringdown_piece_info info{};
  info.object = RINGDOWN_NO_OBJECT;
  info.pieces = static_cast<std::uint32_t>(pieces);
  info.mass_kg = mass.mass_kg;
  copy(mass.center_of_mass_m, info.center_of_mass_m);
  copy(mass.inertia_kg_m2, info.inertia_kg_m2);
  const auto& [x, y, z, w] = mass.orientation;
  const std::array<double, 4> turned = {w, x, y, z};
  std::ranges::copy(turned, info.axes_wxyz);
  return info;
}

Result<const modal::BreakPattern*> pattern_of(const ringdown_bank* bank, std::uint32_t pattern) {
  if (!bank) return missing("bank");
  const modal::Bank& known = bank->file.map->bank();
  if (auto good = breaking::Breakable::check(known); !good)
    return fail(good.error().kind, bank->path + " cannot break: " + good.error().message);
  if (auto good = check_index("pattern", pattern, known.fracture->patterns.size()); !good) return fail(good);
  return &known.fracture->patterns[pattern];
}

// A blow on an object, checked.
Result<protocol::BreakObject> blow_of(const ringdown_mixer* mixer, int64_t frame, uint32_t object,
                                      const double point_m[3], const double impulse_ns[3], double contact_time_s) {
  if (const char* name = first_null({{"mixer", mixer}, {"point_m", point_m}, {"impulse_ns", impulse_ns}}))
    return missing(name);
  protocol::BreakObject blow{numbered(object), library::vector(point_m), library::vector(impulse_ns), contact_time_s};
  if (auto good = library::check(blow); !good) return fail(good);
  if (session::is_too_far_ahead(mixer->rack.mixer(), frame))
    return fail(ErrorKind::bad_input, "frame lies more than an hour ahead");
  return blow;
}

}  // namespace

ringdown_result ringdown_breakable(const ringdown_bank* bank, uint32_t pattern, ringdown_pattern_info* info,
                                   ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const auto known = pattern_of(bank, pattern);
    if (!known) return fail(known);
    const modal::Fracture& fracture = *bank->file.map->bank().fracture;
    ringdown_pattern_info ours{};
    ours.patterns = static_cast<std::uint32_t>(fracture.patterns.size());
    ours.pieces = static_cast<std::uint32_t>((*known)->pieces.size());
    copy((*known)->at_m, ours.at_m);
    ours.crack_energy_j = modal::crack_cost_j((*known)->crack_area_m2, fracture.crack_energy_j_m2);
    return library::give(info, ours);
  });
}

ringdown_result ringdown_breakable_piece(const ringdown_bank* bank, uint32_t pattern, uint32_t piece,
                                         ringdown_piece_info* info, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const auto known = pattern_of(bank, pattern);
    if (!known) return fail(known);
    if (auto good = check_index("piece", piece, (*known)->pieces.size()); !good) return good;
    const modal::Bank& own = (*known)->pieces[piece].bank;
    ringdown_piece_info ours = piece_of(*own.mass, (*known)->pieces.size());
    ours.modes = own.mode_count();
    ours.points = own.point_count();
    ours.triangles = own.triangles.size();
    ours.points_m = reinterpret_cast<const float*>(own.positions.data());
    ours.triangle_points = reinterpret_cast<const std::uint32_t*>(own.triangles.data());
    return library::give(info, ours);
  });
}

ringdown_result ringdown_arm(ringdown_mixer* mixer, uint32_t object, int32_t pattern, uint32_t* pieces,
                             ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    protocol::ArmObject request{numbered(object), pattern};
    if (auto good = library::check(request); !good) return good;
    std::optional<std::size_t> told;
    if (pattern >= 0) told = static_cast<std::size_t>(pattern);
    const auto armed = mixer->breakage.arm(request.object, told);
    if (!armed) return fail(armed);
    if (pieces) *pieces = static_cast<std::uint32_t>(*armed);
    return {};
  });
}

ringdown_result ringdown_break(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double point_m[3],
                               const double impulse_ns[3], double contact_time_s, uint32_t* pieces,
                               ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    const auto blow = blow_of(mixer, frame, object, point_m, impulse_ns, contact_time_s);
    if (!blow) return fail(blow);
    const auto broken = mixer->breakage.break_armed(*blow, frame, synth::Producer::control);
    if (!broken) return fail(broken);
    mixer->dropped += broken->lost;
    if (pieces) *pieces = static_cast<std::uint32_t>(broken->pieces);
    return {};
  });
}

ringdown_result ringdown_piece(ringdown_mixer* mixer, uint32_t object, uint32_t piece, ringdown_piece_info* info,
                               ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    const auto report = mixer->breakage.report(numbered(object));
    if (!report) return fail(report);
    if (report->pieces.empty())
      return fail(ErrorKind::refused,
                  "\"" + report->name + "\" is not armed, so its pieces are not there; arm it first");
    if (auto good = check_index("piece", piece, report->pieces.size()); !good) return good;
    const session::PieceReport& known = report->pieces[piece];
    ringdown_piece_info ours = piece_of(known.mass, report->pieces.size());
    if (known.number) ours.object = *known.number;
    copy(known.velocity_m_s, ours.velocity_m_s);
    copy(known.spin_rad_s, ours.spin_rad_s);
    return library::give(info, ours);
  });
}

ringdown_result ringdown_stress(ringdown_mixer* mixer, int64_t frame, uint32_t object, const double point_m[3],
                                const double impulse_ns[3], double contact_time_s, double* stress_pa,
                                ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!stress_pa) return missing("stress_pa");
    const auto blow = blow_of(mixer, frame, object, point_m, impulse_ns, contact_time_s);
    if (!blow) return fail(blow);
    const auto stress =
        mixer->breakage.stress_pa(blow->object, {blow->point_m, blow->impulse_ns, blow->contact_time_s}, frame);
    if (!stress) return fail(stress);
    *stress_pa = *stress;
    return {};
  });
}

ringdown_result ringdown_mend(ringdown_mixer* mixer, uint32_t object, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!mixer) return missing("mixer");
    return mixer->breakage.mend(numbered(object));
  });
}

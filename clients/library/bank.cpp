#include "clients/library/handles.h"

#include "engine/base/version.h"
#include "engine/modal/hearing/pitch.h"
#include "engine/modal/radiation_map.h"

#include <array>
#include <tuple>
#include <utility>

using namespace ringdown;
using library::guarded, library::missing;

const char* ringdown_version() { return kVersion; }

ringdown_result ringdown_bank_open(const char* path, ringdown_bank** bank, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!path) return missing("path");
    if (!bank) return missing("bank");
    const session::FileRoots roots;
    session::BankReader reader(roots);
    auto file = reader.read(path);
    if (!file) return fail(file);
    *bank = new ringdown_bank{*std::move(file), path};
    return {};
  });
}

ringdown_result ringdown_bank_parse(const void* glb, size_t bytes, const char* name, ringdown_bank** bank,
                                    ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!glb) return missing("glb");
    if (!bank) return missing("bank");
    const std::string called = name ? name : "bank";
    auto file = session::parse_bank_file({static_cast<const char*>(glb), bytes}, called);
    if (!file) return fail(file);
    *bank = new ringdown_bank{*std::move(file), called};
    return {};
  });
}

void ringdown_bank_release(ringdown_bank* bank) { delete bank; }

ringdown_result ringdown_bank_describe(const ringdown_bank* bank, ringdown_bank_info* info) {
  return guarded(nullptr, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    const modal::Bank& known = bank->file.map->bank();
    ringdown_bank_info ours{};
    ours.modes = known.mode_count();
    ours.points = known.point_count();
    ours.triangles = known.triangles.size();
    ours.name = known.name.c_str();
    ours.material = "";
    if (known.material) {
      ours.material = known.material->name.c_str();
      ours.youngs_modulus_pa = known.material->youngs_modulus_pa;
      ours.poisson_ratio = known.material->poisson_ratio;
      ours.density_kg_m3 = known.material->density_kg_m3;
    }
    if (known.mass) {
      ours.mass_kg = known.mass->mass_kg;
      const Vec3& center = known.mass->center_of_mass_m;
      const std::array<double, 3> numbers = {center.x, center.y, center.z};
      std::ranges::copy(numbers, ours.center_of_mass_m);
      const auto& [moments, turned] = std::tie(known.mass->inertia_kg_m2, known.mass->orientation);
      std::ranges::copy(std::array{moments.x, moments.y, moments.z}, ours.inertia_kg_m2);
      std::ranges::copy(std::array{turned[3], turned[0], turned[1], turned[2]}, ours.axes_wxyz);
    }
    if (known.levels) {
      const Range range = known.levels->range_m();
      std::ranges::copy(std::array{range.low, range.high}, ours.level_m);
    }
    ours.has_radiation = known.radiation.has_value();
    ours.held = known.held;
    ours.has_residual = bank->residual.has_value();
    return library::give(info, ours);
  });
}

ringdown_result ringdown_bank_pitch(const ringdown_bank* bank, double* hz, ringdown_pitch* kind) {
  return guarded(nullptr, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!hz) return missing("hz");
    if (!kind) return missing("kind");
    const modal::Pitch pitch = modal::pitch_of(bank->file.map->bank());
    *hz = pitch.tone_hz;
    *kind = pitch.stated ? RINGDOWN_PITCH_STATED : pitch.hz ? RINGDOWN_PITCH_ESTIMATED : RINGDOWN_PITCH_NONE;
    return {};
  });
}

const double* ringdown_bank_frequencies_hz(const ringdown_bank* bank) {
  return bank ? bank->file.map->bank().frequency_hz.data() : nullptr;
}

const double* ringdown_bank_decays_per_s(const ringdown_bank* bank) {
  return bank ? bank->file.map->bank().decay_per_s.data() : nullptr;
}

const float* ringdown_bank_points_m(const ringdown_bank* bank) {
  return bank ? reinterpret_cast<const float*>(bank->file.map->bank().positions.data()) : nullptr;
}

const float* ringdown_bank_shapes(const ringdown_bank* bank) {
  return bank ? reinterpret_cast<const float*>(bank->file.map->bank().shapes.data()) : nullptr;
}

const uint32_t* ringdown_bank_triangles(const ringdown_bank* bank) {
  return bank ? reinterpret_cast<const std::uint32_t*>(bank->file.map->bank().triangles.data()) : nullptr;
}

ringdown_result ringdown_bank_levels_pa(const ringdown_bank* bank, double* levels) {
  return guarded(nullptr, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!levels) return missing("levels");
    const modal::Bank& known = bank->file.map->bank();
    for (std::size_t m = 0; m < known.mode_count(); ++m) {
      levels[m] = bank->file.map->loudness().pressure_pa(known, m, {}, known.frequency_hz[m]);
    }
    return {};
  });
}

ringdown_result ringdown_bank_far_field(const ringdown_bank* bank, size_t mode, const double* directions, size_t count,
                                        float* far_field, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!directions) return missing("directions");
    if (!far_field) return missing("far_field");
    const modal::Bank& known = bank->file.map->bank();
    if (!known.radiation) {
      return fail(ErrorKind::refused,
                  bank->path + " has no radiation maps; bake it again with `ringdown bake --radiation`");
    }
    if (mode >= known.mode_count()) {
      return fail(ErrorKind::bad_input, "mode is {}; the bank has {}, which are numbered from 0", mode,
                  known.mode_count());
    }
    const modal::FarField& field = known.radiation->maps.modes[mode];
    const int degree = std::max(modal::degree_of(field), 0);
    std::vector<float> harmonics(static_cast<std::size_t>(modal::harmonic_count(degree)));
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 direction = library::vector(directions + 3 * i);
      if (!(length(direction) > 0 && length(direction) < 1e300)) {
        return fail(ErrorKind::bad_input, "direction {} has no length", i);
      }
      modal::real_harmonics(direction, degree, harmonics);
      const std::complex<float> value = modal::far_field(field, harmonics);
      far_field[2 * i] = value.real();
      far_field[2 * i + 1] = value.imag();
    }
    return {};
  });
}

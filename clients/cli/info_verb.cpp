#include "clients/cli/verb.h"
#include "engine/base/folders.h"
#include "engine/base/note.h"
#include "engine/base/range.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/hearing/pitch.h"
#include "packaging/manual/command_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace ringdown::cli {
namespace {

// Returns the mode's response to a blow at a random point: sqrt of the mean of |phi|^2 over the sample points.
double rms_shape(const modal::Bank& bank, std::size_t mode) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const double component : bank.shape(mode, p)) sum += component * component;
  }
  return std::sqrt(sum / static_cast<double>(bank.point_count()));
}

// Returns how much louder the mode sounds in its loudest direction than on average over all directions [dB].
double directivity_db(const modal::FarField& field) {
  constexpr int kDirections = 2000;
  const int degree = std::max(modal::degree_of(field), 0);
  std::vector<float> harmonics(static_cast<std::size_t>(modal::harmonic_count(degree)));
  double loudest = 0;
  for (int i = 0; i < kDirections; ++i) {  // a spiral of directions that divides the sphere evenly
    const double z = 1 - (2 * i + 1.0) / kDirections, turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - z * z);
    modal::real_harmonics({across * std::cos(turn), across * std::sin(turn), z}, degree, harmonics);
    loudest = std::max(loudest, static_cast<double>(std::abs(modal::far_field(field, harmonics))));
  }
  return 20 * std::log10(loudest / modal::rms(field));
}

// Returns the rms pressure over directions at 1 m with which a blow of 1 N s at a random point starts the mode [dB re
// 20 uPa].
double blow_level_db(const modal::Bank& bank, std::size_t mode) {
  constexpr double kReference_pa = 20e-6;
  const double omega = modal::hz_to_rad_per_s(bank.frequency_hz[mode]);
  const double pressure_pa =
      bank.radiation->air.density_kg_m3 * omega * modal::rms(bank.radiation->maps.modes[mode]) * rms_shape(bank, mode);
  return 20 * std::log10(pressure_pa / std::numbers::sqrt2 / kReference_pa);
}

// The columns of what a mode loses and radiates; empty where the bank does not know. The level of a mode that no blow
// rings, such as the air's, is a dash.
std::string loss_columns(const modal::Bank& bank, std::size_t mode) {
  std::string columns(43, ' ');
  if (!bank.losses.empty()) {
    const modal::ModeLoss& loss = bank.losses[mode];
    columns = formatted("{:10.4g} {:10.4g} {:10.4g} {:10.4g}", loss.material_per_s, loss.heat_per_s, loss.air_per_s,
                        loss.support_per_s);
  }
  if (!bank.radiation || bank.radiation->maps.modes[mode].terms.empty()) return columns + std::string(18, ' ');
  const std::string level = rms_shape(bank, mode) > 0 ? formatted("{:.1f}", blow_level_db(bank, mode)) : "-";
  return formatted("{} {:>8} {:8.1f}", columns, level, directivity_db(bank.radiation->maps.modes[mode]));
}

void print_radiation(const modal::BankRadiation& radiation) {
  std::printf("radiation  into air of %.5g kg/m3 and %.5g m/s", radiation.air.density_kg_m3,
              radiation.air.sound_speed_m_s);
  if (const auto spread = modal::error_spread(radiation.error_db)) {
    std::printf("; levels as estimated to %.2g dB in the median, %.2g dB at most", spread->median, spread->largest);
  }
  std::printf("\n");
  for (std::size_t m = 0; m < radiation.reason.size(); ++m) {
    if (!radiation.reason[m].empty()) std::printf("           mode %zu: %s\n", m, radiation.reason[m].c_str());
  }
}

void print_nonlinear(const modal::NonlinearTerms& terms) {
  std::printf("nonlinear  %zu modes bend each other's pitch, by %zu functions that leave out %s; it is %.3g mm thick\n",
              terms.mode_count(), terms.function_count(), as_percent(terms.residual).c_str(), 1e3 * terms.thickness_m);
  if (terms.coupled > 0) std::printf("           %u of them exchange energy when struck hard\n", terms.coupled);
  if (const auto spread = modal::error_spread(terms.errors)) {
    std::printf("           errors of a mode's own hardening, as estimated: median %s, largest %s\n",
                as_percent(spread->median).c_str(), as_percent(spread->largest).c_str());
  }
}

void print_fracture(const modal::Fracture& fracture) {
  for (std::size_t p = 0; p < fracture.patterns.size(); ++p) {
    const modal::BreakPattern& pattern = fracture.patterns[p];
    const auto rings = [](const modal::PieceBank& piece) { return piece.bank.mode_count() > 0; };
    std::printf("%-10s into %zu pieces, of which %td ring, where (%.4g %.4g %.4g) m is struck; %.3g m2 of cracks",
                p == 0 ? "breaks" : "", pattern.pieces.size(), std::ranges::count_if(pattern.pieces, rings),
                pattern.at_m.x, pattern.at_m.y, pattern.at_m.z, pattern.crack_area_m2);
    if (fracture.crack_energy_j_m2 > 0)
      std::printf(" take %.3g J", modal::crack_cost_j(pattern.crack_area_m2, fracture.crack_energy_j_m2));
    std::printf("\n");
  }
  if (fracture.strength) {
    std::printf(
        "strength   half of all such bodies, %.3g m2 of skin, break at %.3g MPa or less; Weibull modulus %.3g\n",
        fracture.skin_m2, 1e-6 * modal::median_strength_pa(*fracture.strength, fracture.skin_m2),
        fracture.strength->weibull_modulus);
  }
  if (fracture.crack_energy_j_m2 > 0) {
    std::printf("crack      costs %.3g J/m2, and %.3g times as much when it is fast, as above\n",
                fracture.crack_energy_j_m2, modal::kFractureEnergyFactor);
  }
}

void print_head(const modal::Bank& bank) {
  if (bank.provenance.wall_elements > 0) {
    std::printf(
        "WRONG      its walls are meshed with %.2g elements across (--force-coarse): they have holes and wrong modes\n",
        bank.provenance.wall_elements);
  }
  std::printf("%s: %zu modes at %zu points, %zu triangles\n", bank.name.c_str(), bank.mode_count(), bank.point_count(),
              bank.triangles.size());
  if (const auto& m = bank.material) {
    std::printf("material   %s: E = %.4g Pa, nu = %.3g, rho = %.5g kg/m3, %s\n", m->name.c_str(), m->youngs_modulus_pa,
                m->poisson_ratio, m->density_kg_m3, modal::describe_damping(*m).c_str());
  }
  if (bank.material && bank.material->orthotropy) {
    const auto& [e, nu, g, loss] = *bank.material->orthotropy;
    std::printf("grain      E = %.3g %.3g %.3g Pa, nu = %.3g %.3g %.3g, G = %.3g %.3g %.3g Pa\n", e[0], e[1], e[2],
                nu[0], nu[1], nu[2], g[0], g[1], g[2]);
  }
  std::printf("pitch      %s\n", modal::describe(modal::pitch_of(bank)).c_str());
  if (!bank.provenance.parts.empty()) {
    std::string parts;
    for (const std::string& part : bank.provenance.parts) parts += (parts.empty() ? "" : ", ") + part;
    std::printf("parts      of %s; the rest of its material\n", parts.c_str());
  }
  for (const modal::LiquidNote& liquid : bank.provenance.liquids) {
    std::printf("liquid     %s %s up to %.4g m along (%.3g %.3g %.3g), %.4g ml%s; in frequencies and decays\n",
                liquid.liquid.c_str(), liquid.around ? "around it" : "in it", liquid.level_m, liquid.up.x, liquid.up.y,
                liquid.up.z, 1e6 * liquid.volume_m3, liquid.around ? " displaced" : "");
  }
  for (const modal::ResonatorNote& tube : bank.provenance.resonators) {
    std::printf("resonator  tube %.4g mm across, %.1f mm long, %s; rings at %.2f Hz, Q %.0f; end correction %.1f mm\n",
                1e3 * tube.diameter_m, 1e3 * tube.length_m, tube.stopped ? "stopped" : "open", tube.frequency_hz,
                modal::hz_to_rad_per_s(tube.frequency_hz) / (2 * tube.decay_per_s), 1e3 * tube.end_correction_m);
  }
  if (bank.cavity) {
    for (const modal::Cavity::Mode& one : bank.cavity->modes) {
      std::printf("cavity     its air rings at %.2f Hz, Q %.0f; mouth %.4g mm across\n", bank.frequency_hz[one.mode],
                  modal::hz_to_rad_per_s(bank.frequency_hz[one.mode]) / (2 * bank.decay_per_s[one.mode]),
                  1e3 * bank.cavity->diameter_m);
    }
  }
  if (bank.nonlinear) print_nonlinear(*bank.nonlinear);
  if (bank.fracture) print_fracture(*bank.fracture);
  if (bank.held) std::printf("held       by supports, so it is not free\n");
  if (const auto& m = bank.mass) {
    std::printf("mass       %.4g kg, inertia %.4g %.4g %.4g kg m2 about (%.4g %.4g %.4g) m\n", m->mass_kg,
                m->inertia_kg_m2.x, m->inertia_kg_m2.y, m->inertia_kg_m2.z, m->center_of_mass_m.x,
                m->center_of_mass_m.y, m->center_of_mass_m.z);
  }
  const modal::Provenance& made = bank.provenance;
  if (!made.generator.empty()) std::printf("made by    %s\n", made.generator.c_str());
  if (!made.body.empty()) std::printf("body       %s\n", made.body.c_str());
  if (made.unknowns > 0) {
    std::printf("analysis   %s, %lld unknowns, %.4g to %.4g Hz, %lld rigid modes left out, largest residual %.2g\n",
                made.element.c_str(), static_cast<long long>(made.unknowns), made.band_low_hz, made.band_high_hz,
                static_cast<long long>(made.rigid_modes), made.largest_residual);
  }
  if (made.counted_modes > 0) {
    std::printf("complete   %lld eigenvalues below the band's top were counted by inertia, and as many were found\n",
                static_cast<long long>(made.counted_modes));
  }
  if (const auto spread = modal::error_spread(bank.frequency_error)) {
    std::printf("errors     of the frequencies, as estimated: median %s, largest %s\n",
                as_percent(spread->median).c_str(), as_percent(spread->largest).c_str());
  }
  if (const auto spread = modal::error_spread(bank.shape_error)) {
    std::printf("           of amplitudes between sample points: median %s, largest %s\n",
                as_percent(spread->median).c_str(), as_percent(spread->largest).c_str());
  }
  if (bank.radiation) print_radiation(*bank.radiation);
  if (made.peak_pa > 0)
    std::printf("level      a blow of %.2g N s peaks at %.3g Pa, 1 m away\n", modal::kPeakBlow_ns, made.peak_pa);
  if (made.dropped_modes > 0) {
    std::printf("left out   %lld modes, at most %.1f dB of the energy of a blow",
                static_cast<long long>(made.dropped_modes), made.loss_db);
    made.floor_db > 0 ? std::printf("; inaudible %.4g dB below the loudest, or masked\n", made.floor_db)
                      : std::printf("; the least important\n");
  }
}

void print_modes(const modal::Bank& bank) {
  std::printf("\n%5s %12s %10s %10s %10s %10s %10s %10s %8s %8s %14s %8s  %s\n", "mode", "frequency Hz", "T60 s",
              "decay 1/s", "material", "heat", "air", "support", "dB SPL", "beam dB", "rms kg^-1/2", "error %", "note");
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double decay = bank.decay_per_s[m];
    const std::string error = bank.frequency_error.empty() ? "" : formatted("{:.2g}", 100 * bank.frequency_error[m]);
    std::printf("%5zu %12.3f %10.4g %10.4g %s %14.4g %8s  %s\n", m, bank.frequency_hz[m], modal::t60_s(decay), decay,
                loss_columns(bank, m).c_str(), rms_shape(bank, m), error.c_str(),
                note_name(bank.frequency_hz[m]).c_str());
  }
}

ExitCode info(const std::string& given) {
  const auto path = preset_or_file(given, PresetKind::bank);
  if (!path) return complain(path);
  const auto bank = modal::read_bank(*path);
  if (!bank) return complain(bank);
  print_head(*bank);
  print_modes(*bank);
  return ExitCode::ok;
}

}  // namespace

void add_info_verb(manual::App& app, ExitCode& outcome) {
  auto bank = std::make_shared<std::string>();
  manual::App* verb = app.add_subcommand("info", "Prints the modes of a bank as a table, in the bank's order.");
  verb->add_option("bank", *bank, "The bank: a .glb file, or the name of a preset.")->type_name("FILE")->required();
  verb->callback([bank, &outcome] { outcome = info(*bank); });
}

}  // namespace ringdown::cli

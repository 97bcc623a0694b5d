#include "clients/cli/bake/bake_report.h"

#include "engine/base/range.h"
#include "engine/modal/fracture/fracture.h"
#include "protocol/exit_codes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ringdown::cli {
namespace {

void print_errors(const bake::BakedObject& object) {
  if (const auto& choice = object.choice) {
    std::printf("  mesh size %.3g mm", 1000 * choice->size_m);
    if (choice->edge_size_m > 0 && choice->edge_size_m < choice->size_m) {
      std::printf(", %.3g mm at sharp edges", 1000 * choice->edge_size_m);
    }
    if (choice->shortest_wave_m > 0) std::printf(", for waves of %.3g mm", 1000 * choice->shortest_wave_m);
    if (choice->wall_m > 0) std::printf(", thinnest wall %.3g mm", 1000 * choice->wall_m);
    std::printf(
        "%s\n",
        choice->bounded
            ? "; finer elements would be needed, but exceed the default limit of unknowns (--mesh-size overrules it)"
            : "");
  }
  if (object.rounds.size() > 1) {
    std::printf("  refined:");
    for (const bake::Round& round : object.rounds) {
      std::printf(" %s %td unknowns %s;", std::string(fem::element_name(round.element)).c_str(), round.unknowns,
                  as_percent(round.error).c_str());
    }
    std::printf("\n");
  }
  const auto spread = modal::error_spread(object.baked.bank.frequency_error);
  if (spread) {
    std::printf("  estimated errors of the frequencies: median %s, largest %s\n", as_percent(spread->median).c_str(),
                as_percent(spread->largest).c_str());
  }
  if (const auto amplitudes = modal::error_spread(object.baked.bank.shape_error)) {
    std::printf("  estimated errors of amplitudes between points: median %s, largest %s\n",
                as_percent(amplitudes->median).c_str(), as_percent(amplitudes->largest).c_str());
  }
}

void print_radiation(const bake::Baked& baked) {
  const auto& radiation = baked.bank.radiation;
  if (!radiation) return;
  const auto spread = modal::error_spread(radiation->error_db);
  std::printf("  radiation: %s", baked.report.radiation.from_cache ? "from the cache; " : "");
  if (spread)
    std::printf("estimated errors of the levels: median %.2g dB, largest %.2g dB", spread->median, spread->largest);
  const auto doubtful = std::ranges::count_if(radiation->reason, [](const auto& reason) { return !reason.empty(); });
  if (doubtful > 0) std::printf("; %td modes above the limit", doubtful);
  std::printf("\n");
}

void print_nonlinear(const bake::Baked& baked) {
  const auto& terms = baked.bank.nonlinear;
  if (!terms) return;
  std::printf("  nonlinear: %zu modes, %zu functions that leave out %s; membrane's share of a mode up to %s",
              terms->mode_count(), terms->function_count(), as_percent(terms->residual).c_str(),
              as_percent(baked.report.membrane_share).c_str());
  if (const auto spread = modal::error_spread(terms->errors)) {
    std::printf("; estimated errors of the hardening: median %s, largest %s", as_percent(spread->median).c_str(),
                as_percent(spread->largest).c_str());
  }
  std::printf("\n");
}

void print_body(const bake::BakedObject& object) {
  std::printf("  %s\n", mesh::text_of(object.making).c_str());
  for (const std::string& note : object.notes) std::printf("    %s\n", note.c_str());
  const mesh::CheckedMesh& checked = object.mesh;
  if (checked.pieces > 1) std::printf("  %d pieces that share no node\n", checked.pieces);
  if (checked.flipped + checked.duplicates + checked.unused_nodes > 0) {
    std::printf("  repaired: %d elements were inside out, %d were duplicates; %d nodes belonged to no element\n",
                checked.flipped, checked.duplicates, checked.unused_nodes);
  }
  if (checked.straightened > 0) {
    std::printf("  %d curved elements folded and were straightened; a smaller mesh size avoids that\n",
                checked.straightened);
  }
}

void print_fracture(const modal::Fracture& fracture) {
  for (const modal::BreakPattern& pattern : fracture.patterns) {
    std::size_t modes = 0, silent = 0;
    double lowest_hz = HUGE_VAL, error = 0;
    for (const auto& piece : pattern.pieces) {
      const modal::Bank& bank = piece.bank;
      modes += bank.mode_count();
      silent += bank.mode_count() == 0;
      for (const double hz : bank.frequency_hz) lowest_hz = std::min(lowest_hz, hz);
      for (const double relative : bank.frequency_error) error = std::max(error, relative);
    }
    std::printf("  breaks at (%.3g, %.3g, %.3g) m into %zu pieces with %zu modes", pattern.at_m.x, pattern.at_m.y,
                pattern.at_m.z, pattern.pieces.size(), modes);
    if (modes > 0) std::printf(" from %.0f Hz, errors up to %.2g %%", lowest_hz, 100 * error);
    std::printf("; %zu only click; %.3g cm2 of cracks\n", silent, 1e4 * pattern.crack_area_m2);
  }
}

}  // namespace

void print_report(const bake::ObjectRecipe& recipe, const bake::BakedObject& object,
                  const std::filesystem::path& output) {
  const modal::Bank& bank = object.baked.bank;
  const bake::BakeReport& report = object.baked.report;
  const auto [low, high] = std::minmax_element(bank.frequency_hz.begin(), bank.frequency_hz.end());
  std::error_code error;
  const auto bytes = std::filesystem::file_size(output, error);  // a stream has no size
  std::printf("%s: %zu modes, %.0f to %.0f Hz, at %zu points -> %s", recipe.name.c_str(), bank.mode_count(), *low,
              *high, bank.point_count(), output.c_str());
  if (!error) std::printf(" (%.0f kB)", static_cast<double>(bytes) / 1000);
  std::printf("\n");
  std::printf(
      "  %s, %.3f kg; %td elements, %td unknowns; dropped %d rigid, %d below the band, %d over-damped, %d inaudible, "
      "%d unimportant\n",
      bank.material->name.c_str(), bank.mass->mass_kg, report.elements, report.unknowns, report.rigid,
      report.below_band, report.over_damped, report.inaudible, report.unimportant);
  if (bank.provenance.dropped_modes > 0) {
    std::printf("  left out of the band: %lld modes, at most %.1f dB of the energy of a blow\n",
                static_cast<long long>(bank.provenance.dropped_modes), bank.provenance.loss_db);
  }
  for (const std::string& held : report.held) std::printf("  %s\n", held.c_str());
  if (report.from_cache) std::printf("  from the cache: nothing was solved\n");
  if (const solve::Agreement& agreement = report.agreement; agreement.modes > 0) {
    std::printf("  second opinion on %d modes: frequencies agree to %.0e, shapes to %.0e, in %.1f s\n", agreement.modes,
                agreement.frequency, agreement.angle, agreement.seconds);
  }
  for (const std::string& trouble : {report.cache_trouble, report.radiation.cache_trouble}) {
    if (!trouble.empty()) std::printf("  not kept in the cache: %s\n", trouble.c_str());
  }
  std::printf(
      "  seconds: mesh %.1f, assemble %.1f, factors %.1f, modes %.1f, errors %.1f, heat %.1f, liquid %.1f, nonlinear "
      "%.1f, radiation %.1f, tubes %.1f, cavity %.1f, finish %.1f; largest residual %.1e\n",
      object.mesh_seconds, report.assemble_seconds, report.factor_seconds, report.iterate_seconds,
      report.estimate_seconds, report.heat_seconds, report.liquid_seconds, report.nonlinear_seconds,
      report.radiation_seconds, report.tube_seconds, report.cavity_seconds, report.finish_seconds,
      bank.provenance.largest_residual);
  print_errors(object);
  print_radiation(object.baked);
  print_nonlinear(object.baked);
  if (bank.fracture) print_fracture(*bank.fracture);
  print_body(object);
  std::fflush(stdout);
  if (!object.question.empty()) protocol::complain("is this size right? " + object.question, protocol::ExitCode::ok);
}

}  // namespace ringdown::cli

// Radiation of presets: time, sizes and stated errors. CSV on the standard output.
#include "engine/modal/bank_file.h"
#include "engine/radiate/radiate.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace ringdown {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

radiate::Body body_of(const modal::Bank& bank) {
  radiate::Body body;
  body.surface.nodes.resize(static_cast<Eigen::Index>(bank.point_count()), 3);
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (int c = 0; c < 3; ++c) body.surface.nodes(static_cast<Eigen::Index>(p), c) = bank.positions[p][c];
  }
  body.surface.triangles.resize(static_cast<Eigen::Index>(bank.triangles.size()), 3);
  for (std::size_t t = 0; t < bank.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      body.surface.triangles(static_cast<Eigen::Index>(t), c) = static_cast<std::int32_t>(bank.triangles[t][c]);
    }
  }
  std::vector<Eigen::MatrixX3d> shapes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    Eigen::MatrixX3d shape(bank.point_count(), 3);
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      for (int c = 0; c < 3; ++c) shape(static_cast<Eigen::Index>(p), c) = bank.shape(m, p)[c];
    }
    shapes.push_back(shape);
  }
  body.flow = radiate::flow_of(body.surface, shapes, 0.003);
  body.frequency_hz = bank.frequency_hz;
  return body;
}

int run(int count, char** arguments) {
  bool list = false;
  radiate::Options options{.threads = 1};
  std::printf("bank,modes,highest_hz,unknowns,factorizations,processor_s,wall_s,packed_bytes,packing_error,median_error_db,worst_error_db,missed\n");
  for (int a = 1; a < count; ++a) {
    const std::string argument = arguments[a];
    if (argument == "--modes") { list = true; continue; }
    if (argument.rfind("--ppw=", 0) == 0) { options.panels_per_wave = std::stod(argument.substr(6)); continue; }
    if (argument.rfind("--threads=", 0) == 0) { options.threads = std::stoi(argument.substr(10)); continue; }
    if (argument.rfind("--range=", 0) == 0) { options.range_octaves = std::stod(argument.substr(8)); continue; }
    const auto bank = modal::read_bank(argument);
    if (!bank) { std::fprintf(stderr, "%s\n", bank.error().message.c_str()); return 1; }
    const double before = processor_seconds();
    const auto start = std::chrono::steady_clock::now();
    const radiate::Body body = body_of(*bank);
    const auto radiation = radiate::solve(body, {}, options);
    if (!radiation) { std::fprintf(stderr, "%s: %s\n", argument.c_str(), radiation.error().message.c_str()); continue; }
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::vector<double> errors;
    int missed = 0;
    for (const auto& mode : radiation->modes) {
      errors.push_back(mode.error_db);
      missed += !mode.reason.empty();
    }
    std::sort(errors.begin(), errors.end());
    const auto packed = modal::pack(radiation->maps);
    std::printf("%s,%zu,%.0f,%d,%d,%.1f,%.1f,%zu,%.4f,%.3f,%.3f,%d\n", argument.substr(argument.rfind('/') + 1).c_str(), bank->mode_count(),
                *std::max_element(bank->frequency_hz.begin(), bank->frequency_hz.end()), radiation->largest_unknowns, radiation->factorizations,
                processor_seconds() - before, wall, packed.bytes.size(), packed.largest_error, errors[errors.size() / 2], errors.back(), missed);
    std::fflush(stdout);
    if (!list) continue;
    for (std::size_t m = 0; m < bank->mode_count(); ++m) {
      const auto& mode = radiation->modes[m];
      std::printf("  %8.1f Hz  relative %7.1f dB  decay %9.4f 1/s (bank %8.3f)  source %.2f coarser %.2f balance %.2f  terms %zu %s\n", bank->frequency_hz[m],
                  mode.relative_db, mode.decay_per_s, bank->decay_per_s[m], mode.source_db, mode.coarser_db, mode.balance_db, radiation->maps.modes[m].terms.size(), mode.reason.c_str());
    }
  }
  return 0;
}

}  // namespace
}  // namespace ringdown

int main(int count, char** arguments) { return ringdown::run(count, arguments); }

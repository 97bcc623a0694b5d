// The library's functions that laboratories ask a bank with: errors, losses, provenance, and frequency responses.
#include "clients/library/handles.h"

#include "engine/modal/bank_file.h"
#include "engine/modal/response/frequency_response.h"
#include "engine/modal/response/provenance_text.h"

#include <complex>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace ringdown;
using library::guarded, library::missing, library::vector;

namespace {

// Copies `size` bytes to `target`, which has room for `*room`, and sets `*room` to `size`.
Result<void> hand_over(const void* source, std::size_t size, void* target, size_t* room) {
  const std::size_t had = std::exchange(*room, size);
  if (!target) return {};
  if (had < size) {
    return fail(ErrorKind::bad_input,
                "there is room for " + std::to_string(had) + " bytes, and " + std::to_string(size) + " are needed");
  }
  if (size > 0) std::memcpy(target, source, size);
  return {};
}

const modal::Bank& known(const ringdown_bank* bank) { return bank->file.map->bank(); }
const modal::SurfaceIndex& surface(const ringdown_bank* bank) { return bank->file.map->surface(); }

std::vector<double> numbers_of(const modal::Bank& bank, ringdown_bank_list list) {
  if (list == RINGDOWN_FREQUENCY_ERRORS) return bank.frequency_error;
  if (list == RINGDOWN_SHAPE_ERRORS) return bank.shape_error;
  if (list == RINGDOWN_LEVEL_ERRORS_DB) return bank.radiation ? bank.radiation->error_db : std::vector<double>();
  std::vector<double> losses;
  for (const modal::ModeLoss& loss : bank.losses)
    losses.insert(losses.end(), {loss.material_per_s, loss.heat_per_s, loss.air_per_s, loss.support_per_s});
  return losses;
}

Result<void> give_response(const Result<modal::Response>& response, double* frf) {
  if (!response) return fail(response);
  for (const std::complex<double>& value : *response) {
    *frf++ = value.real();
    *frf++ = value.imag();
  }
  return {};
}

}  // namespace

ringdown_result ringdown_bank_numbers(const ringdown_bank* bank, ringdown_bank_list list, double* numbers,
                                      size_t* count, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!count) return missing("count");
    if (list < RINGDOWN_FREQUENCY_ERRORS || list > RINGDOWN_LOSSES_PER_S)
      return fail(ErrorKind::bad_input, "there is no list " + std::to_string(static_cast<int>(list)));
    const std::vector<double> found = numbers_of(known(bank), list);
    std::size_t bytes = *count * sizeof(double);
    const auto given = hand_over(found.data(), found.size() * sizeof(double), numbers, &bytes);
    *count = found.size();
    return given;
  });
}

ringdown_result ringdown_bank_provenance(const ringdown_bank* bank, char* text, size_t* bytes, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!bytes) return missing("bytes");
    const std::string json = modal::provenance_text(known(bank));
    return hand_over(json.c_str(), json.size() + 1, text, bytes);
  });
}

ringdown_result ringdown_bank_write(const ringdown_bank* bank, void* glb, size_t* bytes, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!bytes) return missing("bytes");
    const std::vector<std::byte> file = modal::to_glb(known(bank));
    return hand_over(file.data(), file.size(), glb, bytes);
  });
}

ringdown_result ringdown_bank_read_residual(ringdown_bank* bank, const char* path, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!path) return missing("path");
    auto residual = modal::read_residual(path, known(bank).point_count());
    if (!residual) return fail(residual);
    bank->residual = std::move(*residual);
    return {};
  });
}

ringdown_result ringdown_bank_frf(const ringdown_bank* bank, ringdown_motion motion, const double at_m[3],
                                  const double direction[3], const double to_m[3], const double to_direction[3],
                                  const double* frequencies_hz, size_t count, double* frf, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!at_m || !direction || !to_m || !to_direction) return missing("a place or a direction");
    if (!frequencies_hz) return missing("frequencies_hz");
    if (!frf) return missing("frf");
    if (motion < RINGDOWN_DISPLACEMENT || motion > RINGDOWN_ACCELERATION)
      return fail(ErrorKind::bad_input, "there is no motion " + std::to_string(static_cast<int>(motion)));
    return give_response(
        modal::frequency_response(known(bank), surface(bank), {vector(at_m), vector(direction)},
                                  {vector(to_m), vector(to_direction)}, static_cast<modal::Motion>(motion),
                                  {frequencies_hz, count}, bank->residual ? &*bank->residual : nullptr),
        frf);
  });
}

ringdown_result ringdown_bank_pressure_frf(const ringdown_bank* bank, const double at_m[3], const double direction[3],
                                           const double to_m[3], const double* frequencies_hz, size_t count,
                                           double* frf, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!at_m || !direction || !to_m) return missing("a place or a direction");
    if (!frequencies_hz) return missing("frequencies_hz");
    if (!frf) return missing("frf");
    return give_response(modal::pressure_response(known(bank), surface(bank), {vector(at_m), vector(direction)},
                                                  vector(to_m), {frequencies_hz, count}),
                         frf);
  });
}

ringdown_result ringdown_bank_energy_spectrum(const ringdown_bank* bank, const double at_m[3],
                                              const double direction[3], const double* frequencies_hz, size_t count,
                                              double* energies, ringdown_error* error) {
  return guarded(error, [&]() -> Result<void> {
    if (!bank) return missing("bank");
    if (!at_m || !direction) return missing("a place or a direction");
    if (!frequencies_hz) return missing("frequencies_hz");
    if (!energies) return missing("energies");
    const auto found =
        modal::energy_spectrum(known(bank), surface(bank), {vector(at_m), vector(direction)}, {frequencies_hz, count});
    if (!found) return fail(found);
    std::ranges::copy(*found, energies);
    return {};
  });
}

#include "engine/modal/response/residual.h"

#include "engine/base/atomic_file.h"
#include "engine/base/output_file.h"

#include <cmath>
#include <cstring>
#include <string>
#include <string_view>

namespace ringdown::modal {
namespace {

constexpr std::string_view kMagic{"\x93NUMPY\x01\x00", 8};
constexpr std::size_t kHeaderEnd = 128;  // the header is padded to here

std::string header_of(std::size_t points) {
  const std::string rows = std::to_string(3 * points);
  std::string text = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, " + rows + ", " + rows + "), }";
  text.resize(kHeaderEnd - kMagic.size() - 3, ' ');
  const auto length = static_cast<char>(kHeaderEnd - kMagic.size() - 2);
  return std::string(kMagic) + length + '\0' + text + '\n';
}

}  // namespace

Result<void> write_residual(const Residual& residual, const std::filesystem::path& path) {
  std::string bytes = header_of(residual.points);
  for (const std::vector<float>* matrix : {&residual.flexibility, &residual.inertia})
    bytes.append(reinterpret_cast<const char*>(matrix->data()), sizeof(float) * matrix->size());
  return write_output(path, std::string_view(bytes));
}

Result<Residual> read_residual(const std::filesystem::path& path, std::size_t points) {
  const std::size_t rows = 3 * points, size = rows * rows;
  if (points > kMaxResidualPoints)
    return fail(ErrorKind::too_large, "a residual is of at most " + std::to_string(kMaxResidualPoints) + " points");
  const Result<std::string> bytes = read_whole_file(path, kHeaderEnd + 2 * sizeof(float) * size + 1);
  if (!bytes) return fail(bytes);
  if (bytes->size() != kHeaderEnd + 2 * sizeof(float) * size || !bytes->starts_with(header_of(points)))
    return fail(ErrorKind::bad_input, path.string() + " is not the residual of a bank of " + std::to_string(points) +
                                          " points; `ringdown bake --export-residual` writes it with the bank");
  Residual residual{.points = points, .flexibility = std::vector<float>(size), .inertia = std::vector<float>(size)};
  if (size > 0) {
    std::memcpy(residual.flexibility.data(), bytes->data() + kHeaderEnd, sizeof(float) * size);
    std::memcpy(residual.inertia.data(), bytes->data() + kHeaderEnd + sizeof(float) * size, sizeof(float) * size);
  }
  for (const std::vector<float>* matrix : {&residual.flexibility, &residual.inertia}) {
    for (const float number : *matrix) {
      if (!std::isfinite(number))
        return fail(ErrorKind::bad_input, path.string() + " holds a number that is not finite");
    }
  }
  return residual;
}

}  // namespace ringdown::modal

// The two files between solve_modes() and ringdown-modes-slepc: a problem goes out, modes come back. [any thread]
//
// The files are private to one run on one kind of machine, so numbers are stored as in memory. K and M are stored with
// whole rows (both triangles), row by row, so that each process can be given its own rows; M is the N x N node matrix
// (fem::System). Files are written under another name and renamed when complete. Sizes are checked against the file's
// size before memory is allocated. The program shares this code; it knows neither Eigen nor the mesh.
#pragma once

#include "engine/base/result.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

namespace ringdown::solve {

struct ProblemHeader {
  std::array<char, 8> magic = {'R', 'D', 'P', 'R', 'O', 'B', '0', '1'};
  std::int64_t nodes = 0;              // N: K has 3N rows, M has N
  std::int64_t stiffness_entries = 0;  // both triangles
  std::int64_t mass_entries = 0;
  double highest_lambda = 0;
  double tolerance = 0;
  std::int64_t max_modes = 0;
};

struct ModesHeader {
  std::array<char, 8> magic = {'R', 'D', 'M', 'O', 'D', 'E', '0', '1'};
  std::int64_t nodes = 0;
  std::int64_t modes = 0;
  std::int64_t solves = 0;
  std::int64_t factorizations = 0;
  double factor_seconds = 0;
  double iterate_seconds = 0;
};

// Rows of a sparse matrix: the entries of row r are starts[r] ... starts[r + 1] - 1 (starts[0] = 0 after reading).
struct SparseRows {
  std::vector<std::int64_t> starts;
  std::vector<std::int32_t> columns;
  std::vector<double> values;
};

// A whole matrix in arrays that the caller owns.
struct SparseView {
  std::span<const int> starts, columns;
  std::span<const double> values;
};

// Fails with a sentence when the disk is full or the folder is not writable.
Result<void> write_problem(const std::filesystem::path& path, const ProblemHeader& header, const SparseView& stiffness,
                           const SparseView& mass);

class ProblemFile {
 public:
  // Fails when the file is not a problem file or is not complete.
  static Result<ProblemFile> open(const std::filesystem::path& path);

  [[nodiscard]] const ProblemHeader& header() const { return header_; }
  // Rows first ... first + count - 1; fails when the file cannot be read or contains an impossible number.
  Result<SparseRows> stiffness_rows(std::int64_t first, std::int64_t count);
  Result<SparseRows> mass_rows(std::int64_t first, std::int64_t count);

 private:
  Result<SparseRows> rows(std::int64_t offset, std::int64_t all_rows, std::int64_t entries, std::int64_t first,
                          std::int64_t count);
  std::ifstream file_;
  ProblemHeader header_;
};

// Writes the modes. `shape(m)` returns the 3N numbers of mode m.
Result<void> write_modes(const std::filesystem::path& path, const ModesHeader& header, std::span<const double> lambda,
                         const std::function<std::span<const double>(std::int64_t mode)>& shape);

struct ModesFile {
  ModesHeader header;
  std::vector<double> lambda;
  std::vector<double> shapes;  // 3N x m, column by column
};
Result<ModesFile> read_modes(const std::filesystem::path& path, std::int64_t nodes);

}  // namespace ringdown::solve

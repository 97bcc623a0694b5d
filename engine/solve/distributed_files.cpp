#include "engine/solve/distributed_files.h"

#include <limits>

namespace ringdown::solve {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxNodes = std::numeric_limits<std::int32_t>::max() / 3;
constexpr std::int64_t kMaxEntries = std::numeric_limits<std::int32_t>::max();

template <class T>
void put(std::ofstream& file, std::span<const T> values) {
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}

template <class T>
bool get(std::ifstream& file, std::int64_t offset, std::span<T> values) {
  const auto bytes = static_cast<std::streamsize>(values.size_bytes());
  file.clear();
  file.seekg(offset);
  file.read(reinterpret_cast<char*>(values.data()), bytes);
  return file.gcount() == bytes;
}

template <class Header>
bool get_header(std::ifstream& file, Header& header) {
  Header read;
  if (!get(file, 0, std::span(&read, 1)) || read.magic != header.magic) return false;
  header = read;
  return true;
}

std::int64_t matrix_bytes(std::int64_t rows, std::int64_t entries) { return 8 * (rows + 1) + (4 + 8) * entries; }

void put_matrix(std::ofstream& file, const SparseView& matrix) {
  const std::vector<std::int64_t> starts(matrix.starts.begin(), matrix.starts.end());
  put(file, std::span<const std::int64_t>(starts));
  put(file, matrix.columns);
  put(file, matrix.values);
}

Result<void> write_whole(const fs::path& path, const std::function<void(std::ofstream&)>& write) {
  const fs::path part = path.string() + ".part";
  std::ofstream file(part, std::ios::binary);
  if (file) write(file);
  file.close();
  std::error_code error;
  if (file) fs::rename(part, path, error);
  if (file && !error) return {};
  fs::remove(part, error);
  return fail(ErrorKind::input_output,
              "cannot write " + path.string() + "; is the disk full? TMPDIR names another place");
}

bool sane(const ProblemHeader& h) {
  return h.nodes > 0 && h.nodes <= kMaxNodes && h.stiffness_entries >= 0 && h.stiffness_entries <= kMaxEntries &&
         h.mass_entries >= 0 && h.mass_entries <= kMaxEntries && h.highest_lambda > 0 && h.tolerance > 0 &&
         h.max_modes > 0;
}

std::int64_t file_bytes(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return error ? -1 : static_cast<std::int64_t>(size);
}

}  // namespace

Result<void> write_problem(const fs::path& path, const ProblemHeader& header, const SparseView& stiffness,
                           const SparseView& mass) {
  return write_whole(path, [&](std::ofstream& file) {
    put(file, std::span(&header, 1));
    put_matrix(file, stiffness);
    put_matrix(file, mass);
  });
}

Result<ProblemFile> ProblemFile::open(const fs::path& path) {
  ProblemFile problem;
  problem.file_.open(path, std::ios::binary);
  if (!problem.file_) return fail(ErrorKind::input_output, "cannot open " + path.string());
  ProblemHeader& header = problem.header_;
  const bool good = get_header(problem.file_, header) && sane(header) &&
                    file_bytes(path) == static_cast<std::int64_t>(sizeof header) +
                                            matrix_bytes(3 * header.nodes, header.stiffness_entries) +
                                            matrix_bytes(header.nodes, header.mass_entries);
  if (!good) return fail(ErrorKind::bad_input, path.string() + " is not a complete problem file of this version");
  return problem;
}

Result<SparseRows> ProblemFile::rows(std::int64_t offset, std::int64_t all_rows, std::int64_t entries,
                                     std::int64_t first, std::int64_t count) {
  const auto broken = [] { return fail(ErrorKind::bad_input, "the problem file holds impossible numbers"); };
  SparseRows rows;
  rows.starts.resize(static_cast<std::size_t>(count) + 1);
  if (!get(file_, offset + 8 * first, std::span(rows.starts))) return broken();
  const std::int64_t start = rows.starts.front(), end = rows.starts.back();
  if (start < 0 || end > entries) return broken();
  for (std::size_t r = 0; r + 1 < rows.starts.size(); ++r) {
    if (rows.starts[r] > rows.starts[r + 1]) return broken();
  }
  rows.columns.resize(static_cast<std::size_t>(end - start));
  rows.values.resize(rows.columns.size());
  const std::int64_t columns_at = offset + 8 * (all_rows + 1), values_at = columns_at + 4 * entries;
  if (!get(file_, columns_at + 4 * start, std::span(rows.columns)) ||
      !get(file_, values_at + 8 * start, std::span(rows.values))) {
    return broken();
  }
  for (const std::int32_t column : rows.columns) {
    if (column < 0 || column >= all_rows) return broken();
  }
  for (std::int64_t& row_start : rows.starts) row_start -= start;
  return rows;
}

Result<SparseRows> ProblemFile::stiffness_rows(std::int64_t first, std::int64_t count) {
  return rows(sizeof header_, 3 * header_.nodes, header_.stiffness_entries, first, count);
}

Result<SparseRows> ProblemFile::mass_rows(std::int64_t first, std::int64_t count) {
  const std::int64_t offset = sizeof header_ + matrix_bytes(3 * header_.nodes, header_.stiffness_entries);
  return rows(offset, header_.nodes, header_.mass_entries, first, count);
}

Result<void> write_modes(const fs::path& path, const ModesHeader& header, std::span<const double> lambda,
                         const std::function<std::span<const double>(std::int64_t mode)>& shape) {
  return write_whole(path, [&](std::ofstream& file) {
    put(file, std::span(&header, 1));
    put(file, lambda);
    for (std::int64_t m = 0; m < header.modes; ++m) put(file, shape(m));
  });
}

Result<ModesFile> read_modes(const fs::path& path, std::int64_t nodes) {
  const auto broken = [&] { return fail(ErrorKind::bad_input, path.string() + " is not a complete file of modes"); };
  std::ifstream file(path, std::ios::binary);
  ModesFile modes;
  ModesHeader& header = modes.header;
  if (!file || !get_header(file, header) || header.nodes != nodes || header.modes < 0) return broken();
  const std::int64_t rows = 3 * nodes;
  if (header.modes > rows ||
      file_bytes(path) != static_cast<std::int64_t>(sizeof header) + 8 * header.modes * (rows + 1)) {
    return broken();
  }
  modes.lambda.resize(static_cast<std::size_t>(header.modes));
  modes.shapes.resize(static_cast<std::size_t>(header.modes * rows));
  const auto shapes_at = static_cast<std::int64_t>(sizeof header) + 8 * header.modes;
  if (!get(file, sizeof header, std::span(modes.lambda)) || !get(file, shapes_at, std::span(modes.shapes))) {
    return broken();
  }
  return modes;
}

}  // namespace ringdown::solve

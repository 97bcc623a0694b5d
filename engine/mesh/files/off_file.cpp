#include "engine/mesh/files/surface_formats.h"
#include "engine/mesh/files/text_lines.h"

namespace ringdown::mesh {

// "OFF", or "COFF", "NOFF" and the like; counts may follow in the same line; then a line for each point and each face.
Result<TriangleSoup> read_off(std::string_view content, const std::string& name) {
  TextLines lines(content, name, TextLines::kBlanks);
  if (lines.next().empty()) return fail(ErrorKind::bad_input, name + ": the file is empty");
  const std::string_view header = lines.word();
  std::size_t counts_at = 0;
  if (header.ends_with("OFF")) {
    if (header.find_first_of("4n") != header.npos) return lines.wrong("points of four coordinates are not supported");
    counts_at = 1;
    if (lines.words().size() > 1 && lines.words()[1] == "BINARY") return lines.wrong("binary OFF is not supported");
    if (lines.words().size() == 1) {
      lines.next();
      counts_at = 0;
    }
  }
  std::int64_t points = 0, faces = 0;
  if (!lines.read(counts_at, points) || !lines.read(counts_at + 1, faces) || points < 0 || faces < 0)
    return lines.wrong("the numbers of points and faces are missing here");
  TriangleSoup soup;
  for (std::int64_t n = 0; n < points; ++n) {
    if (lines.next().empty()) return lines.wrong("the file ends before its last point");
    Eigen::RowVector3d& at = soup.points.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      if (!lines.read(static_cast<std::size_t>(axis), at[axis]))
        return lines.wrong("a point should have three finite coordinates");
    }
  }
  std::vector<std::int32_t> corners;
  for (std::int64_t f = 0; f < faces; ++f) {
    if (lines.next().empty()) return lines.wrong("the file ends before its last face");
    std::size_t count = 0;
    if (!lines.read(0, count) || count >= lines.words().size())
      return lines.wrong("a face should have the number of its corners, and one point for each");
    corners.assign(count, 0);
    for (std::size_t k = 0; k < count; ++k) {
      if (!lines.read(1 + k, corners[k]) || corners[k] < 0 || corners[k] >= points)
        return lines.wrong("there is no point " + std::string(lines.words()[1 + k].substr(0, 40)));
    }
    add_polygon(soup, corners);
  }
  return soup;
}

}  // namespace ringdown::mesh

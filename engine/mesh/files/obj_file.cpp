#include "engine/mesh/files/surface_formats.h"
#include "engine/mesh/files/text_lines.h"

namespace ringdown::mesh {
namespace {

constexpr const char* kPointRule = "a point should have three finite coordinates";

// Joins lines that end with a backslash to their next ones, with blanks in place of what ends them.
std::string joined(std::string_view content) {
  std::string text(content);
  for (std::size_t at = 0; (at = text.find('\\', at)) != std::string::npos; ++at) {
    const std::size_t end = text.find_first_not_of("\r\n", at + 1);
    const std::size_t after = std::min(end == std::string::npos ? text.size() : end, at + 3);
    for (std::size_t k = at + 1; k < after; ++k) text[k] = text[at] = ' ';
  }
  return text;
}

// Returns the number of the point that "7", "7/1", "7//2" or "-1" names, where `before` points stand before the line;
// below 0 when it is no number.
std::int64_t point_of(std::string_view word, std::int64_t before) {
  std::int64_t number = 0;
  if (!TextLines::read_word(word.substr(0, word.find('/')), number)) return -1;
  return number < 0 ? before + number : number - 1;
}

}  // namespace

// Faces may name points that come later, so all points are read first.
Result<TriangleSoup> read_obj(std::string_view content, const std::string& name) {
  const std::string without_breaks = content.find('\\') == content.npos ? "" : joined(content);
  const std::string_view text = without_breaks.empty() ? content : without_breaks;
  TriangleSoup soup;
  TextLines points(text, name, TextLines::kBlanks);
  while (!points.next().empty()) {
    if (points.word() != "v") continue;
    Eigen::RowVector3d& at = soup.points.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      if (!points.read(1 + static_cast<std::size_t>(axis), at[axis])) return points.wrong(kPointRule);
    }
  }
  TextLines lines(text, name, TextLines::kBlanks);
  std::int64_t before = 0;
  std::vector<std::int32_t> corners;
  while (!lines.next().empty()) {
    if (lines.word() == "v") ++before;
    if (lines.word() != "f" && lines.word() != "fo") continue;
    corners.clear();
    for (std::size_t k = 1; k < lines.words().size(); ++k) {
      const std::int64_t point = point_of(lines.words()[k], before);
      if (point < 0 || point >= static_cast<std::int64_t>(soup.points.size())) {
        return lines.wrong(formatted("the face names a point {}, and the file has {}", lines.words()[k].substr(0, 40),
                                     soup.points.size()));
      }
      corners.push_back(static_cast<std::int32_t>(point));
    }
    add_polygon(soup, corners);
  }
  return soup;
}

}  // namespace ringdown::mesh

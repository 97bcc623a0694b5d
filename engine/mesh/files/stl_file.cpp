#include "engine/mesh/files/surface_formats.h"
#include "engine/mesh/files/text_lines.h"

#include <cctype>
#include <cstring>

// Which of the two kinds
//
// A text begins with "solid", but so do the headers of some binary files. A file whose length is that of the number of
// triangles which its header counts is binary; otherwise one that begins with "solid" and has the word "facet" or
// "endsolid" near its beginning is a text.
namespace ringdown::mesh {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;  // bytes; the number of triangles is the header's last 4
constexpr std::size_t kHeadBytes = 4096;                       // bytes that tell a text

std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

std::size_t announced(std::string_view content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + kHeaderBytes - sizeof count, sizeof count);
  return count;
}

bool is_text(std::string_view content) {
  if (content.size() >= kHeaderBytes && content.size() == kHeaderBytes + kTriangleBytes * announced(content))
    return false;
  const std::string head = in_small_letters(content.substr(0, kHeadBytes));
  const std::size_t start = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return start != std::string::npos && head.compare(start, 5, "solid") == 0 &&
         (head.find("facet") != std::string::npos || head.find("endsolid") != std::string::npos);
}

// Each run of `vertex` lines up to `endloop` is a face. What the file calls itself stands behind `solid`.
Result<TriangleSoup> read_text(std::string_view content, const std::string& name) {
  TriangleSoup soup;
  TextLines lines(content, name, TextLines::kBlanks);
  std::vector<std::int32_t> corners;
  bool within_facet = false;
  while (!lines.next().empty()) {
    for (std::size_t k = 0; k < lines.words().size(); ++k) {
      const std::string word = in_small_letters(lines.words()[k]);
      if (word == "solid" || word == "endsolid") break;
      if (word == "facet" || word == "endfacet") within_facet = word == "facet";
      if (word == "vertex") {
        corners.push_back(static_cast<std::int32_t>(soup.points.size()));
        Eigen::RowVector3d& at = soup.points.emplace_back();
        for (int axis = 0; axis < 3; ++axis) {
          if (!lines.read(++k, at[axis])) return lines.wrong("a corner of a triangle should be three finite numbers");
        }
      } else if (word == "endloop") {
        add_polygon(soup, corners);
        corners.clear();
      }
    }
  }
  if (within_facet || !corners.empty()) return lines.wrong("the file was cut off within a triangle");
  return soup;
}

Result<TriangleSoup> read_binary(std::string_view content, const std::string& name) {
  if (content.size() < kHeaderBytes) {
    return fail(ErrorKind::bad_input,
                "{} is not an STL file: it neither begins with \"solid\", as text does, nor has the {} bytes of its "
                "binary header",
                name, kHeaderBytes);
  }
  const std::size_t said = announced(content), there = (content.size() - kHeaderBytes) / kTriangleBytes;
  const bool whole = (content.size() - kHeaderBytes) % kTriangleBytes == 0;
  if (!whole && (said == 0 || said > there)) {
    return fail(
        ErrorKind::bad_input,
        "{} was cut off, or is not an STL file: its header says {} triangles, and it ends within the one after {}",
        name, said, there);
  }
  const std::size_t count = whole ? there : said;
  TriangleSoup soup;
  if (said != there) {
    soup.notes.push_back(formatted("its header says {} triangles, but {} follow; {} were read", said, there, count));
  }
  for (std::size_t t = 0; t < count; ++t) {
    std::array<float, 9> corners{};
    std::memcpy(corners.data(), content.data() + kHeaderBytes + t * kTriangleBytes + 12, sizeof corners);
    const auto first = static_cast<std::int32_t>(soup.points.size());
    for (std::size_t k = 0; k < 9; k += 3) soup.points.emplace_back(corners[k], corners[k + 1], corners[k + 2]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  soup.rounding = float_spacing(soup.points);
  return soup;
}

}  // namespace

Result<TriangleSoup> read_stl(std::string_view content, const std::string& name) {
  return is_text(content) ? read_text(content, name) : read_binary(content, name);
}

}  // namespace ringdown::mesh

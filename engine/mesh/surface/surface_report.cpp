#include "engine/mesh/surface/surface_report.h"

#include "engine/base/formatted.h"

#include <algorithm>

namespace ringdown::mesh {
namespace {

struct Words {
  const char *one, *many;
};

Words words_of(Fault fault) {
  switch (fault) {
    case Fault::kUnusedPoints:
      return {"point of no triangle", "points of no triangle"};
    case Fault::kDegenerate:
      return {"triangle without area", "triangles without area"};
    case Fault::kDuplicate:
      return {"duplicated triangle", "duplicated triangles"};
    case Fault::kSliver:
      return {"sliver", "slivers"};
    case Fault::kCrowdedEdge:
      return {"edge with more than two triangles", "edges with more than two triangles"};
    case Fault::kHole:
      return {"hole", "holes"};
    case Fault::kFlipped:
      return {"flipped triangle", "flipped triangles"};
    case Fault::kSelfIntersection:
      return {"self-intersection", "self-intersections"};
    case Fault::kInsideOut:
      return {"shell inside out", "shells inside out"};
    case Fault::kSeveralShells:
      return {"further separate shell", "further separate shells"};
    case Fault::kCavity:
      return {"cavity", "cavities"};
    case Fault::kBuried:
      return {"body inside another", "bodies inside others"};
    case Fault::kOverlap:
      return {"intersection between shells", "intersections between shells"};
    case Fault::kSheet:
      return {"open sheet", "open sheets"};
    case Fault::kNoVolume:
      return {"surface without volume", "surfaces without volume"};
  }
  return {"fault", "faults"};
}

std::string with_place(const Finding& finding) {
  if (finding.places.empty()) return "";
  const Eigen::RowVector3d& at = finding.places.front();
  return formatted(", {}at ({:.4g}, {:.4g}, {:.4g}) m", finding.count > 1 ? "the first " : "", at[0], at[1], at[2]);
}

}  // namespace

const Finding* SurfaceReport::find(Fault fault) const {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [fault](const Finding& f) { return f.fault == fault; });
  return found == findings.end() ? nullptr : &*found;
}

bool SurfaceReport::closed() const { return !find(Fault::kHole) && !find(Fault::kCrowdedEdge); }

bool SurfaceReport::sound() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return is_harmless(f.fault); });
}

bool is_harmless(Fault fault) {
  return fault == Fault::kUnusedPoints || fault == Fault::kSliver || fault == Fault::kSeveralShells ||
         fault == Fault::kCavity;
}

std::string name_of(Fault fault) { return words_of(fault).many; }

std::string describe(const Finding& finding) {
  const Words words = words_of(finding.fault);
  const bool cuts = finding.fault == Fault::kSelfIntersection || finding.fault == Fault::kOverlap;
  std::string text = cuts && finding.count >= kMaxIntersections ? "at least " : "";
  text += formatted("{} {}", finding.count, finding.count == 1 ? words.one : words.many);
  if (finding.length_m > 0) {
    text += formatted(", {}{:.3g} m around", finding.count > 1 ? "the longest " : "", finding.length_m);
  }
  return text + with_place(finding);
}

std::string hopeless(const PreparedSurface& surface, const std::string& name) {
  const auto has = [&surface](Fault fault) { return surface.found.find(fault) || surface.left.find(fault); };
  if (!has(Fault::kSheet) && !has(Fault::kNoVolume)) return "";
  return name + " encloses nothing: it is an open sheet, or flat; give it a thickness in a mesh tool";
}

}  // namespace ringdown::mesh

// Readers of surfaces, one for each format, from the content of a file. surface_file.h is the way to them. [any thread]
//
//   OBJ   points and faces; faces may be polygons and count from the end. Curves, lines, texture coordinates, normals
//         and materials are passed over, and no other file is opened.
//   STL   text or binary. A binary file is told by its length and its header, not by its first word. Where the header
//         counts another number of triangles than follow, as after a stream, those that follow are read, with a note.
//   PLY   text or binary of either byte order; the elements `vertex` and `face`, whose properties may stand in any
//   order OFF   text, also with colours and normals
//
// Fail with one sentence: the line or the element, and what is wrong there. Numbers may be any that C reads, also
// ".5", "5." and "+1e-3".
#pragma once

#include "engine/mesh/files/triangle_soup.h"

#include <string>
#include <string_view>

namespace ringdown::mesh {

Result<TriangleSoup> read_obj(std::string_view content, const std::string& name);
Result<TriangleSoup> read_stl(std::string_view content, const std::string& name);
Result<TriangleSoup> read_ply(std::string_view content, const std::string& name);
Result<TriangleSoup> read_off(std::string_view content, const std::string& name);

// The readers by their files' endings, one for each format of FileKind::surface (engine/base/file_format.h).
struct SurfaceReader {
  std::string_view ending;
  Result<TriangleSoup> (*read)(std::string_view content, const std::string& name);
};
inline constexpr SurfaceReader kSurfaceReaders[] = {
    {".obj", read_obj}, {".stl", read_stl}, {".ply", read_ply}, {".off", read_off}};

}  // namespace ringdown::mesh

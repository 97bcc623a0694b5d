#include "engine/scene/gltf/camera.h"

#include "engine/base/quote.h"
#include "engine/scene/gltf/document.h"

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::scene {
namespace {

using modal::JsonPlace;

std::vector<std::string> names_of(const GltfNode& node, const std::vector<GltfNode>& nodes, const JsonPlace& camera) {
  std::vector<std::string> names = {node.name};
  for (auto at = node.parent; at; at = nodes[*at].parent) names.push_back(nodes[*at].name);
  names.emplace_back(camera["name"].text_or(""));
  return names;
}

}  // namespace

// A camera looks along its -z axis; y is up.
Result<void> add_camera(GltfAnimations& animations, const std::optional<std::string>& name, SceneDescription& scene) {
  GltfDocument& document = animations.document();
  const std::vector<GltfNode>& nodes = document.nodes();
  const auto camera_of = [&](const GltfNode& node) {
    return document.element(node.field["camera"], document.root()["cameras"]);
  };
  std::string known;
  const auto found = std::ranges::find_if(nodes, [&](const GltfNode& node) {
    if (!node.in_scene || !node.field["camera"].present()) return false;
    if (!name) return true;
    const std::vector<std::string> names = names_of(node, nodes, camera_of(node));
    known += (known.empty() ? "" : ", ") + quote(names.front());
    return std::ranges::find(names, *name) != names.end();
  });
  if (found == nodes.end()) {
    if (!name) return {};
    return fail(ErrorKind::bad_input, "it has no camera {}{}", quote(*name),
                known.empty() ? " and no other one" : "; its cameras are " + known);
  }
  const Pose pose{found->world.shift_m, parts_of(found->world.linear).rotation};
  const Rotation forward_left_up = Rotation::from_xyzw(-0.5, 0.5, 0.5, 0.5);  // x to -z, y to -x, z to y
  const double yfov_rad = document.number(camera_of(*found)["perspective"]["yfov"], 0.8);
  scene.listener = ListenerDescription{.position_m = pose.position_m, .rotation = pose.rotation * forward_left_up};
  if (const auto way = animations.path_of(static_cast<std::size_t>(found - nodes.begin()))) {
    auto path = std::make_shared<MotionPath>(*way);
    for (Pose& at : path->poses) at.rotation = at.rotation * forward_left_up;
    scene.listener->position_m = path->poses.front().position_m;
    scene.listener->rotation = path->poses.front().rotation;
    scene.listener->path = std::move(path);
  }
  scene.camera = CameraDescription{
      .position_m = pose.position_m,
      .target_m = pose.position_m + rotated(pose.rotation, {0, 0, -1}),
      .field_of_view_degrees = std::clamp(yfov_rad * 180 / std::numbers::pi, range::kFieldOfView_degrees.low,
                                          range::kFieldOfView_degrees.high)};
  return {};
}

}  // namespace ringdown::scene

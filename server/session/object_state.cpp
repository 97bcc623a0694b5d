#include "server/session/object_state.h"

#include <array>

namespace ringdown::session {

ObjectState untuned(const ObjectState& object) {
  ObjectState state = object;
  state.material.size = object.untuned_size.value_or(object.material.size);
  state.untuned_size.reset();
  return state;
}

std::optional<double> level_m(const ObjectState& object) {
  if (!object.at_level) return std::nullopt;
  return object.material.size * object.at_level->level_m;
}

double present_level_m(const ObjectState& object) {
  const modal::Bank& baked = object.baked_map->bank();
  return level_m(object).value_or(baked.levels ? object.material.size * modal::baked_level_m(baked) : 0);
}

std::optional<modal::TubeTuning> tube_tuning(const ObjectState& object) {
  if (!object.tubes) return std::nullopt;
  return object.tubes->tuning;
}

std::shared_ptr<const modal::ModeTransfer> mode_change(const ObjectState& before, const ObjectState& after) {
  if (before.map != after.map && after.tubes) {
    const modal::Bank& baked = after.baked_map->bank();
    const auto from = before.tubes ? Result<modal::TubeModes>(*before.tubes) : modal::as_tuned(baked);
    if (!from) return nullptr;
    return std::make_shared<const modal::ModeTransfer>(modal::transfer(*from, *after.tubes, baked.mode_count()));
  }
  if (before.map == after.map || !after.at_level) return nullptr;
  const modal::LevelModes from = before.at_level ? *before.at_level : modal::as_baked(before.map->bank());
  return std::make_shared<const modal::ModeTransfer>(modal::transfer(from, *after.at_level));
}

Result<void> check_point(Vec3 point_m, const ObjectState& object) {
  const modal::SurfaceIndex& surface = object.map->surface();  // of the object in the size of its bank
  const double scale = object.material.size;
  const double size_m = scale * surface.size_m(), distance_m = scale * surface.distance_m((1 / scale) * point_m);
  if (size_m == 0 || distance_m <= size_m) return {};
  const std::string numbers = formatted("{:.3g} m off the object, which measures {:.3g} m", distance_m, size_m);
  return fail(ErrorKind::bad_input, "the point lies {}; points are in metres, in the object's own coordinates",
              numbers);
}

}  // namespace ringdown::session

#include "server/session/silences.h"

namespace ringdown::session {

Result<void> Silences::update(const std::vector<ObjectSnapshot>& objects, const ObjectState* changed) {
  std::vector<const ObjectState*> present;
  if (changed) present.push_back(changed);
  for (const ObjectSnapshot& object : objects) {
    if (!changed || object->number != changed->number) present.push_back(object.get());
  }
  bool soloed = false;
  for (const ObjectState* object : present) soloed = soloed || object->solo;
  for (const ObjectState* object : present) {
    const bool silent = object->mute || (soloed && !object->solo);
    if (silent == silent_.contains(object->number)) continue;
    if (!mixer_.silence(object->number, silent)) {
      return fail(ErrorKind::refused, "too many changes of objects at once; try again");
    }
    if (silent) {
      silent_.insert(object->number);
    } else {
      silent_.erase(object->number);
    }
  }
  return {};
}

}  // namespace ringdown::session

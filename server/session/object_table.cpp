#include "server/session/object_table.h"

#include <algorithm>
#include <utility>

namespace ringdown::session {

class ObjectTable::Reading {
 public:
  explicit Reading(const ObjectTable& table) : readers_(table.readers_) { readers_.fetch_add(1); }
  ~Reading() { readers_.fetch_sub(1); }
  Reading(const Reading&) = delete;
  Reading& operator=(const Reading&) = delete;

 private:
  std::atomic<std::uint32_t>& readers_;
};

ObjectTable::~ObjectTable() {
  for (const auto& slot : slots_) delete slot.load();
  delete index_.load();
}

ObjectSnapshot ObjectTable::find(synth::ObjectNumber number) const {
  if (number >= slots_.size()) return nullptr;
  const Reading reading(*this);
  const Node<ObjectState>* const node = slots_[number].load();
  return node ? *node : nullptr;
}

ObjectSnapshot ObjectTable::find(const std::string& name) const {
  const Reading reading(*this);
  const Index& index = **index_.load();
  const auto found = index.numbers.find(name);
  if (found == index.numbers.end()) return nullptr;
  // Since the index was loaded, the object may have been removed, and its number given to another object.
  const Node<ObjectState>* const node = slots_[found->second].load();
  return node && (*node)->name == name ? *node : nullptr;
}

std::shared_ptr<const ObjectTable::Names> ObjectTable::names() const {
  const Reading reading(*this);
  return (*index_.load())->names;
}

std::vector<ObjectSnapshot> ObjectTable::all() const {
  std::vector<ObjectSnapshot> objects;
  const auto held = names();  // keeps the names alive if another thread replaces them meanwhile
  for (const std::string& name : *held) {
    if (ObjectSnapshot object = find(name)) objects.push_back(std::move(object));
  }
  return objects;
}

ObjectSnapshot ObjectTable::add(ObjectState object) {
  const auto added = std::make_shared<const ObjectState>(std::move(object));
  const std::scoped_lock lock(writing_);
  auto index = std::make_shared<Index>(**index_.load());
  index->numbers.emplace(added->name, added->number);
  index->names = names_of(*index);
  publish(added->number, added);
  publish(std::move(index));
  return added;
}

ObjectTable::Replaced ObjectTable::replace(synth::ObjectNumber number, const std::function<void(ObjectState&)>& edit) {
  const std::scoped_lock lock(writing_);
  ObjectSnapshot before = find(number);
  if (!before) return {};
  auto after = std::make_shared<ObjectState>(*before);
  edit(*after);
  publish(number, after);
  return {std::move(before), std::move(after)};
}

void ObjectTable::remove(synth::ObjectNumber number) {
  const std::scoped_lock lock(writing_);
  const ObjectSnapshot object = find(number);
  if (!object) return;
  auto index = std::make_shared<Index>(**index_.load());
  index->numbers.erase(object->name);
  index->names = names_of(*index);
  publish(std::move(index));
  publish(number, nullptr);
}

std::shared_ptr<const ObjectTable::Names> ObjectTable::names_of(const Index& index) {
  auto names = std::make_shared<Names>();
  for (const auto& [name, number] : index.numbers) names->push_back(name);
  std::ranges::sort(*names);
  return names;
}

void ObjectTable::publish(synth::ObjectNumber number, ObjectSnapshot next) {
  const auto* const old = slots_[number].exchange(next ? new Node<ObjectState>(std::move(next)) : nullptr);
  if (old) retired_.emplace_back(old);
}

void ObjectTable::publish(std::shared_ptr<const Index> next) {
  retired_indexes_.emplace_back(index_.exchange(new Node<Index>(std::move(next))));
}

void ObjectTable::collect() {
  decltype(retired_) states;  // destroyed after the lock is released, because freeing a bank takes long
  decltype(retired_indexes_) indexes;
  const std::scoped_lock lock(writing_);
  if (readers_.load() > 0) return;
  indexes.swap(retired_indexes_);
  const auto unused = std::ranges::partition(retired_, [](const auto& node) { return node->use_count() > 1; });
  std::ranges::move(unused, std::back_inserter(states));
  retired_.erase(unused.begin(), unused.end());
}

}  // namespace ringdown::session

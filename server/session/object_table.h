// The objects of a rack, by name and by number: snapshots that any thread reads without waiting, immutable except for
// gain and pan.
//
// Readers follow atomic pointers: for each number one to the object's snapshot, and one to the index of names. A writer
// prepares the next snapshot aside, stores the pointer, and retires the previous snapshot.
//
//   reader                                     writer, with the mutex
//   readers_ += 1                              pointer = successor
//   look up, copy a shared_ptr                 retired_ += predecessor
//   readers_ -= 1                              later, in collect(): if readers_ == 0, free what is retired
//
// These operations have one total order (sequential consistency). A reader that collect() does not count has either
// left or not yet entered; a reader that enters later also loads the pointers later and finds successors only. So no
// snapshot is freed while a reader looks at it. Neither readers nor collect() ever wait: snapshots in use are left for
// the next collect(). Snapshots that somebody still holds are left, too, so that no reader ever frees a bank.
#pragma once

#include "engine/synth/mixer.h"
#include "server/session/object_state.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

namespace ringdown::session {

class ObjectTable {
 public:
  ObjectTable() = default;
  ~ObjectTable();  // no thread may be reading
  ObjectTable(const ObjectTable&) = delete;
  ObjectTable& operator=(const ObjectTable&) = delete;

  // Returns the object as it is now, or null if there is none. Neither locks nor allocates; the time does not depend on
  // the number of objects. [any but audio]
  [[nodiscard]] ObjectSnapshot find(synth::ObjectNumber number) const;
  [[nodiscard]] ObjectSnapshot find(const std::string& name) const;

  // All names, in order; and all objects, in the order of their names. [any but audio]
  using Names = std::vector<std::string>;
  [[nodiscard]] std::shared_ptr<const Names> names() const;
  [[nodiscard]] std::vector<ObjectSnapshot> all() const;

  // Adds an object whose number and name are free. Writers wait for each other. [any but audio]
  ObjectSnapshot add(ObjectState object);

  // Replaces an object by the result of `edit`, which must not change name or number. Returns both snapshots, or nulls
  // if there is no object of that number. [any but audio]
  struct Replaced {
    ObjectSnapshot before, after;
  };
  Replaced replace(synth::ObjectNumber number, const std::function<void(ObjectState&)>& edit);

  // Removes the object; its name and number may be used again. [any but audio]
  void remove(synth::ObjectNumber number);

  // Frees snapshots that were replaced or removed and that nobody holds. Call now and then. [worker]
  void collect();

 private:
  struct Index {
    std::unordered_map<std::string, synth::ObjectNumber> numbers;
    std::shared_ptr<const Names> names = std::make_shared<const Names>();
  };
  // Counts a reader as long as it lives.
  class Reading;
  template <class T>
  using Node = std::shared_ptr<const T>;  // the target of an atomic pointer

  void publish(synth::ObjectNumber number, ObjectSnapshot next);
  void publish(std::shared_ptr<const Index> next);
  [[nodiscard]] static std::shared_ptr<const Names> names_of(const Index& index);

  mutable std::atomic<std::uint32_t> readers_ = 0;
  std::array<std::atomic<const Node<ObjectState>*>, synth::kMaxObjects> slots_{};
  std::atomic<const Node<Index>*> index_ = new Node<Index>(std::make_shared<const Index>());

  std::mutex writing_;  // guards the members below, and stores to the pointers
  std::vector<std::unique_ptr<const Node<ObjectState>>> retired_;
  std::vector<std::unique_ptr<const Node<Index>>> retired_indexes_;
};

}  // namespace ringdown::session

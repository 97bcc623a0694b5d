// The objects of a rack, by name and by number: immutable snapshots that any thread reads without waiting.
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
// left or not yet entered; one that enters later loads the pointers later, too, and finds successors only. So nothing
// is freed that a reader still looks at. Readers never wait; collect() does not either, but leaves for its next run
// what it finds in use. It also leaves snapshots that somebody still holds, so that no reader ever frees a bank.
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
  ~ObjectTable();  // nobody may be reading
  ObjectTable(const ObjectTable&) = delete;
  ObjectTable& operator=(const ObjectTable&) = delete;

  // The object as it is now, or null if there is none. Neither locks nor allocates; takes as long with one object as
  // with kMaxObjects. [any but audio]
  [[nodiscard]] ObjectSnapshot find(synth::ObjectNumber number) const;
  [[nodiscard]] ObjectSnapshot find(const std::string& name) const;

  // All names, in order; and all objects, in the order of their names. [any but audio]
  using Names = std::vector<std::string>;
  [[nodiscard]] std::shared_ptr<const Names> names() const;
  [[nodiscard]] std::vector<ObjectSnapshot> all() const;

  // Adds an object whose number and name are free. Writers wait for each other. [any but audio]
  ObjectSnapshot add(ObjectState object);

  // Replaces an object by what `edit` makes of it, which may be anything but another name or number. Both are null when
  // there is no object of that number. [any but audio]
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
  using Node = std::shared_ptr<const T>;  // what an atomic pointer points to

  void publish(synth::ObjectNumber number, ObjectSnapshot next);
  void publish(std::shared_ptr<const Index> next);
  [[nodiscard]] static std::shared_ptr<const Names> names_of(const Index& index);

  mutable std::atomic<std::uint32_t> readers_ = 0;
  std::array<std::atomic<const Node<ObjectState>*>, synth::kMaxObjects> slots_{};
  std::atomic<const Node<Index>*> index_ = new Node<Index>(std::make_shared<const Index>());

  std::mutex writing_;  // guards the rest, and stores to the pointers
  std::vector<std::unique_ptr<const Node<ObjectState>>> retired_;
  std::vector<std::unique_ptr<const Node<Index>>> retired_indexes_;
};

}  // namespace ringdown::session

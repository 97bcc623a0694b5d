// OneOf is a value of one type of a list, like std::variant, for long lists of types in headers that many files
// include.
//
//   using Answers = Types<Done, Fail>;
//   using Answer = OneOf<Answers>;
//
//   Answer answer = Fail{"/load", "cannot open it"};
//   if (const Fail* refusal = answer.get_if<Fail>()) ...
//   visit(Overloaded{[](const Done& done) { ... }, [](const Fail& refusal) { ... }}, answer);
//
// A visitor that lacks one of the types does not compile. There is no empty state and no exception.
//
// OneOf compiles fast, because nothing in it recurses over the list, and because the functions that copy, move and
// destroy are in one table for each list. To compile the table once, a header with a long list declares `extern
// template class ringdown::detail::OneOfStorage<List>;`, and one .cpp defines it. A OneOf of trivially copyable types
// is trivially copyable. [any thread; the audio thread visits with visit_now()]
#pragma once

#include "engine/base/realtime.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>

namespace ringdown {

template <class... Alternatives>
struct Types {
  static constexpr std::size_t kCount = sizeof...(Alternatives);
  static constexpr std::size_t kMaxSize = std::max({sizeof(Alternatives)...});
  static constexpr bool kTrivial = (std::is_trivially_copyable_v<Alternatives> && ...);
  template <class T>
  static constexpr bool kHas = (std::is_same_v<T, Alternatives> || ...);

  // The position of T in the list, which must contain T.
  template <class T>
  static constexpr std::size_t index_of() {
    static_assert(kHas<T>, "this type is not in the list");
    constexpr bool kIs[] = {std::is_same_v<T, Alternatives>...};
    std::size_t index = 0;
    while (!kIs[index]) ++index;
    return index;
  }
};

namespace detail {

template <class... First, class... Second>
Types<First..., Second...> join(Types<First...>, Types<Second...>);

// The operations on a value of one type.
struct Operations {
  void (*copy)(void* to, const void* from);
  void (*move)(void* to, void* from) noexcept;
  void (*destroy)(void* one) noexcept;
};

template <class T>
void copy(void* to, const void* from) {
  ::new (to) T(*static_cast<const T*>(from));
}
template <class T>
void move(void* to, void* from) noexcept {
  static_assert(std::is_nothrow_move_constructible_v<T>);
  ::new (to) T(std::move(*static_cast<T*>(from)));
}
template <class T>
void destroy(void* one) noexcept {
  static_cast<T*>(one)->~T();
}

template <class Answer, class Visitor, class Reference, class Pointer>
Answer call(Visitor& visitor, Pointer one) {
  return visitor(static_cast<Reference>(*static_cast<std::remove_reference_t<Reference>*>(one)));
}

}  // namespace detail

// The types of one list after those of another.
template <class First, class Second>
using Joined = decltype(detail::join(First(), Second()));

namespace detail {

// Stores the value of a OneOf. If all types are trivially copyable, the value is copied as bytes.
template <class List, bool kTrivial = List::kTrivial>
class OneOfStorage;

template <class... Alternatives>
class OneOfStorage<Types<Alternatives...>, true> {
 protected:
  explicit OneOfStorage(std::uint8_t index) : index_(index) {}

  alignas(Alternatives...) std::byte storage_[std::max({sizeof(Alternatives)...})];
  std::uint8_t index_;
};

template <class... Alternatives>
class OneOfStorage<Types<Alternatives...>, false> {
 public:
  OneOfStorage(const OneOfStorage& other);
  OneOfStorage(OneOfStorage&& other) noexcept;
  OneOfStorage& operator=(OneOfStorage other) noexcept;
  ~OneOfStorage();

 protected:
  explicit OneOfStorage(std::uint8_t index) : index_(index) {}

  alignas(Alternatives...) std::byte storage_[std::max({sizeof(Alternatives)...})];
  std::uint8_t index_;

 private:
  static const Operations kOperations[sizeof...(Alternatives)];
};

template <class... Alternatives>
constexpr Operations OneOfStorage<Types<Alternatives...>, false>::kOperations[] = {
    {copy<Alternatives>, move<Alternatives>, destroy<Alternatives>}...};

template <class... Alternatives>
OneOfStorage<Types<Alternatives...>, false>::OneOfStorage(const OneOfStorage& other) : index_(other.index_) {
  kOperations[index_].copy(storage_, other.storage_);
}

template <class... Alternatives>
OneOfStorage<Types<Alternatives...>, false>::OneOfStorage(OneOfStorage&& other) noexcept : index_(other.index_) {
  kOperations[index_].move(storage_, other.storage_);
}

template <class... Alternatives>
OneOfStorage<Types<Alternatives...>, false>& OneOfStorage<Types<Alternatives...>, false>::operator=(
    OneOfStorage other) noexcept {
  kOperations[index_].destroy(storage_);
  index_ = other.index_;
  kOperations[index_].move(storage_, other.storage_);
  return *this;
}

template <class... Alternatives>
OneOfStorage<Types<Alternatives...>, false>::~OneOfStorage() {
  kOperations[index_].destroy(storage_);
}

}  // namespace detail

template <class TheList>
class OneOf : public detail::OneOfStorage<TheList> {
  using Storage = detail::OneOfStorage<TheList>;

 public:
  using List = TheList;
  static_assert(List::kCount < 256);

  template <class T>
  requires(List::template kHas<std::remove_cvref_t<T>>) OneOf(T&& one)
      : Storage(List::template index_of<std::remove_cvref_t<T>>()) {
    ::new (address()) std::remove_cvref_t<T>(std::forward<T>(one));
  }
  // Makes a T of the arguments, in place.
  template <class T, class... Arguments>
  explicit OneOf(std::in_place_type_t<T>, Arguments&&... arguments) : Storage(List::template index_of<T>()) {
    ::new (address()) T(std::forward<Arguments>(arguments)...);
  }

  [[nodiscard]] std::size_t index() const REALTIME { return this->index_; }
  template <class T>
  [[nodiscard]] bool holds() const REALTIME {
    return this->index_ == List::template index_of<T>();
  }
  // The value, which must be a T.
  template <class T>
  [[nodiscard]] const T& get() const REALTIME {
    assert(holds<T>());
    return *static_cast<const T*>(address());
  }
  template <class T>
  [[nodiscard]] T& get() REALTIME {
    assert(holds<T>());
    return *static_cast<T*>(address());
  }
  // The value if it is a T, or nullptr.
  template <class T>
  [[nodiscard]] const T* get_if() const REALTIME {
    return holds<T>() ? &get<T>() : nullptr;
  }
  template <class T>
  [[nodiscard]] T* get_if() REALTIME {
    return holds<T>() ? &get<T>() : nullptr;
  }
  // The address of the value, whatever its type.
  [[nodiscard]] const void* address() const REALTIME { return this->storage_; }
  [[nodiscard]] void* address() REALTIME { return this->storage_; }
};

// Calls the visitor with the value. The visitor must accept every type of the list and return one type for all.
template <class Visitor, class First, class... Rest>
auto visit(Visitor&& visitor, const OneOf<Types<First, Rest...>>& one) {
  using Answer = decltype(visitor(one.template get<First>()));
  using Case = Answer (*)(Visitor&, const void*);
  static constexpr Case kCases[] = {&detail::call<Answer, Visitor, const First&, const void*>,
                                    &detail::call<Answer, Visitor, const Rest&, const void*>...};
  return kCases[one.index()](visitor, one.address());
}

template <class Visitor, class First, class... Rest>
auto visit(Visitor&& visitor, OneOf<Types<First, Rest...>>&& one) {
  using Answer = decltype(visitor(std::move(one.template get<First>())));
  using Case = Answer (*)(Visitor&, void*);
  static constexpr Case kCases[] = {&detail::call<Answer, Visitor, First&&, void*>,
                                    &detail::call<Answer, Visitor, Rest&&, void*>...};
  return kCases[one.index()](visitor, one.address());
}

// Calls the visitor with the value at `address`, whose type has the position `index` in the list. The compiler sees
// every call, so it can check and inline them.
template <class Visitor, class First, class... Rest>
auto visit_now(Visitor&& visitor, Types<First, Rest...>, std::size_t index, const void* address) REALTIME {
  using Answer = decltype(visitor(*static_cast<const First*>(address)));
  std::size_t place = 0;
  if constexpr (std::is_void_v<Answer>) {
    const auto visits = [&]<class One>(const One* one) REALTIME {
      if (place++ != index) return false;
      visitor(*one);
      return true;
    };
    static_cast<void>(visits(static_cast<const First*>(address)) || (visits(static_cast<const Rest*>(address)) || ...));
  } else {
    Answer answer{};
    const auto visits = [&]<class One>(const One* one) REALTIME {
      if (place++ != index) return false;
      answer = visitor(*one);
      return true;
    };
    static_cast<void>(visits(static_cast<const First*>(address)) || (visits(static_cast<const Rest*>(address)) || ...));
    return answer;
  }
}
template <class Visitor, class List>
auto visit_now(Visitor&& visitor, const OneOf<List>& one) REALTIME {
  return visit_now(visitor, List(), one.index(), one.address());
}

// One visitor of several function objects, usually lambdas.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace ringdown

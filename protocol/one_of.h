// OneOf: a value of one type of a list, as std::variant is, for lists of many types in headers that many files include.
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
// It compiles fast, because nothing in it recurses over the list, and because the functions that copy, move and
// destroy stand in one table for each list. A header with a long list declares `extern template class OneOf<List>;`,
// and one .cpp has `template class OneOf<List>;`: then this table is compiled once. [any thread]
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>

namespace ringdown::protocol {

template <class... Alternatives>
struct Types {
  static constexpr std::size_t kCount = sizeof...(Alternatives);
  template <class T>
  static constexpr bool kHas = (std::is_same_v<T, Alternatives> || ...);

  // The position of T in the list, which must have it.
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

template <class List>
class OneOf;

template <class... Alternatives>
class OneOf<Types<Alternatives...>> {
 public:
  using List = Types<Alternatives...>;
  static_assert(List::kCount < 256);

  template <class T>
  requires(List::template kHas<std::remove_cvref_t<T>>) OneOf(T&& one)
      : index_(List::template index_of<std::remove_cvref_t<T>>()) {
    ::new (address()) std::remove_cvref_t<T>(std::forward<T>(one));
  }
  // Makes a T of the arguments, in place.
  template <class T, class... Arguments>
  explicit OneOf(std::in_place_type_t<T>, Arguments&&... arguments) : index_(List::template index_of<T>()) {
    ::new (address()) T(std::forward<Arguments>(arguments)...);
  }
  OneOf(const OneOf& other);
  OneOf(OneOf&& other) noexcept;
  OneOf& operator=(OneOf other) noexcept;
  ~OneOf();

  [[nodiscard]] std::size_t index() const { return index_; }
  template <class T>
  [[nodiscard]] bool holds() const {
    return index_ == List::template index_of<T>();
  }
  // The value, which must be a T.
  template <class T>
  [[nodiscard]] const T& get() const {
    assert(holds<T>());
    return *static_cast<const T*>(address());
  }
  template <class T>
  [[nodiscard]] T& get() {
    assert(holds<T>());
    return *static_cast<T*>(address());
  }
  // The value if it is a T, or nullptr.
  template <class T>
  [[nodiscard]] const T* get_if() const {
    return holds<T>() ? &get<T>() : nullptr;
  }
  template <class T>
  [[nodiscard]] T* get_if() {
    return holds<T>() ? &get<T>() : nullptr;
  }
  // The address of the value, whatever its type.
  [[nodiscard]] const void* address() const { return storage_; }
  [[nodiscard]] void* address() { return storage_; }

 private:
  static const detail::Operations kOperations[List::kCount];

  alignas(Alternatives...) std::byte storage_[std::max({sizeof(Alternatives)...})];
  std::uint8_t index_;
};

template <class... Alternatives>
constexpr detail::Operations OneOf<Types<Alternatives...>>::kOperations[] = {
    {detail::copy<Alternatives>, detail::move<Alternatives>, detail::destroy<Alternatives>}...};

template <class... Alternatives>
OneOf<Types<Alternatives...>>::OneOf(const OneOf& other) : index_(other.index_) {
  kOperations[index_].copy(address(), other.address());
}

template <class... Alternatives>
OneOf<Types<Alternatives...>>::OneOf(OneOf&& other) noexcept : index_(other.index_) {
  kOperations[index_].move(address(), other.address());
}

template <class... Alternatives>
OneOf<Types<Alternatives...>>& OneOf<Types<Alternatives...>>::operator=(OneOf other) noexcept {
  kOperations[index_].destroy(address());
  index_ = other.index_;
  kOperations[index_].move(address(), other.address());
  return *this;
}

template <class... Alternatives>
OneOf<Types<Alternatives...>>::~OneOf() {
  kOperations[index_].destroy(address());
}

// Calls the visitor with the value. It must take every type of the list and return the same type for each.
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

// One visitor of several function objects, usually lambdas.
template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace ringdown::protocol

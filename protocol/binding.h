// How a row of the table reaches the members of its struct. Private to protocol/.
//
//   number<&Strike::contact_time_s>("contact_time", kContactTime, "How long the blow lasts.")
//
// is one argument: how it is described and checked, and the path of member pointers through which a checked
// value is written into a Request (or Reply) and read back. The same path serves both ways, so they cannot
// differ.
#pragma once

#include "protocol/names.h"
#include "protocol/schema.h"

#include <array>
#include <initializer_list>
#include <type_traits>

namespace ringdown::protocol {

// `Any` is Request or Reply.
template <class Any>
struct Binding {
  void (*write)(Any&, const Value&);
  Value (*read)(const Any&);
};

template <class Any>
struct Column {
  ArgumentSpec spec;
  Binding<Any> binding;
};
template <class Any>
using Columns = std::vector<Column<Any>>;

template <class Any>
struct Row {
  AddressSpec spec;
  std::vector<Binding<Any>> bindings;  // one for each of spec.arguments
  Any blank;                           // the struct with all members at their initialisers
};

const std::vector<Row<Request>>& request_rows();
const std::vector<Row<Reply>>& reply_rows();

// A range of numbers with its unit.
struct Quantity {
  std::string_view unit;
  double least, most;
};

namespace detail {

template <class Struct, class Member>
Struct owner_of(Member Struct::*);

template <class Struct, class Any>
inline constexpr bool is_alternative = false;
template <class Struct, class... Alternatives>
inline constexpr bool is_alternative<Struct, std::variant<Alternatives...>> = (std::is_same_v<Struct, Alternatives> ||
                                                                               ...);

template <class Struct>
using AnyOf = std::conditional_t<is_alternative<Struct, Request>, Request, Reply>;

inline Value to_value(double member) { return member; }
inline Value to_value(std::int32_t member) { return member; }
inline Value to_value(std::uint32_t member) { return static_cast<std::int32_t>(member); }
inline Value to_value(bool member) { return std::int32_t{member}; }
inline Value to_value(const std::string& member) { return member; }
inline Value to_value(const ObjectRef& member) { return member; }
inline Value to_value(const wire::Blob& member) { return member; }
template <class T>
Value to_value(const std::optional<T>& member) {
  return member ? to_value(*member) : Value();
}

inline void assign(double& member, const Value& value) { member = std::get<double>(value); }
inline void assign(std::int32_t& member, const Value& value) { member = std::get<std::int32_t>(value); }
inline void assign(std::uint32_t& member, const Value& value) {
  member = static_cast<std::uint32_t>(std::get<std::int32_t>(value));
}
inline void assign(bool& member, const Value& value) { member = std::get<std::int32_t>(value) != 0; }
inline void assign(std::string& member, const Value& value) { member = std::get<std::string>(value); }
inline void assign(ObjectRef& member, const Value& value) { member = std::get<ObjectRef>(value); }
inline void assign(wire::Blob& member, const Value& value) { member = std::get<wire::Blob>(value); }
template <class T>
void assign(std::optional<T>& member, const Value& value) {
  if (std::holds_alternative<std::monostate>(value)) return member.reset();
  assign(member.emplace(), value);
}

template <auto first, auto... rest>
auto bind(const ArgumentSpec& spec) {
  using Struct = decltype(owner_of(first));
  using Any = AnyOf<Struct>;
  const auto write = [](Any& any, const Value& value) { assign(((std::get<Struct>(any).*first).*....*rest), value); };
  const auto read = [](const Any& any) { return to_value(((std::get<Struct>(any).*first).*....*rest)); };
  return Columns<Any>{{spec, {write, read}}};
}

}  // namespace detail

// The kinds of argument a row is made of. Each names the member it fills.

template <auto... path>
auto number(std::string_view name, Quantity quantity, std::string_view sentence) {
  return detail::bind<path...>({name, ValueType::number, quantity.unit, quantity.least, quantity.most, sentence});
}

// Three numbers: the sentence stands at the first.
template <auto... path>
auto vector(std::array<std::string_view, 3> names, Quantity quantity, std::string_view sentence) {
  auto columns = number<path..., &Vec3::x>(names[0], quantity, sentence);
  columns.push_back(number<path..., &Vec3::y>(names[1], quantity, "Its y component.")[0]);
  columns.push_back(number<path..., &Vec3::z>(names[2], quantity, "Its z component.")[0]);
  return columns;
}

template <auto... path>
auto integer(std::string_view name, Quantity quantity, std::string_view sentence) {
  return detail::bind<path...>({name, ValueType::integer, quantity.unit, quantity.least, quantity.most, sentence});
}

// flag, text, name, object, object_or_none
template <ValueType type, auto... path>
auto other(std::string_view name, std::string_view sentence) {
  return detail::bind<path...>({name, type, "", 0, 1, sentence});
}

// `most` records of `bytes` each, and at least one.
template <auto... path>
auto records(std::string_view name, std::size_t bytes, std::size_t most, std::string_view sentence) {
  return detail::bind<path...>(
      {name, ValueType::blob, "", static_cast<double>(bytes), static_cast<double>(most), sentence});
}

// May be left out; it is then what the struct's own initialiser says.
template <class Any>
Columns<Any> optional(Columns<Any> columns) {
  for (Column<Any>& column : columns) column.spec.optional = true;
  return columns;
}

// The message that carries `any`, which is the row's struct.
template <class Any>
wire::Message format_row(const Row<Any>& row, const Any& any);

// A row that knows whose it is.
template <class Any, class Struct>
struct RowOf {
  Row<Any> row;
};

template <class Any, class Struct>
RowOf<Any, Struct> make_row(std::string_view address, std::string_view sentence,
                            std::initializer_list<Columns<Any>> groups, const Struct& example) {
  Row<Any> row{{.address = address, .sentence = sentence}, {}, Any(Struct{})};
  for (const Columns<Any>& group : groups) {
    for (const Column<Any>& column : group) {
      row.spec.arguments.push_back(column.spec);
      row.bindings.push_back(column.binding);
      if (column.spec.optional) row.spec.arguments.back().fallback = column.binding.read(row.blank);
    }
  }
  row.spec.example = format_row(row, Any(example));
  return {std::move(row)};
}

// The whole table.
template <class Any, class... Structs>
std::vector<Row<Any>> make_table(RowOf<Any, Structs>... rows) {
  static_assert(std::is_same_v<Any, std::variant<Structs...>>,
                "the table needs one row for each alternative of the variant, in their order");
  std::vector<Row<Any>> table;
  table.reserve(sizeof...(rows));
  (table.push_back(std::move(rows.row)), ...);
  return table;
}

}  // namespace ringdown::protocol

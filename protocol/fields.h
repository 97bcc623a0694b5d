// The arguments of a row of the table, each with the member that it fills. Private to protocol/.
//
//   number(&strike.contact_time_s, "contact_time", kContactTime, "How long the blow lasts.")
//
// is one argument: how it is described and checked, and where its member lies in the struct. Of the member only its
// offset and its type are kept, as data (Field). One function writes a checked value into any field and one reads it
// back, so that parsing and formatting cannot differ and no code is generated for a single member.
#pragma once

#include "protocol/names.h"
#include "protocol/schema.h"

#include <array>
#include <initializer_list>

namespace ringdown::protocol {

// The type of a member.
enum class Member : std::uint8_t {
  number,
  int32,
  uint32,
  optional_int32,
  flag,
  text,
  optional_text,
  object,
  optional_object,
  blob,
};
constexpr Member member_of(const double*) { return Member::number; }
constexpr Member member_of(const std::int32_t*) { return Member::int32; }
constexpr Member member_of(const std::uint32_t*) { return Member::uint32; }
constexpr Member member_of(const std::optional<std::int32_t>*) { return Member::optional_int32; }
constexpr Member member_of(const bool*) { return Member::flag; }
constexpr Member member_of(const std::string*) { return Member::text; }
constexpr Member member_of(const std::optional<std::string>*) { return Member::optional_text; }
constexpr Member member_of(const ObjectRef*) { return Member::object; }
constexpr Member member_of(const std::optional<ObjectRef>*) { return Member::optional_object; }
constexpr Member member_of(const wire::Blob*) { return Member::blob; }

// A member of a struct, and its value in the struct at `base`.
struct Field {
  std::size_t offset = 0;
  Member member = Member::number;

  [[nodiscard]] Value read(const void* base) const;
  // Takes only a value that convert() made for an argument of this member's type.
  void write(void* base, const Value& value) const;
  // As write(), for a number, a whole number, or an object by its number.
  void write_number(void* base, double number) const;
};

// A range of numbers with its unit.
struct Quantity {
  std::string_view unit;
  double min = 0, max = 1;
};

// An argument, and where its member lies in the struct that serves as the row's example.
struct Column {
  const void* at = nullptr;
  Member member = Member::number;
  ValueType type = ValueType::number;
  const char* name = "";
  const char* group = "";  // what several columns that fill one vector or rotation are called together
  Quantity quantity;
  const char* sentence = "";
  bool optional = false;
};

// One argument, or several that one member fills.
struct Columns {
  std::array<Column, 4> column;
  std::size_t count = 1;
};

// The kinds of argument a row is made of. Each takes the member that it fills.

Columns argument(const void* at, Member member, ValueType type, const char* name, const Quantity& quantity,
                 const char* sentence);

inline Columns number(const double* member, const char* name, const Quantity& quantity, const char* sentence) {
  return argument(member, Member::number, ValueType::number, name, quantity, sentence);
}

// One argument after the other.
Columns append(Columns columns, const Columns& more);

// The columns as one group.
Columns grouped(const char* group, Columns columns);

// Three numbers, of a vector or of a rotation's axis: the sentence stands at the first.
template <class Xyz>
requires(std::is_same_v<Xyz, Vec3> || std::is_same_v<Xyz, Rotation>) Columns
    vector(const Xyz* member, const char* group, const std::array<const char*, 3>& names, const Quantity& quantity,
           const char* sentence) {
  return grouped(group, append(append(number(&member->x, names[0], quantity, sentence),
                                      number(&member->y, names[1], quantity, "Its y component.")),
                               number(&member->z, names[2], quantity, "Its z component.")));
}

template <class Whole>
requires(std::is_same_v<Whole, std::int32_t> || std::is_same_v<Whole, std::uint32_t> ||
         std::is_same_v<Whole, std::optional<std::int32_t>>) Columns
    integer(const Whole* member, const char* name, const Quantity& quantity, const char* sentence) {
  return argument(member, member_of(member), ValueType::integer, name, quantity, sentence);
}

inline Columns flag(const bool* member, const char* name, const char* sentence) {
  return argument(member, Member::flag, ValueType::flag, name, {}, sentence);
}

template <class Text>
requires(std::is_same_v<Text, std::string> || std::is_same_v<Text, std::optional<std::string>>) Columns
    words(ValueType type, const Text* member, const char* name, const char* sentence) {
  return argument(member, member_of(member), type, name, {}, sentence);
}
Columns text(const auto* member, const char* name, const char* sentence) {
  return words(ValueType::text, member, name, sentence);
}
Columns any_text(const auto* member, const char* name, const char* sentence) {
  return words(ValueType::any_text, member, name, sentence);
}
Columns name(const auto* member, const char* name, const char* sentence) {
  return words(ValueType::name, member, name, sentence);
}

inline Columns object(const ObjectRef* member, const char* name, const char* sentence) {
  return argument(member, Member::object, ValueType::object, name, {}, sentence);
}

inline Columns object_or_none(const std::optional<ObjectRef>* member, const char* name, const char* sentence) {
  return argument(member, Member::optional_object, ValueType::object_or_none, name, {}, sentence);
}

// `max` records of `bytes` each, and at least one.
inline Columns records(const wire::Blob* member, const char* name, std::size_t bytes, std::size_t max,
                       const char* sentence) {
  return argument(member, Member::blob, ValueType::blob, name,
                  {"", static_cast<double>(bytes), static_cast<double>(max)}, sentence);
}

// May be left out; it is then what the struct's own initialiser says.
Columns optional(Columns columns);

struct Row {
  AddressSpec spec;
  std::vector<Field> fields;  // one for each of spec.arguments
};

// A row whose columns are members of the struct at `example`.
Row make_row(const void* example, const char* address, const char* sentence, std::initializer_list<Columns> columns,
             const char* reply = "", const char* number = "");

// The message that carries the struct at `base`, which is the row's. Requests have numbers as d, replies as f.
wire::Message format_row(const Row& row, const void* base);

// The rows of Requests or of Replies, in their order.
template <class List>
struct Table {
  std::vector<Row> rows;
  std::vector<OneOf<List>> blanks;  // for each row its struct with all members at their initialisers
};
const Table<Requests>& request_table();
const Table<Replies>& reply_table();

// Fills in what follows from the structs: the example's message, and what a left out argument is. The struct has
// `bytes`.
void complete(Row& row, const void* example, const void* blank, std::size_t bytes);

// `row_of` takes each struct of the list, returns its row and leaves the row's example in the struct. So a struct
// without a row does not compile.
template <class... Structs, class RowOf>
Table<Types<Structs...>> make_table(Types<Structs...>, RowOf row_of) {
  Table<Types<Structs...>> table;
  const auto add = [&]<class Struct>(Struct example) {
    const auto& blank = table.blanks.emplace_back(example);
    Row& row = table.rows.emplace_back(row_of(example));
    if constexpr (Requests::kHas<Struct>) row.spec.lane = kLaneOf<Struct>;
    complete(row, &example, blank.address(), sizeof(Struct));
  };
  (add(Structs()), ...);
  return table;
}

}  // namespace ringdown::protocol

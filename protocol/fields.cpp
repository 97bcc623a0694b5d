#include "protocol/fields.h"

#include <cassert>

namespace ringdown::protocol {
namespace {

template <class T>
Value value_of(const std::optional<T>& member) {
  return member ? Value(*member) : Value();
}

template <class T>
void assign(std::optional<T>& member, const Value& value) {
  if (const T* given = std::get_if<T>(&value)) {
    member = *given;
  } else {
    member.reset();
  }
}

}  // namespace

Value Field::read(const void* base) const {
  const void* const at = static_cast<const std::byte*>(base) + offset;
  switch (member) {
    case Member::number:
      return *static_cast<const double*>(at);
    case Member::int32:
      return *static_cast<const std::int32_t*>(at);
    case Member::uint32:
      return static_cast<std::int32_t>(*static_cast<const std::uint32_t*>(at));
    case Member::optional_int32:
      return value_of(*static_cast<const std::optional<std::int32_t>*>(at));
    case Member::flag:
      return std::int32_t{*static_cast<const bool*>(at)};
    case Member::text:
      return *static_cast<const std::string*>(at);
    case Member::optional_text:
      return value_of(*static_cast<const std::optional<std::string>*>(at));
    case Member::object:
      return *static_cast<const ObjectRef*>(at);
    case Member::optional_object:
      return value_of(*static_cast<const std::optional<ObjectRef>*>(at));
    case Member::blob:
      break;
  }
  return *static_cast<const wire::Blob*>(at);
}

void Field::write(void* base, const Value& value) const {
  void* const at = static_cast<std::byte*>(base) + offset;
  switch (member) {
    case Member::number:
      *static_cast<double*>(at) = std::get<double>(value);
      break;
    case Member::int32:
      *static_cast<std::int32_t*>(at) = std::get<std::int32_t>(value);
      break;
    case Member::uint32:
      *static_cast<std::uint32_t*>(at) = static_cast<std::uint32_t>(std::get<std::int32_t>(value));
      break;
    case Member::optional_int32:
      assign(*static_cast<std::optional<std::int32_t>*>(at), value);
      break;
    case Member::flag:
      *static_cast<bool*>(at) = std::get<std::int32_t>(value) != 0;
      break;
    case Member::text:
      *static_cast<std::string*>(at) = std::get<std::string>(value);
      break;
    case Member::optional_text:
      assign(*static_cast<std::optional<std::string>*>(at), value);
      break;
    case Member::object:
      *static_cast<ObjectRef*>(at) = std::get<ObjectRef>(value);
      break;
    case Member::optional_object:
      assign(*static_cast<std::optional<ObjectRef>*>(at), value);
      break;
    case Member::blob:
      *static_cast<wire::Blob*>(at) = std::get<wire::Blob>(value);
      break;
  }
}

void Field::write_number(void* base, double number) const {
  void* const at = static_cast<std::byte*>(base) + offset;
  if (member == Member::number) {
    *static_cast<double*>(at) = number;
  } else if (member == Member::uint32) {
    *static_cast<std::uint32_t*>(at) = static_cast<std::uint32_t>(number);
  } else if (member == Member::object) {
    static_cast<ObjectRef*>(at)->number = static_cast<std::uint32_t>(number);
  } else {
    write(base, static_cast<std::int32_t>(number));
  }
}

Columns argument(const void* at, Member member, ValueType type, const char* name, const Quantity& quantity,
                 const char* sentence) {
  Columns one;
  one.column[0] = {at, member, type, name, "", quantity, sentence, false};
  return one;
}

Columns append(Columns columns, const Columns& more) {
  for (std::size_t i = 0; i < more.count; ++i) columns.column[columns.count++] = more.column[i];
  return columns;
}

Columns grouped(const char* group, Columns columns) {
  for (std::size_t i = 0; i < columns.count; ++i) columns.column[i].group = group;
  return columns;
}

Columns optional(Columns columns) {
  for (std::size_t i = 0; i < columns.count; ++i) columns.column[i].optional = true;
  return columns;
}

Row make_row(const void* example, const char* address, const char* sentence, std::initializer_list<Columns> columns,
             const char* reply, const char* number) {
  Row row{{.address = address, .sentence = sentence, .reply = reply, .reply_number = number}, {}};
  for (const Columns& group : columns) {
    for (std::size_t i = 0; i < group.count; ++i) {
      const Column& c = group.column[i];
      row.spec.arguments.push_back(
          {c.name, c.group, c.type, c.quantity.unit, c.quantity.min, c.quantity.max, c.sentence, c.optional, {}});
      const auto offset = static_cast<const std::byte*>(c.at) - static_cast<const std::byte*>(example);
      row.fields.push_back({static_cast<std::size_t>(offset), c.member});
    }
  }
  return row;
}

void complete(Row& row, const void* example, const void* blank, [[maybe_unused]] std::size_t bytes) {
  for (std::size_t i = 0; i < row.fields.size(); ++i) {
    assert(row.fields[i].offset < bytes && "every member is one of the row's own struct");
    ArgumentSpec& argument = row.spec.arguments[i];
    if (argument.optional) argument.fallback = row.fields[i].read(blank);
  }
  row.spec.example = format_row(row, example);
}

}  // namespace ringdown::protocol

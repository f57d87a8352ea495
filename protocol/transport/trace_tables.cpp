// SPDX-License-Identifier: MIT
#include "protocol/transport/trace_tables.h"

#include <cstddef>

namespace protocol {
namespace {

using hdf5::check;
using hdf5::Handle;

Handle vector_type() {
  const hsize_t three = 3;
  return {H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &three), H5Tclose, "make a vector type"};
}

struct Field {
  const char* name;
  std::size_t offset;
  hid_t type;
};

Handle compound(std::size_t size, std::initializer_list<Field> fields) {
  Handle type(H5Tcreate(H5T_COMPOUND, size), H5Tclose, "make a row type");
  for (const auto& f : fields)
    check(H5Tinsert(type, f.name, f.offset, f.type), std::string("add field ") + f.name);
  return type;
}

}  // namespace

template <>
Handle row_type<State>() {
  const Handle vec = vector_type();
  return compound(sizeof(State), {{"id", offsetof(State, id), H5T_NATIVE_INT64},
                                  {"x", offsetof(State, x), vec},
                                  {"v", offsetof(State, v), vec},
                                  {"omega", offsetof(State, omega), vec}});
}
template <>
Handle row_type<Shape>() {
  return compound(sizeof(Shape), {{"id", offsetof(Shape, id), H5T_NATIVE_INT64},
                                  {"radius", offsetof(Shape, radius), H5T_NATIVE_DOUBLE},
                                  {"mass", offsetof(Shape, mass), H5T_NATIVE_DOUBLE},
                                  {"inertia", offsetof(Shape, inertia), H5T_NATIVE_DOUBLE},
                                  {"type", offsetof(Shape, type), H5T_NATIVE_INT64},
                                  {"epoch", offsetof(Shape, epoch), H5T_NATIVE_INT64},
                                  {"carrier", offsetof(Shape, carrier), H5T_NATIVE_INT64},
                                  {"volume", offsetof(Shape, volume), H5T_NATIVE_DOUBLE}});
}
template <>
Handle row_type<Load>() {
  const Handle vec = vector_type();
  return compound(sizeof(Load), {{"id", offsetof(Load, id), H5T_NATIVE_INT64},
                                 {"force", offsetof(Load, force), vec},
                                 {"torque", offsetof(Load, torque), vec}});
}
template <>
Handle row_type<FrameRow>() {
  const Handle vec = vector_type();
  return compound(sizeof(FrameRow),
                  {{"interval", offsetof(FrameRow, interval), H5T_NATIVE_INT64},
                   {"time", offsetof(FrameRow, time), H5T_NATIVE_DOUBLE},
                   {"wall_clock", offsetof(FrameRow, wall_clock), H5T_NATIVE_DOUBLE},
                   {"direction", offsetof(FrameRow, direction), H5T_NATIVE_UINT32},
                   {"kind", offsetof(FrameRow, kind), H5T_NATIVE_UINT32},
                   {"remote", offsetof(FrameRow, remote), H5T_NATIVE_INT32},
                   {"flags", offsetof(FrameRow, flags), H5T_NATIVE_UINT32},
                   {"first", offsetof(FrameRow, first), H5T_NATIVE_UINT64},
                   {"count", offsetof(FrameRow, count), H5T_NATIVE_UINT64},
                   {"shape_first", offsetof(FrameRow, shape_first), H5T_NATIVE_UINT64},
                   {"shape_count", offsetof(FrameRow, shape_count), H5T_NATIVE_UINT64},
                   {"step", offsetof(FrameRow, setting.step), H5T_NATIVE_DOUBLE},
                   {"box_lo", offsetof(FrameRow, setting.box_lo), vec},
                   {"box_hi", offsetof(FrameRow, setting.box_hi), vec}});
}
template <>
Handle row_type<std::byte>() {
  return {H5Tcopy(H5T_NATIVE_UINT8), H5Tclose, "make a byte type"};
}

template <class Row>
Table<Row> Table<Row>::create(hid_t file, const std::string& name, std::uint64_t chunk) {
  const hsize_t none = 0, unlimited = H5S_UNLIMITED, rows = chunk;
  const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose, "make a space");
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
  check(H5Pset_chunk(properties, 1, &rows), "set a chunk size");
  Handle type = row_type<Row>();
  Handle data(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
              H5Dclose, "create table " + name);
  return {std::move(data), std::move(type)};
}

template <class Row>
Table<Row> Table<Row>::open(hid_t file, const std::string& name) {
  Table table{{H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "find table " + name},
              row_type<Row>()};
  table.stored_ = hdf5::size_that_fits(table.data_, sizeof(Row), name);
  return table;
}

template <class Row>
void Table<Row>::append(std::span<const Row> rows) {
  pending_.insert(pending_.end(), rows.begin(), rows.end());
}

template <class Row>
void Table<Row>::flush() {
  if (pending_.empty()) return;
  const hsize_t first = stored_, count = pending_.size(), size = first + count;
  check(H5Dset_extent(data_, &size), "grow a table");
  const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose, "make a space");
  const Handle place(H5Dget_space(data_), H5Sclose, "read a space");
  check(H5Sselect_hyperslab(place, H5S_SELECT_SET, &first, nullptr, &count, nullptr), "select");
  check(H5Dwrite(data_, type_, memory, place, H5P_DEFAULT, pending_.data()),
        "write a table (is the disk full?)");
  check(H5Dflush(data_), "flush a table (is the disk full?)");
  stored_ = size;
  pending_.clear();
}

template <class Row>
std::vector<Row> Table<Row>::read_all() const {
  std::vector<Row> rows(stored_);
  if (stored_)
    check(H5Dread(data_, type_, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), "read a table");
  return rows;
}

template class Table<State>;
template class Table<Shape>;
template class Table<Load>;
template class Table<FrameRow>;
template class Table<std::byte>;

}  // namespace protocol

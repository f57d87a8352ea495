// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/cell_set.h"

#include <filesystem>
#include <memory>
#include <stdexcept>

namespace lbm {

using protocol::hdf5::check;
using protocol::hdf5::Handle;

namespace {

/// Selects the cells of a piece in a data set. @return the space of the piece in memory
Handle select(hid_t space, const CellLayout& layout, const CellRange& piece) {
  const std::vector<hsize_t> from = layout.of(piece.begin, 0);
  const std::vector<hsize_t> count = layout.of(piece.size, static_cast<hsize_t>(layout.components));
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr),
        "select cells");
  return {H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose,
          "make a space"};
}

}  // namespace

std::vector<hsize_t> CellLayout::of(const Cell3& cells, hsize_t last) const {
  std::vector<hsize_t> n;
  for (int a = dimension - 1; a >= 0; --a) n.push_back(static_cast<hsize_t>(cells[a]));
  if (components > 0) n.push_back(last);
  return n;
}

CellSet::CellSet(hid_t group, const std::string& name, hid_t file_type, const CellLayout& layout)
    : name_(name), layout_(layout) {
  const std::vector<hsize_t> shape = layout.shape();
  space_ = Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
                  "make a space");
  const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "make properties");
  check(H5Pset_obj_track_times(how, 0), "set properties");  // equal states are equal files
  set_ = Handle(H5Dcreate2(group, name.c_str(), file_type, space_, H5P_DEFAULT, how, H5P_DEFAULT),
                H5Dclose, "create " + name);
}

void CellSet::write(const CellRange& piece, hid_t type, const void* numbers) const {
  const Handle memory = select(space_, layout_, piece);
  check(H5Dwrite(set_, type, memory, space_, H5P_DEFAULT, numbers),
        "write " + name_ + " (is the disk full?)");
}

void write_values(hid_t group, const std::string& name, const CellValues& values,
                  const Decomposition* ranks) {
  std::unique_ptr<CellSet> set;
  const Domain box{values.box[0], values.box[1], Side::Wall, Side::Wall, values.box[2]};
  const Decomposition alone(box);
  if (!ranks) ranks = &alone;
  if (ranks->rank() == 0)
    set =
        std::make_unique<CellSet>(group, name, values.single ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE,
                                  CellLayout{values.box, 3, values.components});
  ranks->in_pieces<double>(values.components, values.read,
                           [&](const CellRange& piece, std::span<const double> numbers) {
                             set->write(piece, H5T_NATIVE_DOUBLE, numbers.data());
                           });
}

bool has_cells(hid_t set) {
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  return H5Sget_simple_extent_ndims(space) == 4;
}

CellValues values_in(hid_t set, const std::string& path, const std::string& inside) {
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  const Handle type(H5Dget_type(set), H5Tclose, "read the type of " + inside);
  hsize_t n[4] = {0, 0, 0, 0};
  if (H5Sget_simple_extent_ndims(space) != 4 || H5Tget_class(type) != H5T_FLOAT)
    throw std::runtime_error(inside + " are no numbers of cells");
  check(H5Sget_simple_extent_dims(space, n, nullptr), "read the size of " + inside);
  double bytes = static_cast<double>(H5Tget_size(type));
  for (const hsize_t length : n) bytes *= static_cast<double>(length);
  if (bytes > static_cast<double>(std::filesystem::file_size(path)))
    throw std::runtime_error(inside + " claims more cells than the file can hold");
  CellValues values;
  values.box = {static_cast<int>(n[2]), static_cast<int>(n[1]), static_cast<int>(n[0])};
  values.components = static_cast<int>(n[3]);
  values.single = H5Tget_size(type) == sizeof(float);
  values.here = {{0, 0, 0}, values.box};
  values.read = [path, inside, layout = CellLayout{values.box, 3, values.components}](
                    const CellRange& piece, std::span<double> to) {
    const Handle file = protocol::hdf5::open_file(path, protocol::hdf5::Open::Read);
    const Handle data(H5Dopen2(file, inside.c_str(), H5P_DEFAULT), H5Dclose, "open " + inside);
    const Handle all(H5Dget_space(data), H5Sclose, "read a space");
    const Handle memory = select(all, layout, piece);
    check(H5Dread(data, H5T_NATIVE_DOUBLE, memory, all, H5P_DEFAULT, to.data()), "read " + inside);
  };
  return values;
}

void write_fields(hid_t group, const CellFields& fields, int dimension,
                  const Decomposition& ranks) {
  if (ranks.rank() != 0) return send_fields(fields, ranks);
  std::vector<std::unique_ptr<CellSet>> sets;
  for (const CellField& field : fields.fields) {
    const CellLayout layout{ranks.domain().cells(), dimension,
                            field.components > 1 ? field.components : 0};
    sets.push_back(std::make_unique<CellSet>(group, field.name, H5T_NATIVE_FLOAT, layout));
    protocol::hdf5::set_attribute(sets.back()->id(), "unit", std::string(field.unit));
  }
  ranks.in_pieces<float>(
      fields.components(), fields.make, [&](const CellRange& piece, std::span<const float> all) {
        const float* from = all.data();
        for (std::size_t k = 0; k < sets.size(); ++k) {
          sets[k]->write(piece, H5T_NATIVE_FLOAT, from);
          from += piece.count() * static_cast<std::size_t>(fields.fields[k].components);
        }
      });
}

}  // namespace lbm

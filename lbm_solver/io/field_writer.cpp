// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/field_writer.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "protocol/hdf5_file.h"

namespace lbm {
namespace {

using protocol::hdf5::check;
using protocol::hdf5::Handle;
using protocol::hdf5::Open;

template <class T>
hid_t memory_type();
template <>
hid_t memory_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t memory_type<double>() {
  return H5T_NATIVE_DOUBLE;
}

template <class T>
void write_array(hid_t group, const char* name, const std::vector<T>& data,
                 const std::vector<hsize_t>& shape) {
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose, "make a space");
  const Handle set(
      H5Dcreate2(group, name, memory_type<T>(), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, std::string("create ") + name);
  if (data.empty()) return;
  check(H5Dwrite(set, memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()),
        std::string("write ") + name + " (is the disk full?)");
}

std::string group_name(std::size_t index) {
  return fmt::format("frame{:06}", index);
}

}  // namespace

FieldWriter::FieldWriter(const std::string& folder, const Units& units, int dimension,
                         double keep_until)
    : folder_(folder), units_(units), dimension_(dimension) {
  if (keep_until > 0.0 && keep_frames(keep_until)) return;
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Create);
  protocol::hdf5::set_attribute(file, "cell", units.dx);
  protocol::hdf5::set_attribute(file, "origin_x", units.origin.x());
  protocol::hdf5::set_attribute(file, "origin_y", units.origin.y());
  if (dimension == 3) protocol::hdf5::set_attribute(file, "origin_z", units.origin.z());
}

/// Finds the frames of the run before; those from `until` on are written again.
/// @return false where they cannot be read: a kill while a frame was being written; they are put
/// aside
bool FieldWriter::keep_frames(double until) {
  const std::string path = folder_ + "/fields.h5";
  std::string aside = folder_ + "/fields-cut-off.h5";
  for (int k = 2; std::filesystem::exists(aside); ++k)  // each kill may leave one
    aside = fmt::format("{}/fields-cut-off-{}.h5", folder_, k);
  if (!std::filesystem::exists(path)) return false;
  Handle file;
  try {
    file = protocol::hdf5::open_file(path, Open::Append);
  } catch (const std::runtime_error&) {
    fmt::print(stderr,
               "lbm | warning | {} was cut off in the middle of a frame: it is kept as {}, and the "
               "frames from here on go to a new one\n",
               path, aside);
    std::filesystem::rename(path, aside);
    return false;
  }
  for (;;) {
    const std::string name = group_name(entries_.size());
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return true;
    const Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "open " + name);
    const double time = protocol::hdf5::real_attribute(group, "time");
    if (time >= until) break;
    const auto rows = [&](const char* name) -> std::array<hsize_t, 3> {
      if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return {0, 0, 0};
      const Handle set(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, std::string("open ") + name);
      const Handle space(H5Dget_space(set), H5Sclose, "read a space");
      std::array<hsize_t, 3> shape{0, 0, 0};
      check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a size");
      return shape;
    };
    const auto cells = rows("pressure");
    const auto along = [&](int axis) {  // x last
      return axis < dimension_ ? static_cast<int>(cells[dimension_ - 1 - axis]) : 1;
    };
    entries_.push_back({time, along(0), along(1), along(2), rows("solid_fraction")[0] > 0,
                        rows("particles")[0], rows("bond_state")[0]});
  }
  for (std::size_t i = entries_.size();; ++i) {
    const std::string name = group_name(i);
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return true;
    check(H5Ldelete(file, name.c_str(), H5P_DEFAULT), "drop " + name);
  }
}

void FieldWriter::write(const FieldFrame& f) {
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Append);
  const std::string name = group_name(entries_.size());
  const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose, "create " + name);
  protocol::hdf5::set_attribute(group, "time", f.time);
  const auto d = static_cast<std::size_t>(dimension_);
  const std::size_t count = f.particles.size() / columns(), bonds = f.bond_state.size();
  const Entry entry{f.time, f.nx, f.ny, f.nz, !f.solid_fraction.empty(), count, bonds};
  std::vector<hsize_t> cells;
  for (const auto n : shape(entry)) cells.push_back(n);
  std::vector<hsize_t> vectors = cells;
  vectors.push_back(3);
  write_array(group, "pressure", f.pressure, cells);
  write_array(group, "velocity", f.velocity, vectors);
  if (entry.solids) write_array(group, "solid_fraction", f.solid_fraction, cells);
  write_array(group, "particles", f.particles, {count, columns()});
  if (bonds > 0) {
    write_array(group, "bond_ends", f.bond_ends, {2 * bonds, d});
    write_array(group, "bond_state", f.bond_state, {bonds});
  }
  if (!f.particles.empty()) {  // by columns, as ParaView wants them
    std::vector<double> places, radius;
    for (const double* p = f.particles.data(); radius.size() < count; p += columns()) {
      places.insert(places.end(), p + 1, p + 1 + d);
      radius.push_back(p[1 + d]);
    }
    write_array(group, "particle_places", places, {radius.size(), d});
    write_array(group, "particle_radius", radius, {radius.size()});
  }
  entries_.push_back(entry);
  write_xdmf();
}

/// Cells of a frame, x last.
std::vector<unsigned long long> FieldWriter::shape(const Entry& e) const {
  std::vector<unsigned long long> n;
  if (dimension_ == 3) n.push_back(e.nz);
  n.push_back(e.ny);
  n.push_back(e.nx);
  return n;
}

/// The same as text, each number larger by `more`.
std::string FieldWriter::shape_text(const Entry& e, int more) const {
  std::string text;
  for (const auto n : shape(e)) text += fmt::format("{}{}", text.empty() ? "" : " ", n + more);
  return text;
}

namespace {

/// A reference to an array of the file, as an XDMF item.
std::string item(const std::string& path, const std::string& shape, int precision) {
  return fmt::format(
      R"(<DataItem Format="HDF" NumberType="Float" Precision="{}" Dimensions="{}">fields.h5:/{}</DataItem>)",
      precision, shape, path);
}

}  // namespace

std::string FieldWriter::fluid_grid(std::size_t index) const {
  const Entry& e = entries_[index];
  std::string origin, spacing;
  for (int axis = dimension_ - 1; axis >= 0; --axis) {
    origin += fmt::format("{:.9g} ", units_.origin[axis]);
    spacing += fmt::format("{:.9g} ", units_.dx);
  }
  std::string out = fmt::format(
      R"(<Grid><Time Value="{:.9g}"/>
  <Topology TopologyType="{}DCoRectMesh" Dimensions="{}"/>
  <Geometry GeometryType="{}"><DataItem Format="XML" Dimensions="{}">{}</DataItem>)"
      R"(<DataItem Format="XML" Dimensions="{}">{}</DataItem></Geometry>
)",
      e.time, dimension_, shape_text(e, 1), dimension_ == 2 ? "ORIGIN_DXDY" : "ORIGIN_DXDYDZ",
      dimension_, origin, dimension_, spacing);
  const auto attribute = [&](const char* name, const char* kind, const std::string& shape) {
    out += fmt::format(
        "  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Cell\">{}</Attribute>\n", name,
        kind, item(group_name(index) + "/" + name, shape, 4));
  };
  attribute("pressure", "Scalar", shape_text(e, 0));
  attribute("velocity", "Vector", shape_text(e, 0) + " 3");
  if (e.solids) attribute("solid_fraction", "Scalar", shape_text(e, 0));
  return out + "</Grid>\n";
}

std::string FieldWriter::particle_grid(std::size_t index) const {
  const Entry& e = entries_[index];
  const std::string group = group_name(index), n = fmt::format("{}", e.particles);
  return fmt::format(
      "<Grid><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"Polyvertex\" "
      "NumberOfElements=\"{}\"/>\n  <Geometry GeometryType=\"{}\">{}</Geometry>\n"
      "  <Attribute Name=\"radius\" Center=\"Node\">{}</Attribute>\n</Grid>\n",
      e.time, n, dimension_ == 2 ? "XY" : "XYZ",
      item(group + "/particle_places", fmt::format("{} {}", n, dimension_), 8),
      item(group + "/particle_radius", n, 8));
}

std::string FieldWriter::bond_grid(std::size_t index) const {
  const Entry& e = entries_[index];
  const std::string group = group_name(index);
  std::string nodes;
  for (std::size_t i = 0; i < e.bonds; ++i) nodes += fmt::format("{} {} ", 2 * i, 2 * i + 1);
  return fmt::format(
      "<Grid><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"Polyline\" NodesPerElement=\"2\" "
      "NumberOfElements=\"{}\"><DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"{} 2\">{}"
      "</DataItem></Topology>\n  <Geometry GeometryType=\"{}\">{}</Geometry>\n"
      "  <Attribute Name=\"broken\" Center=\"Cell\">{}</Attribute>\n</Grid>\n",
      e.time, e.bonds, e.bonds, nodes, dimension_ == 2 ? "XY" : "XYZ",
      item(group + "/bond_ends", fmt::format("{} {}", 2 * e.bonds, dimension_), 8),
      item(group + "/bond_state", fmt::format("{}", e.bonds), 8));
}

/// Three timelines: the fluid, the particles and the bonds, the latter two where there are any.
void FieldWriter::write_xdmf() const {
  std::ofstream out(folder_ + "/fields.xdmf");
  out << "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n";
  const auto timeline = [&](const char* name, const auto& present, const auto& grid) {
    std::string grids;
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (present(entries_[i])) grids += grid(i);
    if (!grids.empty())
      out << fmt::format(
          "<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}</Grid>\n",
          name, grids);
  };
  timeline(
      "fluid", [](const Entry&) { return true; }, [&](std::size_t i) { return fluid_grid(i); });
  timeline(
      "particles", [](const Entry& e) { return e.particles > 0; },
      [&](std::size_t i) { return particle_grid(i); });
  timeline(
      "bonds", [](const Entry& e) { return e.bonds > 0; },
      [&](std::size_t i) { return bond_grid(i); });
  out << "</Domain></Xdmf>\n";
}

}  // namespace lbm

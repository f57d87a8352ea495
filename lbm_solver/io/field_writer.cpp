// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/field_writer.h"

#include <fmt/format.h>

#include <cstdio>
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

FieldWriter::FieldWriter(const std::string& folder, const Units& units, double keep_until)
    : folder_(folder), units_(units) {
  if (keep_until > 0.0) {
    keep_frames(keep_until);
    return;
  }
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Create);
  protocol::hdf5::set_attribute(file, "cell", units.dx);
  protocol::hdf5::set_attribute(file, "origin_x", units.origin.x());
  protocol::hdf5::set_attribute(file, "origin_y", units.origin.y());
}

/// Finds the frames of the run before; those from `until` on are written again.
void FieldWriter::keep_frames(double until) {
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Append);
  for (;;) {
    const std::string name = group_name(entries_.size());
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return;
    const Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "open " + name);
    const double time = protocol::hdf5::real_attribute(group, "time");
    if (time >= until) break;
    const Handle set(H5Dopen2(group, "pressure", H5P_DEFAULT), H5Dclose, "open pressure");
    const Handle space(H5Dget_space(set), H5Sclose, "read a space");
    hsize_t shape[2];
    check(H5Sget_simple_extent_dims(space, shape, nullptr), "read a size");
    entries_.push_back({time, static_cast<int>(shape[1]), static_cast<int>(shape[0]),
                        H5Lexists(group, "solid_fraction", H5P_DEFAULT) > 0});
  }
  for (std::size_t i = entries_.size();; ++i) {
    const std::string name = group_name(i);
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return;
    check(H5Ldelete(file, name.c_str(), H5P_DEFAULT), "drop " + name);
  }
}

void FieldWriter::write(const FieldFrame& f) {
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Append);
  const std::string name = group_name(entries_.size());
  const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose, "create " + name);
  protocol::hdf5::set_attribute(group, "time", f.time);
  const hsize_t nx = f.nx, ny = f.ny;
  write_array(group, "pressure", f.pressure, {ny, nx});
  write_array(group, "velocity", f.velocity, {ny, nx, 3});
  if (!f.solid_fraction.empty()) write_array(group, "solid_fraction", f.solid_fraction, {ny, nx});
  write_array(group, "particles", f.particles, {f.particles.size() / 8, 8});
  entries_.push_back({f.time, f.nx, f.ny, !f.solid_fraction.empty()});
  write_xdmf();
}

void FieldWriter::write_xdmf() const {
  std::ofstream out(folder_ + "/fields.xdmf");
  out << R"(<?xml version="1.0"?>
<Xdmf Version="3.0"><Domain><Grid Name="fluid" GridType="Collection" CollectionType="Temporal">
)";
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& e = entries_[i];
    const auto attribute = [&](const char* name, const char* kind, const std::string& shape) {
      out << fmt::format(
          R"(  <Attribute Name="{0}" AttributeType="{1}" Center="Cell"><DataItem Format="HDF" )"
          R"(NumberType="Float" Precision="4" Dimensions="{2}">fields.h5:/{3}/{0}</DataItem></Attribute>)"
          "\n",
          name, kind, shape, group_name(i));
    };
    out << fmt::format(
        R"(<Grid><Time Value="{:.9g}"/>
  <Topology TopologyType="2DCoRectMesh" Dimensions="{} {}"/>
  <Geometry GeometryType="ORIGIN_DXDY"><DataItem Format="XML" Dimensions="2">{:.9g} {:.9g}</DataItem>)"
        R"(<DataItem Format="XML" Dimensions="2">{:.9g} {:.9g}</DataItem></Geometry>
)",
        e.time, e.ny + 1, e.nx + 1, units_.origin.y(), units_.origin.x(), units_.dx, units_.dx);
    attribute("pressure", "Scalar", fmt::format("{} {}", e.ny, e.nx));
    attribute("velocity", "Vector", fmt::format("{} {} 3", e.ny, e.nx));
    if (e.solids) attribute("solid_fraction", "Scalar", fmt::format("{} {}", e.ny, e.nx));
    out << "</Grid>\n";
  }
  out << "</Grid></Domain></Xdmf>\n";
}

}  // namespace lbm

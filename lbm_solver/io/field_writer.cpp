// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/field_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "lbm_solver/io/cell_set.h"
#include "lbm_solver/io/hdf5_array.h"
#include "lbm_solver/io/view_script.h"
#include "protocol/transport/hdf5_file.h"
#include "protocol/wire/clumps.h"

namespace lbm {
namespace {

using protocol::hdf5::check;
using protocol::hdf5::Handle;
using protocol::hdf5::Open;

/// What ParaView shows of each particle beside its place and radius.
struct PointValue {
  const char *name, *unit;
  int components;
  void (*append)(std::vector<double>& to, const protocol::Particle& p, const protocol::Load& load);
};
void append(std::vector<double>& to, const protocol::Vec3& v) {
  to.insert(to.end(), v.begin(), v.end());
}
using Values = std::vector<double>;
using protocol::Load;
using protocol::Particle;
constexpr std::array kPointValues{
    PointValue{"id", "1", 1,
               [](Values& to, const Particle& p, const Load&) {
                 to.push_back(static_cast<double>(p.state.id));
               }},
    PointValue{"type", "1", 1,
               [](Values& to, const Particle& p, const Load&) {
                 to.push_back(static_cast<double>(p.shape.type));
               }},
    PointValue{"radius", "m", 1,
               [](Values& to, const Particle& p, const Load&) { to.push_back(p.shape.radius); }},
    PointValue{"velocity", "m/s", 3,
               [](Values& to, const Particle& p, const Load&) { append(to, p.state.v); }},
    PointValue{"angular_velocity", "rad/s", 3,
               [](Values& to, const Particle& p, const Load&) { append(to, p.state.omega); }},
    PointValue{"force", "N", 3,
               [](Values& to, const Particle&, const Load& l) { append(to, l.force); }},
    PointValue{"torque", "N m", 3,
               [](Values& to, const Particle&, const Load& l) { append(to, l.torque); }},
};

/// A row of the table of particles.
void append_row(std::vector<double>& to, const Particle& p, bool flat) {
  const auto& [s, shape] = p;
  const auto id = static_cast<double>(s.id), type = static_cast<double>(shape.type);
  if (flat)
    to.insert(to.end(), {id, s.x[0], s.x[1], shape.radius, s.v[0], s.v[1], s.omega[2], type});
  else
    to.insert(to.end(), {id, s.x[0], s.x[1], s.x[2], shape.radius, s.v[0], s.v[1], s.v[2],
                         s.omega[0], s.omega[1], s.omega[2], type});
}

/// Sizes of a data set of a frame that was written before; 0 where there is none.
std::array<hsize_t, 3> shape_of(hid_t group, const char* name) {
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return {0, 0, 0};
  const Handle set(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose, std::string("open ") + name);
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  std::array<hsize_t, 3> shape{0, 0, 0};
  check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a size");
  return shape;
}

/// States of the bonds of a frame that was written before.
std::vector<double> bond_states(hid_t group) {
  if (H5Lexists(group, "bond_state", H5P_DEFAULT) <= 0) return {};
  const Handle set(H5Dopen2(group, "bond_state", H5P_DEFAULT), H5Dclose, "open bond_state");
  const Handle space(H5Dget_space(set), H5Sclose, "read a space");
  std::vector<double> states(H5Sget_simple_extent_npoints(space));
  check(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, states.data()),
        "read bond_state");
  return states;
}

bool has_clumps(const FieldFrame& f) {
  return std::ranges::any_of(f.particles, [](const Particle& p) { return is_part(p.shape); });
}

std::string group_name(std::size_t index) {
  return fmt::format("frame{:06}", index);
}

/// The table of particles, and by columns, as ParaView wants them.
void write_particles(hid_t group, const FieldFrame& f, int dimension) {
  const bool flat = dimension == 2;
  const std::size_t count = f.particles.size();
  std::vector<double> table, places;
  for (const Particle& p : f.particles) {
    append_row(table, p, flat);
    places.insert(places.end(), p.state.x.begin(), p.state.x.begin() + dimension);
  }
  write_array(group, "particles", table, {count, flat ? hsize_t{8} : hsize_t{12}},
              flat ? "1,m,m,m,m/s,m/s,rad/s,1" : "1,m,m,m,m,m/s,m/s,m/s,rad/s,rad/s,rad/s,1",
              flat ? "id,x,y,radius,vx,vy,omega,type"
                   : "id,x,y,z,radius,vx,vy,vz,omega_x,omega_y,omega_z,type");
  if (count == 0) return;
  std::vector<double> carriers;
  for (const Particle& p : f.particles)
    carriers.push_back(static_cast<double>(protocol::carrier_of(p.shape)));
  if (has_clumps(f)) write_array(group, "particle_carrier", carriers, {count}, "1");
  write_array(group, "particle_places", places, {count, static_cast<hsize_t>(dimension)}, "m");
  for (const PointValue& value : kPointValues) {
    std::vector<double> column;
    for (std::size_t i = 0; i < count; ++i) value.append(column, f.particles[i], f.loads[i]);
    std::vector<hsize_t> shape{count};
    if (value.components > 1) shape.push_back(value.components);
    write_array(group, (std::string("particle_") + value.name).c_str(), column, shape, value.unit);
  }
}

}  // namespace

FieldWriter::FieldWriter(const std::string& folder, const Units& units, int dimension,
                         double keep_until, ShownObstacles obstacles)
    : folder_(folder), units_(units), dimension_(dimension), obstacles_(std::move(obstacles)) {
  write_view();
  if (keep_until > 0.0 && keep_frames(keep_until)) return;
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Create);
  protocol::hdf5::set_attribute(file, "cell", units.dx);
  protocol::hdf5::set_attribute(file, "unit of cell and origin", std::string("m"));
  protocol::hdf5::set_attribute(file, "unit of time", std::string("s"));
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
    const auto cells = shape_of(group, "pressure");
    const auto along = [&](int axis) {  // x last
      return axis < dimension_ ? static_cast<int>(cells[dimension_ - 1 - axis]) : 1;
    };
    entries_.push_back(
        {time, along(0), along(1), along(2), shape_of(group, "solid_fraction")[0] > 0,
         shape_of(group, "viscosity")[0] > 0, shape_of(group, "image_fraction")[0] > 0,
         shape_of(group, "particle_carrier")[0] > 0, shape_of(group, "particles")[0],
         bond_states(group)});
    if (entries_.size() == 1 && !obstacles_.lie_in(group)) obstacles_ = {};
  }
  for (std::size_t i = entries_.size();; ++i) {
    const std::string name = group_name(i);
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return true;
    check(H5Ldelete(file, name.c_str(), H5P_DEFAULT), "drop " + name);
  }
}

void FieldWriter::write(const FieldFrame& f, const Decomposition& ranks) {
  const Handle file = protocol::hdf5::open_file(folder_ + "/fields.h5", Open::Append);
  const std::string name = group_name(entries_.size());
  const Handle group(H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose, "create " + name);
  protocol::hdf5::set_attribute(group, "time", f.time);
  for (int k = 0; f.flux && k < dimension_; ++k)
    protocol::hdf5::set_attribute(group, std::string("flux_") + "xyz"[k], (*f.flux)[k]);
  const std::size_t bonds = f.bond_state.size();
  const Cell3 n = ranks.domain().cells();
  const Entry entry{f.time,
                    n[0],
                    n[1],
                    n[2],
                    f.cells.has("solid_fraction"),
                    f.cells.has("viscosity"),
                    f.cells.has("image_fraction"),
                    has_clumps(f),
                    f.particles.size(),
                    f.bond_state};
  write_fields(group, f.cells, dimension_, ranks);
  write_particles(group, f, dimension_);
  obstacles_.write(group, f.time, at_first());
  if (bonds > 0) {
    const auto d = static_cast<hsize_t>(dimension_);
    write_array(group, "bond_ends", f.bond_ends, {2 * bonds, d}, "m");
    write_array(group, "bond_state", f.bond_state, {bonds},
                "1: 0 intact, 1 broken by tension, 2 by shear");
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

/// The same as text, each number larger by `more`; in two dimensions with a layer before.
std::string FieldWriter::shape_text(const Entry& e, int more) const {
  std::string text = dimension_ == 2 ? fmt::format("{}", 1 + more) : "";
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
  const double h = units_.dx, behind = dimension_ == 2 ? -h : units_.origin.z();
  std::string out = fmt::format(
      R"(<Grid Name="fluid"><Time Value="{:.9g}"/>
  <Topology TopologyType="3DCoRectMesh" Dimensions="{}"/>
  <Geometry GeometryType="ORIGIN_DXDYDZ"><DataItem Format="XML" Dimensions="3">{:.9g} {:.9g} {:.9g}</DataItem>)"
      R"(<DataItem Format="XML" Dimensions="3">{:.9g} {:.9g} {:.9g}</DataItem></Geometry>
)",
      e.time, shape_text(e, 1), behind, units_.origin.y(), units_.origin.x(), h, h, h);
  const auto attribute = [&](const char* name, const char* kind, const std::string& shape,
                             std::size_t frame) {
    out += fmt::format(
        "  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Cell\">{}</Attribute>\n", name,
        kind, item(group_name(frame) + "/" + name, shape, 4));
  };
  attribute("pressure", "Scalar", shape_text(e, 0), index);
  attribute("velocity", "Vector", shape_text(e, 0) + " 3", index);
  if (e.solids) attribute("solid_fraction", "Scalar", shape_text(e, 0), index);
  if (e.viscosity) attribute("viscosity", "Scalar", shape_text(e, 0), index);
  if (entries_[0].images) attribute("image_fraction", "Scalar", shape_text(e, 0), 0);
  return out + "</Grid>\n";
}

std::string FieldWriter::particle_grid(std::size_t index) const {
  const Entry& e = entries_[index];
  if (e.particles == 0) return nothing("particles", e.time);
  const std::string group = group_name(index), n = fmt::format("{}", e.particles);
  std::string out = fmt::format(
      "<Grid Name=\"particles\"><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"Polyvertex\" "
      "NumberOfElements=\"{}\"/>\n  <Geometry GeometryType=\"{}\">{}</Geometry>\n",
      e.time, n, dimension_ == 2 ? "XY" : "XYZ",
      item(group + "/particle_places", fmt::format("{} {}", n, dimension_), 8));
  for (const PointValue& value : kPointValues)
    out += fmt::format(
        "  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n",
        value.name, value.components > 1 ? "Vector" : "Scalar",
        item(group + "/particle_" + value.name,
             value.components > 1 ? fmt::format("{} {}", n, value.components) : n, 8));
  if (e.clumps)
    out += fmt::format("  <Attribute Name=\"carrier\" Center=\"Node\">{}</Attribute>\n",
                       item(group + "/particle_carrier", n, 8));
  return out + "</Grid>\n";
}

/// The bonds that are intact, or those that are broken, with how (1 tension, 2 shear).
std::string FieldWriter::bond_grid(std::size_t index, bool broken) const {
  const Entry& e = entries_[index];
  const std::string group = group_name(index);
  std::string nodes, modes;
  std::size_t count = 0;
  for (std::size_t i = 0; i < e.bonds.size(); ++i) {
    if ((e.bonds[i] != 0.0) != broken) continue;
    nodes += fmt::format("{} {} ", 2 * i, 2 * i + 1);
    modes += fmt::format("{:.0f} ", e.bonds[i]);
    ++count;
  }
  if (count == 0) return nothing(broken ? "broken_bonds" : "bonds", e.time);
  return fmt::format(
      "<Grid Name=\"{}\"><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"Polyline\" "
      "NodesPerElement=\"2\" "
      "NumberOfElements=\"{}\"><DataItem Format=\"XML\" NumberType=\"Int\" Dimensions=\"{} 2\">{}"
      "</DataItem></Topology>\n  <Geometry GeometryType=\"{}\">{}</Geometry>\n"
      "  <Attribute Name=\"broken\" Center=\"Cell\"><DataItem Format=\"XML\" NumberType=\"Float\" "
      "Dimensions=\"{}\">{}</DataItem></Attribute>\n</Grid>\n",
      broken ? "broken_bonds" : "bonds", e.time, count, count, nodes,
      dimension_ == 2 ? "XY" : "XYZ",
      item(group + "/bond_ends", fmt::format("{} {}", 2 * e.bonds.size(), dimension_), 8), count,
      modes);
}

/// A particle of radius 0, or a bond of length 0, in the lower corner of the box.
std::string FieldWriter::nothing(const char* name, double time) const {
  const bool particle = std::string(name) == "particles";
  const auto numbers = [](int count) {
    std::string text;
    for (int k = 0; k < count; ++k) text += "0 ";
    return text;
  };
  std::string out = fmt::format(
      "<Grid Name=\"{}\"><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"{}\" "
      "NumberOfElements=\"1\"{}</Topology>\n  <Geometry GeometryType=\"XYZ\"><DataItem "
      "Format=\"XML\" Dimensions=\"{} 3\">",
      name, time, particle ? "Polyvertex" : "Polyline",
      particle ? ">"
               : " NodesPerElement=\"2\"><DataItem Format=\"XML\" NumberType=\"Int\" "
                 "Dimensions=\"1 2\">0 1</DataItem>",
      particle ? 1 : 2);
  for (int end = 0; end < (particle ? 1 : 2); ++end)
    out += fmt::format("{:.9g} {:.9g} {:.9g} ", units_.origin.x(), units_.origin.y(),
                       units_.origin.z());
  out += "</DataItem></Geometry>\n";
  const auto attribute = [&](const char* what, int components) {
    out += fmt::format(
        "  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\"><DataItem Format=\"XML\" "
        "NumberType=\"Float\" Dimensions=\"1{}\">{}</DataItem></Attribute>\n",
        what, components > 1 ? "Vector" : "Scalar", particle ? "Node" : "Cell",
        components > 1 ? fmt::format(" {}", components) : "", numbers(components));
  };
  if (!particle) attribute("broken", 1);
  for (const PointValue& value : kPointValues)
    if (particle) attribute(value.name, value.components);
  return out + "</Grid>\n";
}

/// Timelines: the fluid; particles, bonds and broken bonds, where a frame has any; obstacles.
void FieldWriter::write_xdmf() const {
  std::ofstream out(folder_ + "/fields.xdmf");
  out << "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n";
  const auto timeline = [&](const char* name, const auto& present, const auto& grid) {
    if (std::none_of(entries_.begin(), entries_.end(), present)) return;
    std::string grids;
    for (std::size_t i = 0; i < entries_.size(); ++i) grids += grid(i);
    out << fmt::format(
        "<Grid Name=\"{}\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}</Grid>\n", name,
        grids);
  };
  timeline(
      "fluid", [](const Entry&) { return true; }, [&](std::size_t i) { return fluid_grid(i); });
  timeline(
      "particles", [](const Entry& e) { return e.particles > 0; },
      [&](std::size_t i) { return particle_grid(i); });
  timeline(
      "bonds", [](const Entry& e) { return !e.bonds.empty(); },
      [&](std::size_t i) { return bond_grid(i, false); });
  timeline(
      "broken_bonds",
      [](const Entry& e) {
        return std::any_of(e.bonds.begin(), e.bonds.end(), [](double s) { return s != 0.0; });
      },
      [&](std::size_t i) { return bond_grid(i, true); });
  timeline(
      "walls", [&](const Entry&) { return obstacles_.any_walls(); },
      [&](std::size_t i) {
        return obstacles_.walls_grid(entries_[i].time, group_name(0), group_name(i));
      });
  timeline(
      "round_obstacles", [&](const Entry&) { return obstacles_.any_round(); },
      [&](std::size_t i) {
        return obstacles_.round_grid(entries_[i].time, group_name(0), group_name(i));
      });
  out << "</Domain></Xdmf>\n";
}

/// Not needed for the run: where it cannot be written, the tables say that the disk is full.
void FieldWriter::write_view() const {
  std::ofstream(folder_ + "/view.py") << kViewScript;
}

}  // namespace lbm

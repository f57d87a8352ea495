// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/average_writer.h"

#include <fmt/core.h>

#include <fstream>

#include "lbm_solver/io/cell_set.h"
#include "protocol/transport/hdf5_file.h"

namespace lbm {
namespace {

/// "nz ny nx", each larger by `more`; in two dimensions nz is 1.
std::string shape_text(const Domain& d, int more) {
  return fmt::format("{} {} {}", d.nz + more, d.ny + more, d.nx + more);
}

/// The file that tells ParaView where the arrays lie. In two dimensions the layer is one cell
/// thick, behind z = 0.
void write_xdmf(const std::string& path, double time, const Units& units, const Domain& d) {
  std::ofstream out(path);
  const double z = d.dimension() == 2 ? -units.dx : units.origin.z();
  out << fmt::format(
      "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\"><Domain>\n<Grid Name=\"averages\"><Time "
      "Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{}\"/>\n"
      "  <Geometry GeometryType=\"ORIGIN_DXDYDZ\"><DataItem Format=\"XML\" "
      "Dimensions=\"3\">{:.9g} {:.9g} {:.9g}</DataItem><DataItem Format=\"XML\" "
      "Dimensions=\"3\">{:.9g} {:.9g} {:.9g}</DataItem></Geometry>\n",
      time, shape_text(d, 1), z, units.origin.y(), units.origin.x(), units.dx, units.dx, units.dx);
  for (const char* name : {"velocity_mean", "velocity_rms", "pressure_mean", "pressure_rms"}) {
    const bool vector = name[0] == 'v';
    out << fmt::format(
        "  <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Cell\"><DataItem Format=\"HDF\" "
        "NumberType=\"Float\" Precision=\"4\" Dimensions=\"{}{}\">averages.h5:/{}</DataItem>"
        "</Attribute>\n",
        name, vector ? "Vector" : "Scalar", shape_text(d, 0), vector ? " 3" : "", name);
  }
  out << "</Grid>\n</Domain></Xdmf>\n";
}

}  // namespace

void write_averages(const std::string& folder, const FieldAverages& a, const Units& units,
                    const Decomposition& ranks) {
  const Domain& domain = ranks.domain();
  if (ranks.rank() != 0) return send_fields(a.cells, ranks);
  using protocol::hdf5::set_attribute;
  const auto file =
      protocol::hdf5::open_file(folder + "/averages.h5", protocol::hdf5::Open::Create);
  set_attribute(file, "cell", units.dx);
  set_attribute(file, "unit of cell and origin", std::string("m"));
  set_attribute(file, "unit of time", std::string("s"));
  set_attribute(file, "from", a.from);
  set_attribute(file, "to", a.to);
  set_attribute(file, "samples", static_cast<double>(a.samples));
  for (int k = 0; k < domain.dimension(); ++k)
    set_attribute(file, std::string("origin_") + "xyz"[k], units.origin[k]);
  write_fields(file, a.cells, domain.dimension(), ranks);
  write_xdmf(folder + "/averages.xdmf", a.to, units, domain);
}

}  // namespace lbm

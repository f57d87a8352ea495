// SPDX-License-Identifier: GPL-2.0-or-later
/// `lammps_engine -in in.lammps`: Debian's LAMMPS on the solid's side, with fix lbm/couple. What
/// the fluid offers becomes variables of the script.
// clang-format off
#include "tools/engines/lammps/fix_lbm_couple.h"
// clang-format on
#include <input.h>
#include <lammps.h>
#include <modify.h>
#include <mpi.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "protocol/program/mpi_calls.h"
#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"

namespace {

using engine::Coupling;
using engine::FixLbmCouple;

LAMMPS_NS::Fix* make_fix(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg) {
  return new FixLbmCouple(lammps, narg, arg);
}

std::unique_ptr<protocol::Channel> channel;
std::string log_file = "log.lammps";

void run(std::vector<std::string> arguments, protocol::SolidSession& session, MPI_Comm local) {
  Coupling::instance().session = &session;
  std::string script = "in.lammps";
  for (std::size_t i = 1; i + 1 < arguments.size(); ++i) {
    if (arguments[i] == "-in") script = arguments[i + 1];
    if (arguments[i] == "-log") log_file = arguments[i + 1];
  }
  if (!std::filesystem::is_regular_file(script))
    throw protocol::ProgramError(script + ": no such script; give -in FILE", protocol::kBadInput);
  const auto folder = std::filesystem::path(script).parent_path();
  arguments.insert(arguments.end(),
                   {"-var", "scene_folder", folder.empty() ? "." : folder.string()});
  for (const auto& v : session.fluid().variables)
    arguments.insert(arguments.end(), {"-var", v.name, v.value});
  std::vector<char*> argv;
  for (std::string& a : arguments) argv.push_back(a.data());
  LAMMPS_NS::LAMMPS lammps(static_cast<int>(argv.size()), argv.data(), local);
  (*lammps.modify->fix_map)["lbm/couple"] = &make_fix;
  protocol::catch_signals();
  lammps.input->file(script.c_str());
  if (!Coupling::instance().over)
    session.goodbye(Coupling::instance().agreed ? "its script ended before the fluid's end time"
                                                : "its script ended without fix lbm/couple");
}

}  // namespace

// LAMMPS ends the process itself after an error: all ranks finalise, or one aborts. The fluid would
// wait for it; these two stand before those of MPI.
[[noreturn]] static void end_with_error(bool lonely) {
  const std::string said = protocol::last_error_line({log_file});
  protocol::end_with_engine(
      said.empty() ? "LAMMPS stopped with an error; see its output, or give it -log FILE" : said,
      channel.get(), lonely);
}
extern "C" int MPI_Finalize() {
  int over = 0;
  PMPI_Finalized(&over);
  if (!over) end_with_error(/*lonely=*/false);
  return MPI_SUCCESS;
}
extern "C" int MPI_Abort(MPI_Comm, int) {
  end_with_error(/*lonely=*/true);
}

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv, argv + argc);
  {
    const protocol::MpiStart bounded("lammps_engine");
    MPI_Init(&argc, &argv);
  }
  protocol::catch_signals();
  protocol::World world;
  int code = protocol::kOk;
  try {
    world = protocol::connect(protocol::Role::Solid);
    if (!world.coupled())
      throw protocol::ProgramError(
          "no fluid program was started beside it; start: mpirun -np 1 lbm scene.toml : -np 1 "
          "lammps_engine -in FILE",
          protocol::kBadInput);
    channel = protocol::make_mpi_channel(world, protocol::Role::Solid);
    protocol::SolidSession session(*channel, 60.0);
    protocol::limit_waits(session.timeout());
    protocol::replace_world(world.local);  // to LAMMPS it is its own
    run(arguments, session, world.local);
  } catch (const std::exception& error) {
    code = protocol::leave_after(error, "lammps_engine", channel.get());
  }
  return protocol::finish(code, "lammps_engine", channel, world.local);
}

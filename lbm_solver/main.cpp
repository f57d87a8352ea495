// SPDX-License-Identifier: GPL-2.0-or-later
/// `lbm scene.toml` runs the fluid of a coupled job; `lbm check scene.toml` looks without running.
#include <fmt/core.h>
#include <omp.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/report.h"
#include "lbm_solver/coupling/run.h"
#include "lbm_solver/io/hdf5_files.h"
#include "lbm_solver/io/output_folder.h"
#include "lbm_solver/io/scene_keys.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/work.h"
#include "protocol/program/command_line.h"
#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/transport/recording.h"
#include "protocol/wire/numbers.h"

namespace {

using namespace lbm;

constexpr int kMostThreads = 1024;
constexpr double kAloneSeconds = 300.0;  // longest wait of one rank for another, without a solid

struct Options {
  std::vector<std::string> scene{"scene.toml"};
  RunOptions run;
  std::string record, progress = "auto";
  std::vector<int> grid;
  int threads = 0;
  bool force = false, check = false, liggghts_vars = false, list = false, keys = false;
};

void add_scene(CLI::App& app, Options& o) {
  app.add_option("scene", o.scene, "scene file, then overlays that change keys of it")
      ->capture_default_str();
}

void define(CLI::App& app, Options& o) {
  app.set_version_flag("--version", std::string("lbm ") + BPLBM_VERSION);
  app.add_option("--out", o.run.out, "folder of all output")->capture_default_str();
  app.add_flag("--force", o.force,
               "replace an earlier run in --out; else its folder is renamed to OUT.1, OUT.2 …");
  app.add_option("--until", o.run.until, "stop at this time [s]")
      ->check(protocol::finite_number(0.0));
  app.add_flag("--restart{checkpoint}", o.run.restart.from,
               "go on from the checkpoint in --out, or, with --restart=fault, from the last states "
               "that both programs kept when a run failed")
      ->check(CLI::IsMember({"checkpoint", "fault"}))
      ->excludes("--force");
  app.add_option("--accept", o.run.restart.accept,
                 "with --restart: a key or table of the scene that may have changed since, e.g. "
                 "fluid.body_force")
      ->needs("--restart")
      ->expected(1)
      ->allow_extra_args(false)  // what follows is the scene
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--record", o.record, "write the exchange to this trace file");
  app.add_option("--threads", o.threads, "threads (else OMP_NUM_THREADS, else 1)")
      ->check(CLI::Range(1, kMostThreads));
  app.add_option("--grid", o.grid, "ranks along x, y, z (else the grid with the least surface)")
      ->expected(3)
      ->check(CLI::PositiveNumber);
  app.add_option("--progress", o.progress, "line, tenths, none, auto")
      ->check(CLI::IsMember({"line", "tenths", "none", "auto"}))
      ->capture_default_str();
  app.add_option("--set", o.run.set, "name of the parameter set, for the summary");
  app.add_option("--variant", o.run.variant, "name of the variant, for the summary");
  app.add_flag("--list", o.list, "lattices, operators, terms and schemes that a scene may name");
  app.add_flag("--keys", o.keys, "every key of a scene with type, unit, default, range, meaning");
  add_scene(app, o);
  auto* check = app.add_subcommand("check", "look at a scene without running it");
  check->add_flag("--liggghts-vars", o.liggghts_vars, "print the -var options for LIGGGHTS");
  add_scene(*check, o);
  check->callback([&o] { o.check = true; });
}

/// The OpenMP library takes whatever number it finds, and ends the program where the system cannot
/// start as many threads. @throws InputError
void check_environment() {
  const char* set = std::getenv("OMP_NUM_THREADS");
  if (!set) return;
  const std::string text = set;  // a number, or one for each level of nested regions
  const auto first = protocol::to_number<int>(text.substr(0, text.find(',')));
  if (first && *first >= 1 && *first <= kMostThreads) return;
  throw InputError(fmt::format("the environment variable OMP_NUM_THREADS = '{}'", text),
                   fmt::format("is no number of threads from 1 to {}", kMostThreads),
                   "correct or unset it, or give --threads N");
}

int check(const Options& o) {
  check_environment();
  const Scene scene = read_scene(o.scene);
  const Plan plan = make_plan(scene);
  if (!o.liggghts_vars) {
    fmt::print("{}", describe(scene, plan));
    fmt::print("{}", describe_cost(scene, plan));
    return protocol::kOk;
  }
  if (!scene.coupling) throw InputError(scene.file, "has no [coupling]", "there are no variables");
  std::string line;
  for (const auto& v : make_handshake(scene, plan).variables)
    line += fmt::format("{}-var {} {}", line.empty() ? "" : " ", v.name, v.value);
  fmt::print("{}\n", line);
  return protocol::kOk;
}

Log::Progress progress_style(const std::string& name) {
  if (name == "none") return Log::Progress::None;
  if (name == "line" || (name == "auto" && isatty(STDOUT_FILENO))) return Log::Progress::Line;
  return Log::Progress::Tenths;
}

void set_threads(int threads) {
  if (threads > 0)
    omp_set_num_threads(threads);
  else if (!std::getenv("OMP_NUM_THREADS"))
    omp_set_num_threads(1);  // the solid program needs cores too
}

/// Rank 0 takes the folder before any rank goes on.
std::unique_ptr<OutputFolder> take_folder(const Options& o, const Scene& scene,
                                          const Decomposition& ranks) {
  std::unique_ptr<OutputFolder> folder;
  const EarlierRun earlier = !o.run.restart.from.empty() ? EarlierRun::GoOn
                             : o.force                   ? EarlierRun::Replace
                                                         : EarlierRun::SetAside;
  if (ranks.rank() == 0) folder = std::make_unique<OutputFolder>(o.run.out, scene.title, earlier);
  if (!ranks.alone()) MPI_Barrier(ranks.comm());
  return folder;
}

/// Rank 0 looks for damage; where there is none left to go on from, every rank sees for itself.
std::optional<Restart> find_restart_together(const Scene& scene, const Options& o, MPI_Comm comm) {
  if (o.run.restart.from.empty()) return std::nullopt;
  enum Found { kNothing, kLast, kEarlier };
  int rank = 0, found = kNothing;
  MPI_Comm_rank(comm, &rank);
  std::optional<Restart> restart;
  std::exception_ptr mistake;
  if (rank == 0) try {
      restart = find_restart(scene, o.run.out, o.run.restart);
      found = restart->earlier ? kEarlier : kLast;
    } catch (...) {
      mistake = std::current_exception();
    }
  MPI_Bcast(&found, 1, MPI_INT, 0, comm);
  if (mistake) std::rethrow_exception(mistake);
  if (rank == 0) return restart;
  if (found == kNothing) return find_restart(scene, o.run.out, o.run.restart);
  return take_restart(scene, o.run.out, o.run.restart, found == kEarlier);
}

/// How the box is divided among the ranks of lbm.
Decomposition divide(const Options& o, const Scene& scene, const Plan& plan, MPI_Comm comm) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  if (size == 1) return Decomposition(plan.domain);
  if (plan.scheme != SolidScheme::ImmersedMovingBoundary)
    throw InputError(fmt::format("{}: numerics.scheme = \"{}\" works on one rank only", scene.file,
                                 name_of(plan.scheme)),
                     "start one lbm, or take immersed_moving_boundary");
  try {
    const Cell3 grid =
        o.grid.empty() ? choose_grid(plan.domain, size) : Cell3{o.grid[0], o.grid[1], o.grid[2]};
    return {plan.domain, comm, grid};
  } catch (const std::invalid_argument& error) {
    throw InputError("mpirun", error.what(), "start fewer ranks of lbm, or give another --grid");
  }
}

/// What is known of the work of the layers where blocks shall share it. @throws InputError
std::optional<LayerWork> known_work(const Scene& scene, const Plan& plan,
                                    const Decomposition& ranks,
                                    const std::optional<Restart>& restart) {
  if (!scene.numerics.equal_work || ranks.alone()) return {};
  if (!restart || !restart->record.parts().contains("work")) return first_work(scene, plan, ranks);
  try {
    return load_work(restart->record.part("work"), plan.domain);
  } catch (const std::invalid_argument& error) {
    throw InputError(restart->path, fmt::format("does not fit this scene: {}", error.what()),
                     "start again without --restart");
  }
}

/// Every rank records its own exchange: FILE, FILE.1, FILE.2, …
std::string trace_of(const std::string& file, const Decomposition& ranks) {
  return ranks.rank() == 0 ? file : fmt::format("{}.{}", file, ranks.rank());
}

/// How long a solid program may take to start [s]; negative: as the protocol has it.
double connect_timeout(const std::optional<Scene>& scene) {
  return scene && scene->coupling ? scene->coupling->connect_timeout : -1.0;
}

/// Options whose files lbm may have been built without. @throws InputError
void check_files(const Options& o) {
  if (has_hdf5()) return;
  if (!o.record.empty()) throw InputError("--record", kNeedsHdf5, kWithoutHdf5);
  if (!o.run.restart.from.empty()) throw InputError("--restart", kNeedsHdf5, kWithoutHdf5);
}

/// @throws InputError  a solid program is missing, or there is one too many
void check_partner(const Options& o, const Scene& scene, bool has_partner) {
  if (scene.coupling && !has_partner)
    throw InputError(
        "mpirun", "no solid program was started beside lbm",
        "start: mpirun -np 1 lbm scene.toml : -np 1 liggghts -in in.liggghts, or tools/run");
  if (!scene.coupling && has_partner)
    throw InputError(scene.file, "has no [coupling], but a solid program was started",
                     "start lbm alone, or add the tables [coupling] and [particles]");
  if (!o.record.empty() && !has_partner)
    throw InputError("--record", "has nothing to record: the fluid is alone", "leave it out");
}

/// @param channel  set as soon as there is a partner, so that an error can be told to it
void run(const Options& o, std::unique_ptr<protocol::Channel>& channel, protocol::World& world) {
  std::exception_ptr mistake;  // in the scene: said when there is a partner who can hear it
  std::optional<Scene> read;
  try {
    read = read_scene(o.scene);
  } catch (...) {
    mistake = std::current_exception();
  }
  world = protocol::connect(protocol::Role::Fluid, connect_timeout(read));
  if (world.coupled()) channel = protocol::make_mpi_channel(world, protocol::Role::Fluid);
  if (o.threads == 0) check_environment();
  check_files(o);
  if (mistake) std::rethrow_exception(mistake);
  const Scene& scene = *read;
  protocol::limit_waits(scene.coupling
                            ? scene.coupling->timeout
                            : protocol::seconds_from_environment("BPLBM_TIMEOUT", kAloneSeconds));
  check_until(scene, o.run);
  const std::optional<Restart> restart = find_restart_together(scene, o, world.local);
  const Plan plan = make_plan(scene, restart ? std::optional(restart->step) : std::nullopt);
  if (restart) check_same_scene(*restart, scene, plan, o.run.restart);
  const Decomposition blocks = divide(o, scene, plan, world.local);
  check_partner(o, scene, channel != nullptr);
  const auto work = known_work(scene, plan, blocks, restart);
  const Decomposition ranks = work ? of_equal_work(blocks, *work) : blocks;
  const std::unique_ptr<OutputFolder> folder = take_folder(o, scene, ranks);
  if (!o.record.empty())
    protocol::record_to(trace_of(o.record, ranks), channel, "fluid", ranks.rank());
  set_threads(o.threads);
  Log log = ranks.rank() == 0 ? Log(o.run.out, progress_style(o.progress)) : Log();
  if (folder && !folder->set_aside().empty())
    log.block("kept         the earlier run of this folder is now " + folder->set_aside());
  log.block(describe(scene, plan));
  if (o.run.until)
    log.block(fmt::format("until        {:.6g} s: --until ends the run there\n", *o.run.until));
  if (!ranks.alone())
    log.block(fmt::format("ranks        {} × {} × {}{}\n", ranks.grid()[0], ranks.grid()[1],
                          ranks.grid()[2], work ? describe_blocks(ranks, *work) : ""));
  const Restart* from = restart ? &*restart : nullptr;
  log.block(describe(scene.coupling ? run_coupled(scene, plan, ranks, *channel, o.run, log, from)
                                    : run_alone(scene, plan, ranks, o.run, log, from)));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Lattice Boltzmann fluid of a coupled job: mpirun -np 1 lbm SCENE : -np 1 liggghts -in FILE"};
  define(app, options);
  if (const auto code = protocol::read_command_line(app, "lbm", argc, argv)) return *code;
  if (options.list || options.keys) {
    fmt::print("{}", options.keys ? describe_keys() : describe_choices());
    return protocol::kOk;
  }
  if (options.check) try {
      return check(options);
    } catch (const std::exception& error) {
      fmt::print(stderr, "lbm | error | {}\n", error.what());
      return protocol::exit_code_of(error);
    }

  {
    const protocol::MpiStart bounded("lbm", connect_timeout_in(options.scene));
    int level = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  }
  protocol::catch_signals();
  std::unique_ptr<protocol::Channel> channel;
  protocol::World world;
  int code = protocol::kOk;
  try {
    run(options, channel, world);
    if (protocol::signalled()) code = protocol::kFault;  // it ended in good order, but early
  } catch (const std::exception& error) {
    code = protocol::leave_after(error, "lbm", channel.get());
  }
  return protocol::finish(code, "lbm", channel, world.local);
}

// SPDX-License-Identifier: MIT
#include "protocol/solid/bplbm_solid.h"

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/program/mpi_start.h"
#include "protocol/program/program.h"
#include "protocol/program/solid_parts.h"
#include "protocol/program/watch.h"
#include "protocol/solid/setup.h"
#include "protocol/transport/mpi_channel.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/session.h"
#include "protocol/wire/text.h"

using namespace protocol;

static_assert(sizeof(bplbm_state) == sizeof(State) && sizeof(bplbm_shape) == sizeof(Shape) &&
                  sizeof(bplbm_load) == sizeof(Load) && sizeof(bplbm_bond) == sizeof(Bond) &&
                  offsetof(bplbm_state, omega) == offsetof(State, omega) &&
                  offsetof(bplbm_shape, volume) == offsetof(Shape, volume) &&
                  offsetof(bplbm_load, torque) == offsetof(Load, torque),
              "the records of the C interface are those of the wire");

/// The conversation of one rank, and how it ended.
struct bplbm_solid {
  std::string program, version, error;
  std::exception_ptr failure;
  int code = kOk;
  World world;
  std::unique_ptr<Channel> channel;
  std::optional<SolidSession> session;
  std::optional<SolidReport> report;
  Hello hello;  // what was agreed
  StepHeader head;
  bool agreed = false, stop_asked = false, checkpoint_written = false;
  bool underway = false;  // states are sent, their loads have not come
  bool checkpoint_asked = false;
  bool left = false;  // it said goodbye

  void note(const std::exception& what) {
    failure = std::current_exception();
    error = what.what();
    code = exit_code_of(what);
    if (code == kOk) code = kFault;
  }
};

namespace {

/// Does something unless the conversation has failed before. @return its exit code so far
template <class Work>
int guarded(bplbm_solid* solid, Work&& work) {
  if (!solid) return kFault;
  if (solid->code != kOk) return solid->code;
  try {
    work();
  } catch (const std::exception& error) {
    solid->note(error);
  }
  return solid->code;
}

void expect(bool holds, const char* what) {
  if (!holds) throw ProgramError(what, kBadInput);
}

/// The signals that mpirun sends end a run in good order, where the program has no handlers.
void catch_free_signals() {
  struct sigaction term {};
  sigaction(SIGTERM, nullptr, &term);
  if (term.sa_handler == SIG_DFL) catch_signals();
}

/// Handles that bplbm_close has not had, and who the first of them is of.
int open_handles = 0;
std::string first_program;

/// At the end of the process, where nobody could say it to the fluid.
void complain_of_open_handles() {
  if (open_handles > 0)
    std::fprintf(
        stderr,
        "%s | error | it ends without bplbm_close, so the fluid has to find out that nobody "
        "answers; call bplbm_close on every way out, and return what it returns\n",
        first_program.c_str());
}

void count_handle(const std::string& program) {
  [[maybe_unused]] static const int registered = std::atexit(complain_of_open_handles);
  if (open_handles++ == 0) first_program = program;
}

void send(bplbm_solid& solid, std::int64_t n, const bplbm_state* states,
          const bplbm_shape* shapes) {
  expect(solid.agreed, "bplbm_exchange: call bplbm_agree first");
  expect(!solid.left, "bplbm_exchange: bplbm_goodbye was called; call bplbm_close next");
  expect(!solid.underway, "bplbm_send: these states are sent; call bplbm_receive for their loads");
  expect(!(solid.head.flags & kLast), "bplbm_exchange: the last states have been sent");
  expect(n >= 0 && (n == 0 || (states && shapes)),
         "bplbm_exchange: give a state and a shape for each of n >= 0 particles");
  for (std::int64_t i = 0; i < n; ++i)
    if (states[i].id != shapes[i].id)
      throw ProgramError(format("bplbm_exchange: state {} is of particle {}, but shape {} of "
                                "particle {}; give both in one order",
                                i, states[i].id, i, shapes[i].id),
                         kBadInput);
  StepHeader& head = solid.head;
  head.time = static_cast<double>(head.interval) * solid.hello.step * solid.hello.solid_steps;
  head.flags = (solid.stop_asked ? kLast : 0U) | (solid.checkpoint_written ? kCheckpoint : 0U) |
               (signalled() ? kStopWished : 0U);
  const auto count = static_cast<std::size_t>(n);
  solid.session->send(head, {reinterpret_cast<const State*>(states), count},
                      {reinterpret_cast<const Shape*>(shapes), count}, solid.report);
  solid.report.reset();
  solid.checkpoint_written = false;
  solid.underway = true;
}

void receive(bplbm_solid& solid, bplbm_load* loads, std::uint32_t* asked) {
  expect(solid.underway, "bplbm_receive: no states are sent; call bplbm_send first");
  solid.underway = false;
  if (solid.head.flags & kLast) {
    if (asked) *asked = BPLBM_LAST;
    return;
  }
  const SolidSession::Reply reply = solid.session->collect();
  expect(reply.loads.empty() || loads, "bplbm_exchange: there is no place for the loads");
  std::copy(reply.loads.begin(), reply.loads.end(), reinterpret_cast<Load*>(loads));
  solid.stop_asked = reply.flags & kStop;
  solid.checkpoint_asked = reply.flags & kCheckpoint;
  ++solid.head.interval;
  if (asked) *asked = reply.flags;
}

/// The pieces of all ranks, in the order of ranks; on rank 0, nothing on others.
Bytes gather(MPI_Comm comm, std::span<const std::byte> piece) {
  expect(piece.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()),
         "bplbm_checkpoint: more than 2 GiB of one rank; use more ranks");
  int rank = 0, ranks = 0;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int mine = static_cast<int>(piece.size());
  std::vector<int> sizes(rank == 0 ? ranks : 0);
  MPI_Gather(&mine, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, comm);
  Bytes whole(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  constexpr int tag = 1;
  if (rank != 0) {
    MPI_Send(piece.data(), mine, MPI_BYTE, 0, tag, comm);
    return whole;
  }
  std::copy(piece.begin(), piece.end(), whole.begin());
  std::size_t at = piece.size();
  for (int r = 1; r < ranks; ++r) {
    MPI_Recv(whole.data() + at, sizes[r], MPI_BYTE, r, tag, comm, MPI_STATUS_IGNORE);
    at += static_cast<std::size_t>(sizes[r]);
  }
  return whole;
}

/// Rank 0 writes; it is there before any rank says so.
void keep(bplbm_solid& solid, std::span<const std::byte> piece) {
  const Bytes whole = gather(solid.world.local, piece);
  int rank = 0, written = 1;
  MPI_Comm_rank(solid.world.local, &rank);
  std::exception_ptr failure;
  try {
    if (rank == 0) SolidParts::of(solid.session->fluid()).keep(solid.head.interval, whole);
  } catch (const std::exception&) {
    failure = std::current_exception();
    written = 0;
  }
  MPI_Bcast(&written, 1, MPI_INT, 0, solid.world.local);
  if (failure) std::rethrow_exception(failure);
  if (!written) throw ProgramError("rank 0 could not write the checkpoint");
  solid.checkpoint_written = true;
}

const Variable* find(const bplbm_solid* solid, const char* name) {
  if (!solid || !solid->session || !name) return nullptr;
  for (const Variable& v : solid->session->fluid().variables)
    if (v.name == name) return &v;
  return nullptr;
}

/// The end after a failure. @return whether MPI is still to be finalised, in good order
bool part(bplbm_solid& solid) {
  try {
    std::rethrow_exception(solid.failure);
  } catch (const std::exception& error) {
    const Parting parting = part_after(error, solid.program, solid.channel.get());
    return parting.in_order;
  }
}

}  // namespace

int bplbm_connect(bplbm_solid** solid, const char* program, const char* version) {
  if (!solid) return kFault;
  *solid = new (std::nothrow) bplbm_solid;
  return guarded(*solid, [&] {
    bplbm_solid& s = **solid;
    s.program = program ? program : "solid";
    s.version = version ? version : "";
    count_handle(s.program);
    expect(open_handles == 1,
           "bplbm_connect: this process is connected already; call bplbm_close with that handle");
    int initialised = 0;
    MPI_Initialized(&initialised);
    if (!initialised) {
      const MpiStart bounded(s.program);
      MPI_Init(nullptr, nullptr);
    }
    catch_free_signals();
    s.world = connect(Role::Solid);
    if (!s.world.coupled())
      throw ProgramError(
          "no fluid program was started beside it; start: mpirun -np 1 lbm "
          "scene.toml : -np 1 " +
              s.program,
          kBadInput);
    s.channel = make_mpi_channel(s.world, Role::Solid);
    s.session.emplace(*s.channel, 60.0);
    limit_waits(s.session->timeout());
  });
}

const char* bplbm_error(const bplbm_solid* solid) {
  return solid ? solid->error.c_str() : "there is no memory for a connection";
}

int bplbm_scene(bplbm_solid* solid, bplbm_setup* setup) {
  return guarded(solid, [&] {
    expect(setup != nullptr, "bplbm_scene: give a setup");
    *setup = setup_of(solid->session->fluid());
  });
}

const char* bplbm_variable(const bplbm_solid* solid, const char* name) {
  const Variable* found = find(solid, name);
  return found ? found->value.c_str() : nullptr;
}

int bplbm_number(bplbm_solid* solid, const char* name, double* value) {
  return guarded(solid, [&] {
    expect(name && value, "bplbm_number: give a name and a place for the number");
    const Variable* found = find(solid, name);
    if (!found)
      throw ProgramError(format("the fluid offers no variable '{}'; add it to "
                                "[particles.variables] of the scene",
                                name),
                         kBadInput);
    const auto number = to_number<double>(found->value);
    if (!number)
      throw ProgramError(format("the fluid's variable '{}' = '{}' is no number; correct "
                                "[particles.variables] of the scene",
                                name, found->value),
                         kBadInput);
    *value = *number;
  });
}

int bplbm_agree(bplbm_solid* solid, const bplbm_setup* setup) {
  return guarded(solid, [&] {
    expect(setup != nullptr, "bplbm_agree: give a setup");
    expect(!solid->agreed, "bplbm_agree: both have agreed already; call it once");
    solid->hello = hello_of(*setup);
    solid->hello.program = solid->program;
    solid->hello.program_version = solid->version;
    solid->head.interval = solid->hello.first_interval;
    solid->session->agree(solid->hello);
    solid->agreed = true;
  });
}

int bplbm_send(bplbm_solid* solid, int64_t n, const bplbm_state* states,
               const bplbm_shape* shapes) {
  return guarded(solid, [&] { send(*solid, n, states, shapes); });
}

int bplbm_receive(bplbm_solid* solid, bplbm_load* loads, uint32_t* asked) {
  return guarded(solid, [&] { receive(*solid, loads, asked); });
}

int bplbm_exchange(bplbm_solid* solid, int64_t n, const bplbm_state* states,
                   const bplbm_shape* shapes, bplbm_load* loads, uint32_t* asked) {
  return guarded(solid, [&] {
    send(*solid, n, states, shapes);
    receive(*solid, loads, asked);
  });
}

int bplbm_checkpoint(bplbm_solid* solid, const void* bytes, int64_t size) {
  return guarded(solid, [&] {
    expect(size >= 0 && (bytes || size == 0), "bplbm_checkpoint: give its bytes");
    expect(solid->checkpoint_asked,
           "bplbm_checkpoint: the last loads did not ask for one (BPLBM_CHECKPOINT)");
    keep(*solid, {static_cast<const std::byte*>(bytes), static_cast<std::size_t>(size)});
  });
}

int bplbm_report(bplbm_solid* solid, int64_t left, const int64_t counts[5], int64_t n,
                 const bplbm_bond* bonds) {
  return guarded(solid, [&] {
    expect(n >= 0 && (n == 0 || bonds), "bplbm_report: give n >= 0 bonds");
    SolidReport& report = solid->report.emplace();
    report.grains_left = left;
    if (counts) report.bonds = {counts[0], counts[1], counts[2], counts[3], counts[4]};
    for (int64_t i = 0; i < n; ++i)
      report.list.push_back({bonds[i].first, bonds[i].second, bonds[i].state});
  });
}

int bplbm_goodbye(bplbm_solid* solid, const char* reason) {
  return guarded(solid, [&] {
    expect(solid->agreed, "bplbm_goodbye: call bplbm_agree first");
    expect(!solid->left, "bplbm_goodbye: it was said; call bplbm_close next");
    solid->session->goodbye(reason ? reason : "");
    solid->left = true;
  });
}

int bplbm_fail(bplbm_solid* solid, int code, const char* reason) {
  return guarded(solid, [&] {
    throw ProgramError(reason ? reason : "it does not say why",
                       code < 1 || code > 255 ? int{kFault} : code);
  });
}

MPI_Comm bplbm_communicator(const bplbm_solid* solid) {
  return solid ? solid->world.local : MPI_COMM_NULL;
}

MPI_Fint bplbm_communicator_f(const bplbm_solid* solid) {
  return MPI_Comm_c2f(bplbm_communicator(solid));
}

int bplbm_close(bplbm_solid* solid) {
  const std::unique_ptr<bplbm_solid> owned(solid);
  if (!solid) return kFault;
  if (open_handles > 0) --open_handles;
  const bool in_order = !solid->failure || part(*solid);
  int initialised = 0, finalised = 0;
  MPI_Initialized(&initialised);
  MPI_Finalized(&finalised);
  if (!in_order || !initialised || finalised) return solid->code;
  return finish(solid->code, solid->program, solid->channel, solid->world.local);
}

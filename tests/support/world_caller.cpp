// SPDX-License-Identifier: MIT
/// `world_caller` on two ranks, beside a `world_caller idle`: calls every MPI function that takes a
/// communicator on MPI_COMM_WORLD, as a library would that knows of no partner. Prints "called
/// NAME" for each, or ends with 1 where a result is not that of two ranks.
#include <fmt/format.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "protocol/program/mpi_calls.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/mpi_channel.h"

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace {

constexpr int kTag = 7;
int me = 0, other = 1;

/// Calls a function of MPI and says so.
#define CALL(name, ...)                                 \
  do {                                                  \
    if (name(__VA_ARGS__) != MPI_SUCCESS) wrong(#name); \
    if (me == 0) fmt::print("called {}\n", #name);      \
  } while (false)

[[noreturn]] void wrong(const std::string& what) {
  fmt::print(stderr, "world_caller | error | {} on rank {}\n", what, me);
  protocol::abort_job(1);
}
void expect(bool good, const char* what) {
  if (!good) wrong(what);
}

/// A number from the other rank is expected while `send` sends it one.
template <class Send>
void with_receive(Send&& send) {
  const int mine = 10 + me;
  int got = 0;
  MPI_Request receive;
  CALL(MPI_Irecv, &got, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &receive);
  CALL(MPI_Barrier, MPI_COMM_WORLD);
  send(&mine);
  MPI_Wait(&receive, MPI_STATUS_IGNORE);
  expect(got == 10 + other, "a message did not come");
}

/// A number is on its way to each rank while `receive` takes it.
template <class Receive>
void with_send(Receive&& receive) {
  const int mine = 20 + me;
  int got = 0;
  MPI_Request sent;
  CALL(MPI_Isend, &mine, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &sent);
  receive(&got);
  MPI_Wait(&sent, MPI_STATUS_IGNORE);
  expect(got == 20 + other, "a message was not received");
}

void send_in_every_way() {
  std::vector<char> buffer(10000);
  MPI_Buffer_attach(buffer.data(), static_cast<int>(buffer.size()));
  MPI_Request r;
#define SEND(name) \
  with_receive([&](const int* v) { CALL(name, v, 1, MPI_INT, other, kTag, MPI_COMM_WORLD); })
#define BEGIN_SEND(name)                                        \
  with_receive([&](const int* v) {                              \
    CALL(name, v, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &r); \
    MPI_Wait(&r, MPI_STATUS_IGNORE);                            \
  })
#define PREPARE_SEND(name)                                      \
  with_receive([&](const int* v) {                              \
    CALL(name, v, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &r); \
    MPI_Start(&r);                                              \
    MPI_Wait(&r, MPI_STATUS_IGNORE);                            \
    MPI_Request_free(&r);                                       \
  })
  SEND(MPI_Send);
  SEND(MPI_Bsend);
  SEND(MPI_Ssend);
  SEND(MPI_Rsend);
  BEGIN_SEND(MPI_Isend);
  BEGIN_SEND(MPI_Ibsend);
  BEGIN_SEND(MPI_Issend);
  BEGIN_SEND(MPI_Irsend);
  PREPARE_SEND(MPI_Send_init);
  PREPARE_SEND(MPI_Bsend_init);
  PREPARE_SEND(MPI_Ssend_init);
  PREPARE_SEND(MPI_Rsend_init);
  void* detached = nullptr;
  int size = 0;
  MPI_Buffer_detach(&detached, &size);
}

void receive_in_every_way() {
  MPI_Status s;
  MPI_Message message;
  MPI_Request r;
  int flag = 0;
  const auto take = [&](int* to) {
    CALL(MPI_Recv, to, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &s);
  };
  with_send(take);
  with_send([&](int* to) {
    CALL(MPI_Probe, other, kTag, MPI_COMM_WORLD, &s);
    take(to);
  });
  with_send([&](int* to) {
    CALL(MPI_Iprobe, other, kTag, MPI_COMM_WORLD, &flag, &s);
    while (!flag) MPI_Iprobe(other, kTag, MPI_COMM_WORLD, &flag, &s);
    take(to);
  });
  with_send([&](int* to) {
    CALL(MPI_Mprobe, other, kTag, MPI_COMM_WORLD, &message, &s);
    MPI_Mrecv(to, 1, MPI_INT, &message, &s);
  });
  with_send([&](int* to) {
    CALL(MPI_Improbe, other, kTag, MPI_COMM_WORLD, &flag, &message, &s);
    while (!flag) MPI_Improbe(other, kTag, MPI_COMM_WORLD, &flag, &message, &s);
    MPI_Mrecv(to, 1, MPI_INT, &message, &s);
  });
  with_send([&](int* to) {
    CALL(MPI_Recv_init, to, 1, MPI_INT, other, kTag, MPI_COMM_WORLD, &r);
    MPI_Start(&r);
    MPI_Wait(&r, &s);
    MPI_Request_free(&r);
  });
  int mine = me, got = -1;
  CALL(MPI_Sendrecv, &mine, 1, MPI_INT, other, kTag, &got, 1, MPI_INT, other, kTag, MPI_COMM_WORLD,
       &s);
  expect(got == other, "MPI_Sendrecv");
  CALL(MPI_Sendrecv_replace, &mine, 1, MPI_INT, other, kTag, other, kTag, MPI_COMM_WORLD, &s);
  expect(mine == other, "MPI_Sendrecv_replace");
}

void collect_in_every_way() {
  MPI_Request r;
  const int one[2] = {1, 1}, start[2] = {0, 1}, bytes[2] = {0, static_cast<int>(sizeof(int))};
  const MPI_Datatype types[2] = {MPI_INT, MPI_INT};
  int mine[2] = {me + 1, me + 1}, all[2] = {0, 0}, sum = 0;
  const auto expect_both = [&](const char* name) {
    expect(all[0] == 1 && all[1] == 2, name);
    all[0] = all[1] = 0;
  };
// The function that waits, and the one that only begins.
#define COLLECT(name, begin, ...)                 \
  do {                                            \
    CALL(name, __VA_ARGS__, MPI_COMM_WORLD);      \
    CALL(begin, __VA_ARGS__, MPI_COMM_WORLD, &r); \
    MPI_Wait(&r, MPI_STATUS_IGNORE);              \
  } while (false)
  CALL(MPI_Barrier, MPI_COMM_WORLD);
  CALL(MPI_Ibarrier, MPI_COMM_WORLD, &r);
  MPI_Wait(&r, MPI_STATUS_IGNORE);
  COLLECT(MPI_Allgather, MPI_Iallgather, mine, 1, MPI_INT, all, 1, MPI_INT);
  expect_both("MPI_Allgather");
  COLLECT(MPI_Allgatherv, MPI_Iallgatherv, mine, 1, MPI_INT, all, one, start, MPI_INT);
  expect_both("MPI_Allgatherv");
  COLLECT(MPI_Alltoall, MPI_Ialltoall, mine, 1, MPI_INT, all, 1, MPI_INT);
  expect_both("MPI_Alltoall");
  COLLECT(MPI_Alltoallv, MPI_Ialltoallv, mine, one, start, MPI_INT, all, one, start, MPI_INT);
  expect_both("MPI_Alltoallv");
  COLLECT(MPI_Alltoallw, MPI_Ialltoallw, mine, one, bytes, types, all, one, bytes, types);
  expect_both("MPI_Alltoallw");
  COLLECT(MPI_Gather, MPI_Igather, mine, 1, MPI_INT, all, 1, MPI_INT, 0);
  if (me == 0) expect_both("MPI_Gather");
  COLLECT(MPI_Gatherv, MPI_Igatherv, mine, 1, MPI_INT, all, one, start, MPI_INT, 0);
  if (me == 0) expect_both("MPI_Gatherv");
  int given[2] = {5, 6};
  COLLECT(MPI_Scatter, MPI_Iscatter, given, 1, MPI_INT, &sum, 1, MPI_INT, 0);
  expect(sum == 5 + me, "MPI_Scatter");
  COLLECT(MPI_Scatterv, MPI_Iscatterv, given, one, start, MPI_INT, &sum, 1, MPI_INT, 0);
  expect(sum == 5 + me, "MPI_Scatterv");
  COLLECT(MPI_Bcast, MPI_Ibcast, given, 2, MPI_INT, 0);
  COLLECT(MPI_Allreduce, MPI_Iallreduce, mine, &sum, 1, MPI_INT, MPI_SUM);
  expect(sum == 3, "MPI_Allreduce");
  COLLECT(MPI_Reduce, MPI_Ireduce, mine, &sum, 1, MPI_INT, MPI_SUM, 0);
  expect(sum == 3, "MPI_Reduce");
  COLLECT(MPI_Reduce_scatter, MPI_Ireduce_scatter, mine, &sum, one, MPI_INT, MPI_SUM);
  expect(sum == 3, "MPI_Reduce_scatter");
  COLLECT(MPI_Reduce_scatter_block, MPI_Ireduce_scatter_block, mine, &sum, 1, MPI_INT, MPI_SUM);
  expect(sum == 3, "MPI_Reduce_scatter_block");
  COLLECT(MPI_Scan, MPI_Iscan, mine, &sum, 1, MPI_INT, MPI_SUM);
  expect(sum == 1 + 2 * me, "MPI_Scan");
  COLLECT(MPI_Exscan, MPI_Iexscan, mine, &sum, 1, MPI_INT, MPI_SUM);
  if (me == 1) expect(sum == 1, "MPI_Exscan");
}

void expect_two(MPI_Comm comm, const char* name) {
  int size = 0;
  PMPI_Comm_size(comm, &size);
  expect(size == 2, name);
  PMPI_Comm_free(&comm);
}

void make_communicators() {
  MPI_Comm made;
  MPI_Group group;
  MPI_Request r;
  int size = 0, rank = -1, flag = 1, dimensions[1] = {2}, no[1] = {0}, index[2] = {1, 2};
  int neighbours[2] = {1, 0}, one = 1, weight = 1, degree = 1;
  CALL(MPI_Comm_size, MPI_COMM_WORLD, &size);
  CALL(MPI_Comm_rank, MPI_COMM_WORLD, &rank);
  expect(size == 2 && rank == me, "MPI_Comm_size or MPI_Comm_rank");
  CALL(MPI_Comm_group, MPI_COMM_WORLD, &group);
  CALL(MPI_Comm_dup, MPI_COMM_WORLD, &made);
  CALL(MPI_Comm_compare, MPI_COMM_WORLD, made, &flag);
  expect(flag == MPI_CONGRUENT, "MPI_Comm_compare");
  expect_two(made, "MPI_Comm_dup");
  CALL(MPI_Comm_dup_with_info, MPI_COMM_WORLD, MPI_INFO_NULL, &made);
  expect_two(made, "MPI_Comm_dup_with_info");
  CALL(MPI_Comm_idup, MPI_COMM_WORLD, &made, &r);
  MPI_Wait(&r, MPI_STATUS_IGNORE);
  expect_two(made, "MPI_Comm_idup");
  CALL(MPI_Comm_split, MPI_COMM_WORLD, 0, me, &made);
  expect_two(made, "MPI_Comm_split");
  CALL(MPI_Comm_split_type, MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, me, MPI_INFO_NULL, &made);
  expect_two(made, "MPI_Comm_split_type");
  CALL(MPI_Comm_create, MPI_COMM_WORLD, group, &made);
  expect_two(made, "MPI_Comm_create");
  CALL(MPI_Comm_create_group, MPI_COMM_WORLD, group, kTag, &made);
  expect_two(made, "MPI_Comm_create_group");
  CALL(MPI_Cart_create, MPI_COMM_WORLD, 1, dimensions, no, 0, &made);
  expect_two(made, "MPI_Cart_create");
  CALL(MPI_Graph_create, MPI_COMM_WORLD, 2, index, neighbours, 0, &made);
  expect_two(made, "MPI_Graph_create");
  CALL(MPI_Dist_graph_create, MPI_COMM_WORLD, 1, &me, &degree, &other, &weight, MPI_INFO_NULL, 0,
       &made);
  expect_two(made, "MPI_Dist_graph_create");
  CALL(MPI_Dist_graph_create_adjacent, MPI_COMM_WORLD, 1, &other, &one, 1, &other, &one,
       MPI_INFO_NULL, 0, &made);
  expect_two(made, "MPI_Dist_graph_create_adjacent");
  CALL(MPI_Intercomm_create, MPI_COMM_SELF, 0, MPI_COMM_WORLD, other, kTag, &made);
  PMPI_Comm_free(&made);
  CALL(MPI_Cart_map, MPI_COMM_WORLD, 1, dimensions, no, &rank);
  CALL(MPI_Graph_map, MPI_COMM_WORLD, 2, index, neighbours, &rank);
  CALL(MPI_Topo_test, MPI_COMM_WORLD, &flag);
  CALL(MPI_Comm_test_inter, MPI_COMM_WORLD, &flag);
  PMPI_Group_free(&group);
}

void keep_things_with_the_world() {
  int key = 0, flag = 0, number = 1, length = 0, at = 0;
  void* value = nullptr;
  char name[MPI_MAX_OBJECT_NAME], packed[100];
  MPI_Info info;
  MPI_Errhandler handler;
  MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, MPI_COMM_NULL_DELETE_FN, &key, nullptr);
  CALL(MPI_Comm_set_attr, MPI_COMM_WORLD, key, &number);
  CALL(MPI_Comm_get_attr, MPI_COMM_WORLD, key, &value, &flag);
  expect(flag && value == &number, "MPI_Comm_get_attr");
  CALL(MPI_Comm_delete_attr, MPI_COMM_WORLD, key);
  CALL(MPI_Attr_put, MPI_COMM_WORLD, key, &number);
  CALL(MPI_Attr_get, MPI_COMM_WORLD, key, &value, &flag);
  CALL(MPI_Attr_delete, MPI_COMM_WORLD, key);
  CALL(MPI_Comm_set_name, MPI_COMM_WORLD, "own");
  CALL(MPI_Comm_get_name, MPI_COMM_WORLD, name, &length);
  expect(std::string(name) == "own", "MPI_Comm_get_name");
  CALL(MPI_Comm_get_info, MPI_COMM_WORLD, &info);
  CALL(MPI_Comm_set_info, MPI_COMM_WORLD, info);
  MPI_Info_free(&info);
  CALL(MPI_Comm_get_errhandler, MPI_COMM_WORLD, &handler);
  CALL(MPI_Comm_set_errhandler, MPI_COMM_WORLD, handler);
  CALL(MPI_Pack_size, 1, MPI_INT, MPI_COMM_WORLD, &length);
  CALL(MPI_Pack, &number, 1, MPI_INT, packed, 100, &at, MPI_COMM_WORLD);
  at = 0;
  CALL(MPI_Unpack, packed, 100, &at, &number, 1, MPI_INT, MPI_COMM_WORLD);
}

void open_windows_and_files() {
  MPI_Win window;
  MPI_File file;
  int number = 0;
  void* memory = nullptr;
  CALL(MPI_Win_create, &number, sizeof number, 1, MPI_INFO_NULL, MPI_COMM_WORLD, &window);
  MPI_Win_free(&window);
  CALL(MPI_Win_allocate, sizeof number, 1, MPI_INFO_NULL, MPI_COMM_WORLD, &memory, &window);
  MPI_Win_free(&window);
  CALL(MPI_Win_allocate_shared, sizeof number, 1, MPI_INFO_NULL, MPI_COMM_WORLD, &memory, &window);
  MPI_Win_free(&window);
  CALL(MPI_Win_create_dynamic, MPI_INFO_NULL, MPI_COMM_WORLD, &window);
  MPI_Win_free(&window);
  CALL(MPI_File_open, MPI_COMM_WORLD, "world.bin", MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL,
       &file);
  MPI_File_close(&file);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace protocol;
  const bool idle = argc > 1 && std::string(argv[1]) == "idle";
  MPI_Init(&argc, &argv);
  const Role role = idle ? Role::Fluid : Role::Solid;
  const World world = connect(role);
  limit_waits(10.0);
  auto channel = make_mpi_channel(world, role);
  if (idle) {
    channel->await_farewell(30.0);
  } else {
    replace_world(world.local);
    MPI_Comm_rank(MPI_COMM_WORLD, &me);
    other = 1 - me;
    send_in_every_way();
    receive_in_every_way();
    collect_in_every_way();
    make_communicators();
    keep_things_with_the_world();
    open_windows_and_files();
  }
  return finish(0, "world_caller", channel, world.local);
}
